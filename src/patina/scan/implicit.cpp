#include "patina/scan/implicit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {
double sphere_distance(const Vec3& p, const Vec3& center, double radius) {
    return (p - center).norm() - radius;
}

double ellipsoid_distance(const Vec3& p, const Vec3& center, const Vec3& radii) {
    const Vec3 scaled = (p - center).cwiseQuotient(radii);
    const double gradient = scaled.cwiseQuotient(radii).norm();
    const double k = scaled.norm();
    if (gradient == 0) return -radii.minCoeff();
    return k * (k - 1.0) / gradient;
}

double capsule_distance(const Vec3& p, const Vec3& a, const Vec3& b, double radius) {
    const Vec3 axis = b - a;
    const double t = std::clamp((p - a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
    return (p - a - t * axis).norm() - radius;
}

double rounded_cone_distance(
    const Vec3& p, const Vec3& a, const Vec3& b, double radius_a, double radius_b) {
    const double length = (b - a).norm();
    const Vec3 axis = (b - a) / length;
    const double along = (p - a).dot(axis);
    const double across = (p - a - along * axis).norm();
    // The cone's flank leans by asin((ra - rb) / length); points project on the axis along its
    // normal.
    const double sine = std::clamp((radius_a - radius_b) / length, -1.0, 1.0);
    const double cosine = std::sqrt(1.0 - sine * sine);
    if (cosine == 0) return (p - (sine > 0 ? a : b)).norm() - std::max(radius_a, radius_b);
    const double t = std::clamp((along - across * sine / cosine) / length, 0.0, 1.0);
    return (p - a - t * length * axis).norm() - ((1 - t) * radius_a + t * radius_b);
}

double rounded_cylinder_distance(
    const Vec3& p, const Vec3& a, const Vec3& b, double radius, double rounding) {
    const double half_length = 0.5 * (b - a).norm();
    const Vec3 axis = (b - a) / (2 * half_length);
    const Vec3 local = p - 0.5 * (a + b);
    const double along = local.dot(axis);
    const double across = (local - along * axis).norm();
    const Vec2 outside(across - radius + rounding, std::abs(along) - half_length + rounding);
    return std::min(outside.maxCoeff(), 0.0) + outside.cwiseMax(0.0).norm() - rounding;
}

double chain_distance(const Vec3& p, std::span<const ChainPoint> points) {
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const ChainPoint& a = points[i];
        const ChainPoint& b = points[i + 1];
        distance = std::min(distance,
                            rounded_cone_distance(p, a.position, b.position, a.radius, b.radius));
    }
    return distance;
}

double smooth_union(double a, double b, double width) {
    const double overlap = std::max(width - std::abs(a - b), 0.0);
    return std::min(a, b) - overlap * overlap / (4 * width);
}

double smooth_difference(double a, double b, double width) { return -smooth_union(-a, b, width); }

Vec3 fold_at_x0(const Vec3& p, double width) { return {std::hypot(p.x(), width), p.y(), p.z()}; }

Vec3 distance_gradient(const SignedDistance& distance, const Vec3& p, double step) {
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 offset = step * Vec3::Unit(axis);
        gradient[axis] = (distance(p + offset) - distance(p - offset)) / (2 * step);
    }
    return gradient;
}

}  // namespace patina
