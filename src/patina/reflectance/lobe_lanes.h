// The lobe's Gaussian in single precision, without calls into the mathematical library: written so
// that a loop over lamps or arrivals runs in SIMD lanes, with the same bytes for any lane width.
#pragma once

#include <algorithm>

namespace patina {

// Square of the angle whose cosine is 1 - versine [rad^2]: the series of arccos^2. Its relative
// error is below 2e-4 for versine <= 0.7 and 2 % at 1.5 (120 degrees), where the Gaussian of the
// widest lobe has fallen to 0.2 %.
[[nodiscard]] inline float squared_angle(float versine) {
    return versine *
           (2.0f +
            versine * (1.0f / 3 +
                       versine * (4.0f / 45 +
                                  versine * (1.0f / 35 +
                                             versine * (16.0f / 1575 + versine * (8.0f / 2079))))));
}

// exp(x) for x <= 0: exp(x / 16) by its series, squared four times. Its absolute error is below
// 1e-6, its relative one below 2e-6 down to -4 and 5 % at -20. What is smaller counts as exp(-20),
// which is 2e-9.
[[nodiscard]] inline float exp_of_negative(float x) {
    const float t = std::max(x, -20.0f) * 0.0625f;
    float e =
        1 + t * (1 + t * (1.0f / 2 +
                          t * (1.0f / 6 + t * (1.0f / 24 + t * (1.0f / 120 + t * (1.0f / 720))))));
    e *= e;
    e *= e;
    e *= e;
    return e * e;
}

}  // namespace patina
