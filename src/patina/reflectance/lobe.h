// The reflectance of one surface point: diffuse albedo plus a Torrance-Sparrow lobe.
//
// Based on: Machida, Takemura, Yokoya. Dense Estimation of Surface Reflectance Properties Based on
// Inverse Global Illumination Rendering. 2004, eq. 1, with a floor under the cosines (docs/theory.md):
//
//     f = (1/pi) [ Pd + Ps exp(-theta_r^2 / (2 sigma^2)) / (max(cos_i, c0) max(cos_v, c0)) ]  [1/sr]
#pragma once

#include "patina/math/types.h"

#include <array>

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

// Angle between the mirror direction of w_i about n and w_o, squared [rad^2]. Unit vectors that point
// away from the surface; symmetric in w_i and w_o.
[[nodiscard]] double mirror_angle_squared(const Vec3& n, const Vec3& w_i, const Vec3& w_o);

// exp(-theta_r^2 / (2 sigma^2)) [-].
[[nodiscard]] inline double lobe_gaussian(double theta_r_squared, double roughness) {
    return std::exp(-theta_r_squared / (2 * roughness * roughness));
}

// 1 / (max(cos_i, c0) max(cos_v, c0)) [-].
[[nodiscard]] inline double lobe_cosines(double cos_i, double cos_v) {
    return 1.0 / (std::max(cos_i, kCosineFloor) * std::max(cos_v, kCosineFloor));
}

// f [1/sr]. Zero where either cosine is not positive.
[[nodiscard]] Rgb evaluate(const Reflectance& reflectance,
                           const Vec3& n,
                           const Vec3& w_i,
                           const Vec3& w_o);

// Value of the specular part for Ps = 1, and its derivative with respect to sigma [1/(sr rad)].
struct LobeDerivative {
    double value = 0;
    double by_roughness = 0;
};
[[nodiscard]] LobeDerivative lobe_derivative(double theta_r_squared,
                                             double cos_i,
                                             double cos_v,
                                             double roughness);

// Integral of the lobe with Ps = 1 times the cosine over the outgoing hemisphere: the directional
// albedo per unit of Ps [-], from a table in (cos_i, sigma) that is integrated once.
[[nodiscard]] double lobe_albedo(double cos_i, double roughness);
// A(sigma): its largest value over all directions [-].
[[nodiscard]] double max_lobe_albedo(double roughness);

// Scales Pd and Ps by one factor so that Pd + Ps A(sigma) <= kMaxAlbedo in every channel, both >= 0
// and sigma within its range. was_clamped: whether anything was changed.
struct Projection {
    Reflectance reflectance;
    bool was_clamped = false;
};
[[nodiscard]] Projection project_to_feasible(const Reflectance& reflectance);

// A sampled direction. weight: f cos_o / pdf [-], per channel; zero when the sample was lost (below the
// horizon), which keeps the sampler unbiased.
struct LobeSample {
    Vec3 w_o = Vec3::UnitZ();
    double pdf = 0;  // [1/sr]
    Rgb weight = Rgb::Zero();
};

// Mixture of a cosine distribution and a von Mises-Fisher distribution of kappa = 1/sigma^2 about the
// mirror direction, chosen by `choice` in [0, 1).
[[nodiscard]] LobeSample sample_lobe(const Reflectance& reflectance,
                                     const Vec3& n,
                                     const Vec3& w_i,
                                     double choice,
                                     const std::array<double, 2>& u);
// The density of sample_lobe() at w_o [1/sr].
[[nodiscard]] double sample_lobe_pdf(const Reflectance& reflectance,
                                     const Vec3& n,
                                     const Vec3& w_i,
                                     const Vec3& w_o);

}  // namespace patina
