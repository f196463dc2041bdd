// Random numbers without state: every number is a function of (seed, pass, element, position).
//
// Based on: Salmon et al. Parallel Random Numbers: As Easy as 1, 2, 3. SC 2011 (Philox4x32-10).
// Based on: Burley. Practical Hash-based Owen Scrambling. JCGT 9(4), 2020 (SobolSampler).
#pragma once

#include <array>
#include <cstdint>

namespace patina {

// What the numbers are for. Two passes never share numbers. Values are part of the result's bytes.
enum class Pass : std::uint32_t {
    path_tracer = 1,
    photons = 2,
    sensor_noise = 3,
    objects = 4,
    calibration_error = 5,
    rendered_shots = 6,
    gather = 7,
    plan_texels = 8,
    plan_draws = 9,
    adaptive_path_tracer = 10,
    adaptive_rendered_shots = 11,
    tests = 100,
};

// Philox4x32-10 block function.
[[nodiscard]] std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                                  std::array<std::uint32_t, 2> key);

// A stream of numbers for one element (photon, texel, pixel) of one pass.
class Rng {
  public:
    Rng(std::uint64_t seed, Pass pass, std::uint64_t element);

    [[nodiscard]] std::uint32_t next_u32();
    // Uniform in [0, 1), a multiple of 2^-32.
    [[nodiscard]] double uniform();
    // Standard normal (Box-Muller).
    [[nodiscard]] double normal();

  private:
    std::array<std::uint32_t, 4> counter_;
    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> block_{};
    int used_ = 4;
};

// Well-mixed 32 bits of two words; for seeds of scramblings.
[[nodiscard]] inline std::uint32_t hash_combine(std::uint32_t a, std::uint32_t b) {
    std::uint32_t x = a * 0x9E3779B9u ^ (b + 0x7F4A7C15u + (a << 6) + (a >> 2));
    x ^= x >> 16;
    x *= 0x85EBCA6Bu;
    x ^= x >> 13;
    x *= 0xC2B2AE35u;
    x ^= x >> 16;
    return x;
}

// The element's part of the seed of a SobolSampler.
[[nodiscard]] std::uint32_t sobol_element_hash(std::uint64_t seed,
                                               Pass pass,
                                               std::uint64_t element);

// What scrambles one pair of dimensions of one element.
struct SobolScramble {
    std::uint32_t order = 0;  // of the samples
    std::uint32_t first = 0;
    std::uint32_t second = 0;
};

// pair: 1, 2, ...
[[nodiscard]] inline SobolScramble sobol_scramble(std::uint32_t element_hash, std::uint32_t pair) {
    const std::uint32_t pair_hash = hash_combine(element_hash, pair);
    return {pair_hash, hash_combine(pair_hash, 1), hash_combine(pair_hash, 2)};
}

// A pair of a SobolSampler, as multiples of 2^-32. Without branches, so that a loop over samples
// runs in SIMD lanes.
[[nodiscard]] inline std::array<std::uint32_t, 2> sobol_pair(const SobolScramble& scramble,
                                                             std::uint32_t sample_index) {
    const auto reverse_bits = [](std::uint32_t x) {
        x = __builtin_bswap32(x);
        x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
        x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
        return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
    };
    // Laine-Karras style hash on reversed bits: each bit is flipped by a function of the lower ones
    // only.
    const auto laine_karras = [](std::uint32_t x, std::uint32_t seed) {
        x += seed;
        x ^= x * 0x6c50b47cu;
        x ^= x * 0xb82f1e52u;
        x ^= x * 0xc7afe638u;
        return x ^ (x * 0x8d22f6e6u);
    };
    // Shuffling the order keeps the pairs of dimensions independent of each other.
    const std::uint32_t index =
        reverse_bits(laine_karras(reverse_bits(sample_index), scramble.order));
    // Second Sobol dimension (primitive polynomial x + 1), reversed: bit j is the sum of the
    // index's bits k over odd binomials (k over j), those where k has all the bits of j.
    std::uint32_t second = index;
    second ^= (second >> 1) & 0x55555555u;
    second ^= (second >> 2) & 0x33333333u;
    second ^= (second >> 4) & 0x0f0f0f0fu;
    second ^= (second >> 8) & 0x00ff00ffu;
    second ^= second >> 16;
    return {reverse_bits(laine_karras(index, scramble.first)),
            reverse_bits(laine_karras(second, scramble.second))};
}

// The same, each in [0, 1).
[[nodiscard]] inline std::array<double, 2> sobol_point(const SobolScramble& scramble,
                                                       std::uint32_t sample_index) {
    const auto [x, y] = sobol_pair(scramble, sample_index);
    return {x * 0x1p-32, y * 0x1p-32};
}

// Pairs of Owen-scrambled Sobol numbers for one element: sample `sample_index` of a (0,2)-sequence
// whose scrambling and order depend on (seed, element, pair). Unbiased for any number of samples;
// best for powers of two.
class SobolSampler {
  public:
    SobolSampler(std::uint64_t seed, Pass pass, std::uint64_t element, std::uint32_t sample_index);

    // The next pair of dimensions, each uniform in [0, 1).
    [[nodiscard]] std::array<double, 2> next_pair();

  private:
    std::uint32_t element_hash_;
    std::uint32_t sample_index_;
    std::uint32_t pair_ = 0;
};

}  // namespace patina
