// Rays and photons, as methods send them.
//
//     transport_benchmark            options of Google Benchmark
//
// Rays leave the texels of an object in directions of the cosine: one by one as the path tracer
// sends them, and in lanes as the gather graph and photons are. Photons are those of one lamp,
// which stands on A and turns with the scanner on B. photon_benchmark sets photons beside the bare
// rays of the same photons.
#include "patina/base/parallel.h"
#include "patina/base/random.h"
#include "patina/math/warp.h"
#include "patina/transport/photon_paths.h"

#include <benchmark/benchmark.h>

#include "scanned_object.h"
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patina {
namespace {

constexpr std::size_t kNumRays = 1 << 20;
constexpr std::size_t kBlock = 1024;
constexpr std::uint64_t kNumPhotons = 1'000'000;

const LitObject& object(std::int64_t kind) {
    static const LitObject a(ObjectKind::a);
    static const LitObject b(ObjectKind::b);
    return kind == 0 ? a : b;
}

// In lanes of single precision, as all of them are sent.
struct Rays {
    explicit Rays(const ScannedObject& object) {
        const std::span<const Texel> texels = object.capture.atlas.texels;
        for (std::size_t i = 0; i < kNumRays; ++i) {
            const SurfacePoint& point = texels[i % texels.size()].point;
            SobolSampler numbers(1, Pass::tests, i, 0);
            const Vec3 w = Frame(point.geometric_normal)
                               .to_world(square_to_cosine_hemisphere(numbers.next_pair()));
            const Vec3 from = object.tracer->offset(point, w);
            for (int axis = 0; axis < 3; ++axis) {
                origin[std::size_t(axis)].push_back(float(from[axis]));
                direction[std::size_t(axis)].push_back(float(w[axis]));
            }
        }
    }
    [[nodiscard]] static Vec3 at(const std::array<std::vector<float>, 3>& lanes, std::size_t i) {
        return {double(lanes[0][i]), double(lanes[1][i]), double(lanes[2][i])};
    }

    std::array<std::vector<float>, 3> origin;
    std::array<std::vector<float>, 3> direction;
};

const Rays& rays(std::int64_t kind) {
    static const Rays a(object(0));
    static const Rays b(object(1));
    return kind == 0 ? a : b;
}

void count_rays(benchmark::State& state) {
    state.SetItemsProcessed(state.iterations() * std::int64_t(kNumRays));
}

// range(0): 0 object A, 1 object B; range(1): threads.
void single_rays(benchmark::State& state) {
    const Rays& r = rays(state.range(0));
    const Tracer& tracer = *object(state.range(0)).tracer;
    const ThreadLimit limit(int(state.range(1)));
    for (auto _ : state) {
        parallel_blocks(kNumRays, kBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                benchmark::DoNotOptimize(
                    tracer.intersect(Rays::at(r.origin, i), Rays::at(r.direction, i)));
            }
        });
    }
    count_rays(state);
}

void lanes_of_rays(benchmark::State& state) {
    const Rays& r = rays(state.range(0));
    const Tracer& tracer = *object(state.range(0)).tracer;
    const ThreadLimit limit(int(state.range(1)));
    const std::vector<std::int32_t> active(kBlock, -1);
    for (auto _ : state) {
        parallel_blocks(kNumRays, kBlock, [&](std::size_t begin, std::size_t end) {
            std::array<std::uint32_t, kBlock> triangle;
            std::array<float, kBlock> u;
            std::array<float, kBlock> v;
            const std::size_t size = end - begin;
            const auto part = [&](const std::array<std::vector<float>, 3>& lanes) {
                return std::array{std::span(lanes[0]).subspan(begin, size),
                                  std::span(lanes[1]).subspan(begin, size),
                                  std::span(lanes[2]).subspan(begin, size)};
            };
            tracer.intersect_lanes(
                {part(r.origin), part(r.direction), std::span(active).first(size)},
                {std::span(triangle).first(size),
                 std::span(u).first(size),
                 std::span(v).first(size)});
            benchmark::DoNotOptimize(triangle);
        });
    }
    count_rays(state);
}

void photons(benchmark::State& state) {
    const LitObject& lit = object(state.range(0));
    const ThreadLimit limit(int(state.range(1)));
    const PhotonScene scene(lit.surface, lit.capture.atlas, lit.maps);
    PhotonOptions options;
    options.photons = kNumPhotons;
    Progress progress;
    double num_rays = 0;
    for (auto _ : state) {
        num_rays += double(trace_photons(scene, lit.lamps, options, 0, progress).rays);
    }
    state.SetItemsProcessed(state.iterations() * std::int64_t(kNumPhotons));
    state.counters["rays"] = benchmark::Counter(num_rays, benchmark::Counter::kIsRate);
}

void both_objects(benchmark::internal::Benchmark* kernel) {
    kernel->ArgsProduct({{0, 1}, {1, 2}})->UseRealTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(single_rays)->Apply(both_objects);
BENCHMARK(lanes_of_rays)->Apply(both_objects);
BENCHMARK(photons)->Apply(both_objects);

}  // namespace
}  // namespace patina
