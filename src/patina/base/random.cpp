#include "patina/base/random.h"

#include <cmath>
#include <numbers>

namespace patina {
namespace {

constexpr double kTwoToMinus32 = 1.0 / 4294967296.0;

std::uint32_t reverse_bits(std::uint32_t x) {
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    x = ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
    return x;
}

// Laine-Karras style hash on reversed bits: each bit is flipped by a function of the lower ones
// only.
std::uint32_t laine_karras(std::uint32_t x, std::uint32_t seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
    return reverse_bits(laine_karras(reverse_bits(x), seed));
}

// Second Sobol dimension (primitive polynomial x + 1): direction number v_k = v_{k-1} ^ (v_{k-1} >>
// 1).
std::uint32_t sobol_second(std::uint32_t index) {
    std::uint32_t result = 0;
    for (std::uint32_t v = 0x80000000u; index != 0; index >>= 1, v ^= v >> 1) {
        if (index & 1u) result ^= v;
    }
    return result;
}

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

std::uint32_t hash_combine(std::uint32_t a, std::uint32_t b) {
    std::uint32_t x = a * 0x9E3779B9u ^ (b + 0x7F4A7C15u + (a << 6) + (a >> 2));
    x ^= x >> 16;
    x *= 0x85EBCA6Bu;
    x ^= x >> 13;
    x *= 0xC2B2AE35u;
    x ^= x >> 16;
    return x;
}

SobolSampler::SobolSampler(std::uint64_t seed,
                           Pass pass,
                           std::uint64_t element,
                           std::uint32_t sample_index)
    : sample_index_(sample_index) {
    std::uint32_t hash =
        hash_combine(static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
    hash = hash_combine(hash, static_cast<std::uint32_t>(pass));
    hash = hash_combine(hash, static_cast<std::uint32_t>(element));
    element_hash_ = hash_combine(hash, static_cast<std::uint32_t>(element >> 32));
}

std::array<double, 2> SobolSampler::next_pair() {
    const std::uint32_t pair_hash = hash_combine(element_hash_, ++pair_);
    // Shuffling the order keeps the pairs of dimensions independent of each other.
    const std::uint32_t index = owen_scramble(sample_index_, pair_hash);
    const std::uint32_t x = owen_scramble(reverse_bits(index), hash_combine(pair_hash, 1));
    const std::uint32_t y = owen_scramble(sobol_second(index), hash_combine(pair_hash, 2));
    return {x * kTwoToMinus32, y * kTwoToMinus32};
}

}  // namespace patina
