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
[[nodiscard]] std::uint32_t hash_combine(std::uint32_t a, std::uint32_t b);

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
