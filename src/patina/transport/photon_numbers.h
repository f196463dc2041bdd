// Random numbers of a wave of photons. Photons alternate between two halves; each half is a
// stratified set of its own.
#pragma once

#include "patina/base/random.h"
#include "patina/base/wide_code.h"
#include "patina/math/lane_math.h"
#include "patina/transport/photon_lanes.h"

#include <array>
#include <cstdint>

namespace patina {

class PhotonNumbers {
  public:
    // stream: tells the lamp sets apart.
    PhotonNumbers(std::uint64_t seed, std::uint32_t stream)
        : element_hashes_{element_hash(seed, stream, 0), element_hash(seed, stream, 1)} {}

    // Pair number `pair` (1, 2, ...), each in [0, 1), of photons given by their numbers in a wave.
    // first_sample: number of the wave's first photon within its half.
    void draw(std::uint32_t pair,
              std::uint32_t first_sample,
              const Lane<std::uint32_t>& photon,
              std::size_t count,
              Lane<float>& first,
              Lane<float>& second) const {
        const SobolScramble even = sobol_scramble(element_hashes_[0], pair);
        const SobolScramble odd = sobol_scramble(element_hashes_[1], pair);
        const std::uint32_t* const from = photon.data();
        float* const to_first = first.data();
        float* const to_second = second.data();
        run_wide([=]() PATINA_WIDE {
            for (std::size_t i = 0; i < count; ++i) {
                const bool is_odd = (from[i] & 1u) != 0;
                const auto numbers = sobol_pair({is_odd ? odd.order : even.order,
                                                 is_odd ? odd.first : even.first,
                                                 is_odd ? odd.second : even.second},
                                                first_sample + from[i] / 2);
                to_first[i] = unit_from_bits(numbers[0]);
                to_second[i] = unit_from_bits(numbers[1]);
            }
        });
    }

  private:
    [[nodiscard]] static std::uint32_t element_hash(std::uint64_t seed,
                                                    std::uint32_t stream,
                                                    std::uint32_t half) {
        return sobol_element_hash(seed, Pass::photons, (std::uint64_t{stream} << 1) | half);
    }

    std::array<std::uint32_t, 2> element_hashes_;
};

}  // namespace patina
