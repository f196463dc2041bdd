#include "patina/scene/camera.h"

#include "patina/base/check.h"

#include <cmath>

namespace patina {
namespace {

// Newton's steps to undistort; each doubles the correct digits, and halvings end in kSmallestStep.
constexpr int kMaxNewtonSteps = 50;
constexpr double kSmallestStep = 1e-6;  // share of a Newton step
// On the image plane at z = 1 [-]: about 1e-9 pixels for a focal length of 1000 pixels.
constexpr double kUndistortTolerance = 1e-12;

// d r_d / d r of the radial distortion at s = r^2.
double radial_slope(const std::array<double, 5>& k, double s) {
    return 1 + s * (3 * k[0] + s * (5 * k[1] + s * 7 * k[4]));
}

// Whether the radial distortion has turned back anywhere between the centre and s = r^2: the slope,
// a cubic in s that starts at 1, has its least value at s or at one of its stationary points before
// s.
bool folds_over(const std::array<double, 5>& k, double s) {
    if (radial_slope(k, s) <= 0) return true;
    // 0 = slope' = a s^2 + b s + c, in the form that does not cancel.
    const double a = 21 * k[4];
    const double b = 10 * k[1];
    const double c = 3 * k[0];
    const double discriminant = b * b - 4 * a * c;
    if (discriminant < 0) return false;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    const auto turned_back_at = [&](double root) {
        return root > 0 && root < s && radial_slope(k, root) <= 0;
    };
    return (a != 0 && turned_back_at(q / a)) || (q != 0 && turned_back_at(c / q));
}

// OpenCV's distortion of a point of the image plane z = 1.
Vec2 distort(const std::array<double, 5>& k, const Vec2& p) {
    const double x = p.x();
    const double y = p.y();
    const double s = p.squaredNorm();
    const double radial = 1 + s * (k[0] + s * (k[1] + s * k[4]));
    return {x * radial + 2 * k[2] * x * y + k[3] * (s + 2 * x * x),
            y * radial + k[2] * (s + 2 * y * y) + 2 * k[3] * x * y};
}

Eigen::Matrix2d distort_jacobian(const std::array<double, 5>& k, const Vec2& p) {
    const double x = p.x();
    const double y = p.y();
    const double s = p.squaredNorm();
    const double radial = 1 + s * (k[0] + s * (k[1] + s * k[4]));
    const double radial_by_s = k[0] + s * (2 * k[1] + s * 3 * k[4]);
    const double mixed = 2 * x * y * radial_by_s + 2 * k[2] * x + 2 * k[3] * y;
    Eigen::Matrix2d jacobian;
    jacobian << radial + 2 * x * x * radial_by_s + 2 * k[2] * y + 6 * k[3] * x, mixed,  //
        mixed, radial + 2 * y * y * radial_by_s + 6 * k[2] * y + 2 * k[3] * x;
    return jacobian;
}

// Newton's method from the centre, with steps halved until they come closer without folding over.
// Where no point has this image, ends at the rim of the fold.
Vec2 undistort(const std::array<double, 5>& k, const Vec2& distorted) {
    if (k == std::array<double, 5>{}) return distorted;
    Vec2 p = Vec2::Zero();
    Vec2 residual = distorted;
    for (int i = 0; i < kMaxNewtonSteps && residual.norm() > kUndistortTolerance; ++i) {
        const Eigen::Matrix2d jacobian = distort_jacobian(k, p);
        if (!(jacobian.determinant() > 0)) break;
        const Vec2 step = jacobian.inverse() * residual;
        double share = 1;
        for (; share > kSmallestStep; share *= 0.5) {
            const Vec2 candidate = p + share * step;
            const Vec2 candidate_residual = distorted - distort(k, candidate);
            if (folds_over(k, candidate.squaredNorm()) ||
                !(candidate_residual.norm() < residual.norm())) {
                continue;
            }
            p = candidate;
            residual = candidate_residual;
            break;
        }
        if (share <= kSmallestStep) break;
    }
    return p;
}

Vec3 position_at(const Camera& camera, double azimuth) {
    if (camera.model != CameraModel::registered) return camera.world_from_camera.translation;
    return camera.frame == FrameOfReference::scanner ? rotate_about_y(azimuth, camera.position)
                                                     : camera.position;
}

}  // namespace

std::optional<Vec2> Camera::project(const Vec3& p_world) const {
    PATINA_CHECK(model != CameraModel::registered);
    const Vec3 p = world_from_camera.inverse().point(p_world);
    if (model == CameraModel::orthographic) {
        return Vec2(p.x() / pixel_size + 0.5 * width, p.y() / pixel_size + 0.5 * height);
    }
    if (!(p.z() > 0)) return std::nullopt;
    const Vec2 undistorted = p.head<2>() / p.z();
    if (folds_over(distortion, undistorted.squaredNorm())) return std::nullopt;
    const Vec2 q = distort(distortion, undistorted);
    const Vec2 pixel(fx * q.x() + cx, fy * q.y() + cy);
    // The polynomial of a point beside the camera may overflow.
    return pixel.allFinite() ? std::optional(pixel) : std::nullopt;
}

Ray Camera::ray(const Vec2& pixel) const {
    PATINA_CHECK(model != CameraModel::registered);
    if (model == CameraModel::orthographic) {
        const Vec3 origin(
            (pixel.x() - 0.5 * width) * pixel_size, (pixel.y() - 0.5 * height) * pixel_size, 0);
        return {world_from_camera.point(origin), world_from_camera.direction(Vec3::UnitZ())};
    }
    const Vec2 p = undistort(distortion, Vec2((pixel.x() - cx) / fx, (pixel.y() - cy) / fy));
    return {world_from_camera.translation,
            world_from_camera.direction(Vec3(p.x(), p.y(), 1).normalized())};
}

Vec3 Camera::direction_from(const Vec3& p_world, double azimuth) const {
    if (model == CameraModel::orthographic) return world_from_camera.direction(-Vec3::UnitZ());
    return (position_at(*this, azimuth) - p_world).normalized();
}

double Camera::distance_from(const Vec3& p_world, double azimuth) const {
    if (model == CameraModel::orthographic) return depth_of(p_world);
    return (position_at(*this, azimuth) - p_world).norm();
}

double Camera::depth_of(const Vec3& p_world) const {
    PATINA_CHECK(model != CameraModel::registered);
    return world_from_camera.rotation.col(2).dot(p_world - world_from_camera.translation);
}

}  // namespace patina
