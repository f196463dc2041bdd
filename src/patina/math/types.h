// Vectors, colours and rigid frames. Eigen's fixed-size types under the names used here.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace patina {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;
using Mat3 = Eigen::Matrix3d;
// R, G, B. Coefficient-wise arithmetic.
using Rgb = Eigen::Array3d;
using Rgbf = Eigen::Array3f;

inline constexpr double kPi = std::numbers::pi;

[[nodiscard]] constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }
[[nodiscard]] constexpr double degrees(double radians) { return radians * (180.0 / kPi); }
[[nodiscard]] constexpr double square(double x) { return x * x; }

// A rotation and a translation; target_from_source in names.
struct RigidTransform {
    Mat3 rotation = Mat3::Identity();
    Vec3 translation = Vec3::Zero();

    [[nodiscard]] Vec3 point(const Vec3& p) const { return rotation * p + translation; }
    [[nodiscard]] Vec3 direction(const Vec3& w) const { return rotation * w; }
    [[nodiscard]] RigidTransform inverse() const {
        return {rotation.transpose(), -(rotation.transpose() * translation)};
    }
};

// Rotation about the y axis that takes (0, 0, 1) to (sin azimuth, 0, cos azimuth). azimuth: [rad].
[[nodiscard]] inline Vec3 rotate_about_y(double azimuth, const Vec3& p) {
    const double c = std::cos(azimuth);
    const double s = std::sin(azimuth);
    return {c * p.x() + s * p.z(), p.y(), -s * p.x() + c * p.z()};
}

}  // namespace patina
