#include "patina/math/warp.h"

#include <algorithm>
#include <cmath>

namespace patina {

Frame::Frame(const Vec3& unit_normal) : normal(unit_normal) {
    const double sign = std::copysign(1.0, normal.z());
    const double a = -1.0 / (sign + normal.z());
    const double b = normal.x() * normal.y() * a;
    tangent = {1.0 + sign * square(normal.x()) * a, sign * b, -sign * normal.x()};
    bitangent = {b, sign + square(normal.y()) * a, -normal.y()};
}

Vec3 square_to_cosine_hemisphere(const std::array<double, 2>& u) {
    const double radius = std::sqrt(u[0]);
    const double phi = 2 * kPi * u[1];
    return {radius * std::cos(phi), radius * std::sin(phi), std::sqrt(std::max(0.0, 1.0 - u[0]))};
}

Vec3 square_to_sphere(const std::array<double, 2>& u) {
    const double z = 1 - 2 * u[0];
    const double radius = std::sqrt(std::max(0.0, 1 - z * z));
    const double phi = 2 * kPi * u[1];
    return {radius * std::cos(phi), radius * std::sin(phi), z};
}

Vec3 square_to_von_mises_fisher(const std::array<double, 2>& u, double kappa) {
    const double z =
        std::max(-1.0, 1.0 + std::log(u[0] + (1.0 - u[0]) * std::exp(-2.0 * kappa)) / kappa);
    const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
    const double phi = 2 * kPi * u[1];
    return {radius * std::cos(phi), radius * std::sin(phi), z};
}

double von_mises_fisher_pdf(double cos_theta, double kappa) {
    return kappa * std::exp(kappa * (cos_theta - 1.0)) / (2 * kPi * -std::expm1(-2.0 * kappa));
}

}  // namespace patina
