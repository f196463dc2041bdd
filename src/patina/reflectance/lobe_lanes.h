// The lobe's Gaussian in single precision, without calls into the mathematical library: written so
// that a loop over lamps or arrivals runs in SIMD lanes, with the same bytes for any lane width.
// Float: float or Lanes (math/lanes.h).
#pragma once

namespace patina {

// Square of the angle whose cosine is 1 - versine [rad^2]: the series of arccos^2. Its relative
// error is below 2e-4 for versine <= 0.7 and 2 % at 1.5 (120 degrees), where the Gaussian of the
// widest lobe has fallen to 0.2 %.
template <typename Float>
[[nodiscard]] inline Float squared_angle(Float versine) {
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
template <typename Float>
[[nodiscard]] inline Float exp_of_negative(Float x) {
    const Float lowest = Float{} - 20.0f;
    const Float t = (x < lowest ? lowest : x) * 0.0625f;
    Float e =
        1.0f +
        t * (1.0f + t * (1.0f / 2 +
                         t * (1.0f / 6 + t * (1.0f / 24 + t * (1.0f / 120 + t * (1.0f / 720))))));
    e *= e;
    e *= e;
    e *= e;
    return e * e;
}

}  // namespace patina
