// How statistical tests decide: thresholds come from one false-alarm rate for the whole suite.
//
// The suite may fail by chance, if its seeds were drawn anew, once in a thousand times. By
// Bonferroni's inequality each of its at most kMaxComparisons comparisons then has the level
// kComparisonLevel.
#pragma once

#include "patina/math/statistics.h"

#include <cmath>

namespace patina {

inline constexpr double kSuiteFalseAlarmRate = 1e-3;
inline constexpr double kMaxComparisons = 2000;
inline constexpr double kComparisonLevel = kSuiteFalseAlarmRate / kMaxComparisons;

// Level of each of `count` independent comparisons that together have the given level (Sidak).
[[nodiscard]] inline double sidak_level(double count, double level = kComparisonLevel) {
    return -std::expm1(std::log1p(-level) / count);
}

// Two-sided threshold of |z| for a standard normal z.
[[nodiscard]] inline double normal_threshold(double level = kComparisonLevel) {
    return -normal_quantile(0.5 * level);
}

// Two-sided threshold of |t| for Student's t (Cornish and Fisher's expansion; to 1 % for 100
// degrees of freedom or more at the levels used here).
[[nodiscard]] inline double student_threshold(double degrees_of_freedom,
                                              double level = kComparisonLevel) {
    const double z = normal_threshold(level);
    const double z2 = z * z;
    const double v = degrees_of_freedom;
    return z + z * (z2 + 1) / (4 * v) + z * ((5 * z2 + 16) * z2 + 3) / (96 * v * v);
}

}  // namespace patina
