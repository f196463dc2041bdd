// The random errors of the virtual scanner's calibration, one stream of numbers for each kind.
#pragma once

#include "patina/base/random.h"

#include <cstdint>

namespace patina {

// Values are part of the result's bytes.
enum class CalibrationError : std::uint64_t { geometry = 0, lamp = 1, registration = 2 };

// element: pixel or vertex, lamp, camera; below 2^40.
[[nodiscard]] inline Rng calibration_rng(std::uint64_t seed,
                                         CalibrationError kind,
                                         std::uint64_t element) {
    constexpr int kElementBits = 40;
    return {seed,
            Pass::calibration_error,
            (static_cast<std::uint64_t>(kind) << kElementBits) | element};
}

}  // namespace patina
