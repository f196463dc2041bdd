// Elementary functions in single precision without branches and without calls into the mathematical
// library: a loop over them runs in SIMD lanes, with the same bytes for any lane width.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace patina {

// [0, 1) from 32 random bits, of which the upper 24 count.
[[nodiscard]] inline float unit_from_bits(std::uint32_t bits) {
    return float(static_cast<std::int32_t>(bits >> 8)) * (1.0f / (1 << 24));
}

// Natural logarithm of a normal number x > 0, to a few units in the last place: 2 artanh((m - 1) /
// (m + 1)) of the mantissa m in [sqrt(1/2), sqrt(2)), by its series.
[[nodiscard]] inline float lane_log(float x) {
    constexpr std::int32_t kBitsOfSqrtHalf = 0x3f3504f3;
    const std::int32_t bits = std::bit_cast<std::int32_t>(x);
    const std::int32_t exponent = (bits - kBitsOfSqrtHalf) >> 23;
    const float mantissa = std::bit_cast<float>(bits - exponent * (1 << 23));
    const float s = (mantissa - 1) / (mantissa + 1);
    const float t = s * s;
    return float(exponent) * std::numbers::ln2_v<float> +
           2 * s * (1 + t * (1.0f / 3 + t * (1.0f / 5 + t * (1.0f / 7 + t * (1.0f / 9)))));
}

// Sine and cosine of 2 pi turn, turn in [0, 1]; absolute error below 3e-7: their series about the
// nearest quarter turn.
struct SinCos {
    float sin;
    float cos;
};
[[nodiscard]] inline SinCos lane_sin_cos(float turn) {
    const auto quarter = static_cast<std::int32_t>(4 * turn + 0.5f);
    const float a = 2 * std::numbers::pi_v<float> * (turn - 0.25f * float(quarter));
    const float t = a * a;
    const float s =
        a * (1 - t * (1.0f / 6 - t * (1.0f / 120 - t * (1.0f / 5040 - t * (1.0f / 362880)))));
    const float c = 1 - t * (1.0f / 2 - t * (1.0f / 24 - t * (1.0f / 720 - t * (1.0f / 40320))));
    const bool swapped = (quarter & 1) != 0;
    const float sine = swapped ? c : s;
    const float cosine = swapped ? s : c;
    return {(quarter & 2) != 0 ? -sine : sine, ((quarter + 1) & 2) != 0 ? -cosine : cosine};
}

// The angle between two unit vectors from the square of the chord between their tips, in [0, 4]
// [rad]; relative error below 4e-7 up to a right angle, absolute error below 1e-3 near pi. The
// arc sine is a polynomial of degree 7 in its square, through the Chebyshev nodes of [0, 1/2].
[[nodiscard]] inline float angle_of_chord_squared(float chord_squared) {
    const float y = 0.25f * chord_squared;
    const bool far = y > 0.5f;
    const float t = far ? (y < 1 ? 1 - y : 0.0f) : y;
    const float series =
        0.999999989f +
        t * (0.166669547f +
             t * (0.0748811444f +
                  t * (0.0464808495f +
                       t * (0.0167313889f +
                            t * (0.0755397539f + t * (-0.0900862168f + t * 0.109673983f))))));
    const float angle = 2 * std::sqrt(t) * series;
    return far ? std::numbers::pi_v<float> - angle : angle;
}

}  // namespace patina
