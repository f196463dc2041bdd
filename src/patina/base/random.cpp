#include "patina/base/random.h"

#include <cmath>
#include <numbers>

namespace patina {
namespace {

constexpr double kTwoToMinus32 = 1.0 / 4294967296.0;

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                    std::array<std::uint32_t, 2> key) {
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t product0 = std::uint64_t{0xD2511F53u} * counter[0];
        const std::uint64_t product1 = std::uint64_t{0xCD9E8D57u} * counter[2];
        counter = {static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key[0],
                   static_cast<std::uint32_t>(product1),
                   static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key[1],
                   static_cast<std::uint32_t>(product0)};
        key[0] += 0x9E3779B9u;
        key[1] += 0xBB67AE85u;
    }
    return counter;
}

Rng::Rng(std::uint64_t seed, Pass pass, std::uint64_t element)
    : counter_{0,
               static_cast<std::uint32_t>(pass),
               static_cast<std::uint32_t>(element),
               static_cast<std::uint32_t>(element >> 32)},
      key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)} {}

std::uint32_t Rng::next_u32() {
    if (used_ == 4) {
        block_ = philox(counter_, key_);
        ++counter_[0];
        used_ = 0;
    }
    return block_[static_cast<std::size_t>(used_++)];
}

double Rng::uniform() { return next_u32() * kTwoToMinus32; }

double Rng::normal() {
    const double u = (next_u32() + 0.5) * kTwoToMinus32;
    const double v = uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

std::uint32_t sobol_element_hash(std::uint64_t seed, Pass pass, std::uint64_t element) {
    std::uint32_t hash =
        hash_combine(static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
    hash = hash_combine(hash, static_cast<std::uint32_t>(pass));
    hash = hash_combine(hash, static_cast<std::uint32_t>(element));
    return hash_combine(hash, static_cast<std::uint32_t>(element >> 32));
}

SobolSampler::SobolSampler(std::uint64_t seed,
                           Pass pass,
                           std::uint64_t element,
                           std::uint32_t sample_index)
    : element_hash_(sobol_element_hash(seed, pass, element)), sample_index_(sample_index) {}

std::array<double, 2> SobolSampler::next_pair() {
    return sobol_point(sobol_scramble(element_hash_, ++pair_), sample_index_);
}

}  // namespace patina
