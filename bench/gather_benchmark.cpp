// The kernels of method gather beside what the machine can do: the sweep against a triad's
// bandwidth and against the peak of its own kind of arithmetic, and the fit of one texel.
//
//     gather_benchmark            options of Google Benchmark
//
// Counted per hit of the sweep: 35 operations in each of 8 lanes where the texel that was hit has
// a lobe (out of 16 bits 5, exponent 1, exp_of_negative 18, scaling 2, adding to three channels 3,
// gathering 6), else 9; and the bytes that it reads: the hit, the texel's row and its lobe's width,
// and the mirror angles. Per entry of the filter: 2 operations and 4 bytes in each lane of three
// channels of two halves. Per second ray: 21 operations in one lane, and the bytes of the ray and
// of the lobe that it meets; what those that matter go on to read and add is not counted.
#include "patina/base/large_vector.h"
#include "patina/base/parallel.h"
#include "patina/estimate/joint_fit.h"
#include "patina/transport/gather_sweep.h"

#include <benchmark/benchmark.h>

#include "scanned_object.h"
#include <array>
#include <vector>

namespace patina {
namespace {

constexpr std::size_t kBlock = 4096;
constexpr std::size_t kTriadLength = std::size_t(1) << 26;  // 256 MiB an array
constexpr double kLobeOperations = 35;
constexpr double kMatteOperations = 9;
constexpr double kSecondRayOperations = 21;

// a <- b + s c, as STREAM does it: two arrays are read, one is written, each of them four times as
// large as the caches of last level together, if two processors have 32 MiB each: or the second
// thread would bring a cache of its own besides. In huge pages, as what the sweep reads.
void triad(benchmark::State& state) {
    const ThreadLimit limit(int(state.range(0)));
    LargeVector<float> a(kTriadLength, 0.0f);
    const LargeVector<float> b(kTriadLength, 1.0f);
    const LargeVector<float> c(kTriadLength, 2.0f);
    for (auto _ : state) {
        parallel_blocks(kTriadLength, kBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) a[i] = b[i] + 3.0f * c[i];
        });
        benchmark::DoNotOptimize(a.data());
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(state.iterations() * std::int64_t(3 * sizeof(float) * kTriadLength));
}

// Multiplications and additions that wait for nothing: the most that code without fused operations
// can do.
void arithmetic(benchmark::State& state) {
    const ThreadLimit limit(int(state.range(0)));
    constexpr std::size_t kLanes = 64;
    constexpr std::size_t kSteps = 1 << 16;
    constexpr std::size_t kTasks = 64;
    for (auto _ : state) {
        parallel_blocks(kTasks, 1, [&](std::size_t begin, std::size_t) {
            std::array<float, kLanes> x;
            x.fill(float(begin));
            for (std::size_t step = 0; step < kSteps; ++step) {
                for (float& value : x) value = value * 0.999f + 0.5f;
                benchmark::DoNotOptimize(x);
            }
        });
    }
    state.counters["operations"] =
        benchmark::Counter(double(2 * kLanes * kSteps * kTasks) * double(state.iterations()),
                           benchmark::Counter::kIsRate);
}

// Object A under one block of standing lamps.
struct Scene : ScannedObject {
    Scene() : ScannedObject(ObjectKind::a) {
        Progress progress;
        graph = trace_gather_graph(surface, capture.atlas, {}, {}, progress);
        direct.reserve(kLampLanes);
        for (std::size_t i = 0; i < kLampLanes; ++i) {
            const Light& light = capture.description.lights[3 * i];
            direct.push_back(direct_light(surface, capture.atlas, light));
            lamps.lights.push_back(&light);
            lamps.direct.push_back(&direct.back());
        }
        filter = build_surface_filter(capture.atlas, 2);
    }

    GatherGraph graph;
    std::vector<LargeVector<DirectLight>> direct;
    LampBlock lamps;
    SurfaceFilter filter;
};

const Scene& scene() {
    static const Scene instance;
    return instance;
}

// range(0): threads; range(1): whether the texels have lobes.
void sweep(benchmark::State& state) {
    const Scene& s = scene();
    const ThreadLimit limit(int(state.range(0)));
    const bool glossy = state.range(1) != 0;
    const RadiantTexels texels(s.capture.atlas, s.maps, glossy);
    LampBlockLight light(s.surface, s.capture.atlas, s.graph, s.lamps, false);
    SweptLight swept;
    for (auto _ : state) light.sweep(s.graph, texels, s.filter, swept);
    const double hits = double(s.graph.irradiance.hits.size()) * double(state.iterations());
    const double second_rays =
        double(s.graph.irradiance.glossy.size()) * double(state.iterations());
    const double filtered =
        6.0 * kLampLanes * double(s.filter.texel.size()) * double(state.iterations());
    const std::size_t bytes_of_hit = sizeof(GatherHit) + sizeof(StandingRow) + sizeof(float) +
                                     (glossy ? sizeof(StandingHit) : 0);
    state.SetBytesProcessed(
        std::int64_t(hits * double(bytes_of_hit) + filtered * sizeof(float) +
                     second_rays * double(sizeof(GlossyHit) + sizeof(GlossyLobe))));
    state.counters["operations"] =
        benchmark::Counter(hits * kLampLanes * (glossy ? kLobeOperations : kMatteOperations) +
                               second_rays * kSecondRayOperations + 2 * filtered,
                           benchmark::Counter::kIsRate);
    state.counters["hits"] = benchmark::Counter(hits, benchmark::Counter::kIsRate);
}

// One texel under range(0) lamps, from sigma of the turn before.
void fit(benchmark::State& state) {
    std::vector<LampTerm> terms(std::size_t(state.range(0)));
    std::vector<FitRow> rows(terms.size());
    Reflectance truth;
    truth.diffuse = {0.5, 0.4, 0.3};
    truth.specular = 0.4;
    for (std::size_t k = 0; k < terms.size(); ++k) {
        terms[k].irradiance = Rgbf::Constant(1.0f + 0.1f * float(k % 5));
        terms[k].theta_r_squared = square(float(k) / float(terms.size()));
        terms[k].lobe_cosines = 1.3f;
        FitRow& row = rows[k];
        row.lamps = std::span(&terms[k], 1);
        row.irradiance = terms[k].irradiance.cast<double>();
        row.weight = Rgb::Ones();
        row.radiance = predict(row, truth);
    }
    JointFit joint;
    const FitOptions options;
    for (auto _ : state) {
        joint.load(rows);
        benchmark::DoNotOptimize(joint.solve(options, 0.21));
    }
    state.SetItemsProcessed(state.iterations() * std::int64_t(rows.size()));
}

BENCHMARK(triad)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(arithmetic)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(sweep)->ArgsProduct({{1, 2}, {0, 1}})->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(fit)->Arg(8)->Arg(16)->Arg(32)->Arg(60);

}  // namespace
}  // namespace patina
