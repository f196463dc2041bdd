// Cost of the reflectance kernels, over directions and roughnesses as an estimate meets them.
#include "patina/base/random.h"
#include "patina/math/warp.h"
#include "patina/reflectance/lobe.h"

#include <benchmark/benchmark.h>

#include <array>
#include <vector>

namespace patina {
namespace {

struct LobeCase {
    Reflectance reflectance;
    Vec3 w_i;
    Vec3 w_o;
    double choice = 0;
    std::array<double, 2> u{};
};

// Enough cases that the branch predictor cannot learn them, few enough to stay in the cache.
constexpr std::size_t kNumCases = 1024;

std::vector<LobeCase> make_cases() {
    std::vector<LobeCase> cases(kNumCases);
    for (std::size_t i = 0; i < kNumCases; ++i) {
        Rng rng(1, Pass::tests, i);
        const auto pair = [&rng] { return std::array<double, 2>{rng.uniform(), rng.uniform()}; };
        LobeCase& lobe_case = cases[i];
        lobe_case.reflectance.diffuse = Rgb::Constant(0.5 * rng.uniform());
        lobe_case.reflectance.specular = rng.uniform();
        lobe_case.reflectance.roughness = 0.05 + 0.45 * rng.uniform();
        lobe_case.w_i = square_to_cosine_hemisphere(pair());
        lobe_case.w_o = square_to_cosine_hemisphere(pair());
        lobe_case.choice = rng.uniform();
        lobe_case.u = pair();
    }
    return cases;
}

template <typename Kernel>
void run(benchmark::State& state, const Kernel& kernel) {
    const std::vector<LobeCase> cases = make_cases();
    std::size_t i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(kernel(cases[i++ % kNumCases]));
}

void lobe_value(benchmark::State& state) {
    run(state, [](const LobeCase& lobe_case) {
        return evaluate(lobe_case.reflectance, Vec3::UnitZ(), lobe_case.w_i, lobe_case.w_o);
    });
}
BENCHMARK(lobe_value);

void lobe_sample(benchmark::State& state) {
    run(state, [](const LobeCase& lobe_case) {
        return sample_lobe(
            lobe_case.reflectance, Vec3::UnitZ(), lobe_case.w_i, lobe_case.choice, lobe_case.u);
    });
}
BENCHMARK(lobe_sample);

void lobe_projection(benchmark::State& state) {
    run(state,
        [](const LobeCase& lobe_case) { return project_to_feasible(lobe_case.reflectance); });
}
BENCHMARK(lobe_projection);

}  // namespace
}  // namespace patina
