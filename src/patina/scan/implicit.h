// Signed distances of simple solids, and smooth unions of them: the clay of the figurines.
//
// Negative inside, positive outside, close to the Euclidean distance near the surface [length].
//
// The smooth minimum is the quadratic polynomial one, whose gradient stays of length 1 or less.
#pragma once

#include "patina/math/types.h"

#include <functional>
#include <span>

namespace patina {

// A solid: its signed distance at a point [length].
using SignedDistance = std::function<double(const Vec3&)>;

[[nodiscard]] double sphere_distance(const Vec3& p, const Vec3& center, double radius);
// First-order distance, exact on the surface; radii: half axes along x, y, z.
[[nodiscard]] double ellipsoid_distance(const Vec3& p, const Vec3& center, const Vec3& radii);
// Segment from a to b swept by a ball.
[[nodiscard]] double capsule_distance(const Vec3& p, const Vec3& a, const Vec3& b, double radius);
// Hull of two balls; the smaller one must not lie inside the larger one.
[[nodiscard]] double rounded_cone_distance(
    const Vec3& p, const Vec3& a, const Vec3& b, double radius_a, double radius_b);
// Cylinder from a to b whose rims are rounded by `rounding`.
[[nodiscard]] double rounded_cylinder_distance(
    const Vec3& p, const Vec3& a, const Vec3& b, double radius, double rounding);
// Union of the rounded cones between neighbouring points; at least two points.
struct ChainPoint {
    Vec3 position;
    double radius;
};
[[nodiscard]] double chain_distance(const Vec3& p, std::span<const ChainPoint> points);

// Union whose seam is filled over about `width` [length]; width > 0.
[[nodiscard]] double smooth_union(double a, double b, double width);
// a without b, the edge rounded over about `width` [length]; width > 0.
[[nodiscard]] double smooth_difference(double a, double b, double width);

// p on the side of positive x, so that one half of a symmetric solid stands for both. Within about
// `width` of the plane x = 0 the fold is round: what meets there has no crease of no width, which
// no scan could resolve. width > 0 [length].
[[nodiscard]] Vec3 fold_at_x0(const Vec3& p, double width);

// Gradient by central differences over `step` [length].
[[nodiscard]] Vec3 distance_gradient(const SignedDistance& distance, const Vec3& p, double step);

}  // namespace patina
