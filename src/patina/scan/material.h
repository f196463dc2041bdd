// What the objects' reflectance is made of: smooth noise, blends, and the range of real materials.
#pragma once

#include "patina/reflectance/lobe.h"

#include <cstdint>

namespace patina {

// The range that glazed ceramics, varnished wood and plastics lie in; objects B and C keep to it.
inline constexpr double kObjectMinDiffuse = 0.1;
inline constexpr double kObjectMaxDiffuse = 0.85;
// Of Ps 2 sigma^2, the specular reflectance at normal incidence [-].
inline constexpr double kObjectMinGloss = 0.005;
inline constexpr double kObjectMaxGloss = 0.05;
inline constexpr double kObjectMinRoughness = 0.08;  // [rad]
inline constexpr double kObjectMaxRoughness = 0.3;   // [rad]

// How a surface looks, in the quantities that are natural to choose.
struct Finish {
    Rgb diffuse = Rgb::Constant(0.5);  // Pd [-]
    double gloss = 0.02;               // Ps 2 sigma^2 [-]
    double roughness = 0.15;           // sigma [rad]
};

// Values outside the ranges above are moved to their ends.
[[nodiscard]] Reflectance make_reflectance(const Finish& finish);

// b with the weight t, which is first limited to [0, 1].
[[nodiscard]] Finish blend(const Finish& a, const Finish& b, double t);

// 0 below `low`, 1 above `high`, a cubic between them.
[[nodiscard]] double smooth_step(double low, double high, double x);

// Value noise in [-1, 1] with continuous second derivatives. size: of its features [length]; which:
// picks one of many independent fields.
[[nodiscard]] double smooth_noise(const Vec3& p, double size, std::uint32_t which);

}  // namespace patina
