// The lamps' common factor from interreflections: the lowest point of a profile over ln k.
// docs/theory.md, "Absolute scale".
#pragma once

#include "patina/estimate/profile.h"

#include <cstddef>
#include <limits>
#include <string>

namespace patina {

// Told, if its standard error is below this [-].
inline constexpr double kLargestScaleError = 0.1;

struct ScaleEstimate {
    bool told = false;
    double factor = 1;  // true intensities of the lamps over the stated ones; 1 unless told [-]
    // Relative standard error of the factor that fits best [-]; infinite: there is no best one.
    double standard_error = std::numeric_limits<double>::infinity();
    double best_factor = 1;  // told or not; 1 if there is none [-]
    std::string reason;      // why it is not told, in words; empty: it is
};

// What a user is to know of a scale that is not told: one line.
[[nodiscard]] std::string untold_note(const ScaleEstimate& scale);

// trials: over ln k. start: ln k to start from.
[[nodiscard]] ScaleEstimate find_scale(ProfileTrials& trials,
                                       double start,
                                       std::size_t num_lamp_sets);

}  // namespace patina
