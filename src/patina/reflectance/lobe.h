// The reflectance of one surface point: diffuse albedo plus a Torrance-Sparrow lobe.
//
// Based on: Machida, Takemura, Yokoya. Dense Estimation of Surface Reflectance Properties Based on
// Inverse Global Illumination Rendering. 2004, eq. 1, with a floor under the cosines
// (docs/theory.md):
//
//     f = (1/pi) [ Pd + Ps exp(-theta_r^2 / (2 sigma^2)) / (max(cos_i, c0) max(cos_v, c0)) ] [1/sr]
//
// Directions are unit vectors that point away from the surface.
#pragma once

#include "patina/math/types.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {

// c0, the floor under both cosines of the lobe [-]; acos(0.2) is 78.5 degrees.
inline constexpr double kCosineFloor = 0.2;
// Pd + Ps A(sigma) never exceeds this share in any channel [-].
inline constexpr double kMaxAlbedo = 0.99;
// Range of sigma that estimates are kept in [rad].
inline constexpr double kMinRoughness = 0.02;
inline constexpr double kMaxRoughness = 0.6;

struct Reflectance {
    Rgb diffuse = Rgb::Zero();  // Pd [-]
    double specular = 0;        // Ps [-]
    double roughness = 0.2;     // sigma [rad], > 0
};

// theta_r^2: the squared angle between the mirror direction of w_i about n and w_o [rad^2].
// Symmetric in w_i and w_o bit by bit, and accurate to a few roundings of the angle near 0 and near
// pi.
[[nodiscard]] inline double mirror_angle_squared(const Vec3& n, const Vec3& w_i, const Vec3& w_o) {
    const double cos_i = n.dot(w_i);
    const double cos_o = n.dot(w_o);
    // Chords from w_o to the mirror direction and to its opposite, split along and across the
    // normal.
    const Vec3 sum = w_i + w_o;
    const double chord_squared = (sum - (cos_i + cos_o) * n).squaredNorm() + square(cos_i - cos_o);
    if (chord_squared <= 2) return square(2 * std::asin(0.5 * std::sqrt(chord_squared)));
    const Vec3 difference = w_i - w_o;
    const double opposite_squared =
        (difference - (cos_i - cos_o) * n).squaredNorm() + square(cos_i + cos_o);
    return square(kPi - 2 * std::asin(0.5 * std::sqrt(opposite_squared)));
}

// exp(-theta_r^2 / (2 sigma^2)) [-].
[[nodiscard]] inline double lobe_gaussian(double theta_r_squared, double roughness) {
    return std::exp(-theta_r_squared / (2 * roughness * roughness));
}

// 1 / (max(cos_i, c0) max(cos_v, c0)) [-].
[[nodiscard]] inline double lobe_cosines(double cos_i, double cos_v) {
    return 1.0 / (std::max(cos_i, kCosineFloor) * std::max(cos_v, kCosineFloor));
}

// f [1/sr]. Zero where either cosine is not positive.
[[nodiscard]] inline Rgb evaluate(const Reflectance& reflectance,
                                  const Vec3& n,
                                  const Vec3& w_i,
                                  const Vec3& w_o) {
    const double cos_i = n.dot(w_i);
    const double cos_o = n.dot(w_o);
    if (!(cos_i > 0) || !(cos_o > 0)) return Rgb::Zero();
    if (reflectance.specular == 0) return reflectance.diffuse * (1 / kPi);
    const double lobe = lobe_gaussian(mirror_angle_squared(n, w_i, w_o), reflectance.roughness) *
                        lobe_cosines(cos_i, cos_o);
    return (reflectance.diffuse + reflectance.specular * lobe) * (1 / kPi);
}

// Value of the specular part of f for Ps = 1 [1/sr], and its derivative with respect to sigma
// [1/(sr rad)]. Both cosines > 0.
struct LobeDerivative {
    double value = 0;
    double by_roughness = 0;
};
[[nodiscard]] LobeDerivative lobe_derivative(double theta_r_squared,
                                             double cos_i,
                                             double cos_v,
                                             double roughness);

// Integral of the lobe with Ps = 1 times the cosine over the outgoing hemisphere: the directional
// albedo per unit of Ps [-]. From a table that is integrated once, at the first call (thread-safe);
// its error is below 3e-5 of 2 sigma^2 / max(cos_i, c0) for sigma in [kMinRoughness,
// kMaxRoughness]. Outside that range the ratio to 2 sigma^2 / max(cos_i, c0) is that of the range's
// end. Zero for cos_i <= 0.
[[nodiscard]] double lobe_albedo(double cos_i, double roughness);
// A(sigma): its largest value over all directions [-], to the same accuracy.
[[nodiscard]] double max_lobe_albedo(double roughness);

// Scales Pd and Ps by one factor so that Pd + Ps A(sigma) <= kMaxAlbedo in every channel, both >= 0
// and sigma within its range. was_clamped: whether anything was changed.
struct Projection {
    Reflectance reflectance;
    bool was_clamped = false;
};
[[nodiscard]] Projection project_to_feasible(const Reflectance& reflectance);

// A sampled direction. weight: f cos_o / pdf [-], per channel; zero when the sample was lost (below
// the horizon), which keeps the sampler unbiased. A lost sample has pdf 0.
struct LobeSample {
    Vec3 w_o = Vec3::UnitZ();
    double pdf = 0;  // [1/sr]
    Rgb weight = Rgb::Zero();
};

// Mixture of a cosine distribution about n and a von Mises-Fisher distribution of kappa = 1/sigma^2
// about the mirror direction of w_i, chosen by `choice` in [0, 1). The weight divides by the
// density of the whole mixture, so no channel exceeds max(Pd) + 2 sigma^2 Ps / max(cos_i, c0).
[[nodiscard]] LobeSample sample_lobe(const Reflectance& reflectance,
                                     const Vec3& n,
                                     const Vec3& w_i,
                                     double choice,
                                     const std::array<double, 2>& u);
// The density of sample_lobe() at w_o [1/sr]; zero below the horizon, so that it integrates to the
// share of samples which are not lost.
[[nodiscard]] double sample_lobe_pdf(const Reflectance& reflectance,
                                     const Vec3& n,
                                     const Vec3& w_i,
                                     const Vec3& w_o);

}  // namespace patina
