// Cost of random numbers; both generators run once or more per ray.
#include "patina/base/random.h"

#include <benchmark/benchmark.h>

namespace patina {
namespace {

void rng_uniform(benchmark::State& state) {
    Rng rng(1, Pass::tests, 2);
    for (auto _ : state) benchmark::DoNotOptimize(rng.uniform());
}
BENCHMARK(rng_uniform);

void rng_normal(benchmark::State& state) {
    Rng rng(1, Pass::tests, 2);
    for (auto _ : state) benchmark::DoNotOptimize(rng.normal());
}
BENCHMARK(rng_normal);

// A new sampler for each sample, as a gather ray uses it.
void sobol_first_pair(benchmark::State& state) {
    std::uint32_t sample_index = 0;
    for (auto _ : state) {
        SobolSampler sampler(1, Pass::tests, 2, sample_index++);
        benchmark::DoNotOptimize(sampler.next_pair());
    }
}
BENCHMARK(sobol_first_pair);

}  // namespace
}  // namespace patina
