#include "patina/scan/implicit.h"

#include "patina/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace patina {
namespace {

constexpr int kNumPoints = 200;

// Points of a cube of half edge 3, the same every time.
std::vector<Vec3> random_points() {
    Rng rng(1, Pass::tests, 0);
    std::vector<Vec3> points;
    for (int i = 0; i < kNumPoints; ++i) {
        points.emplace_back(6 * rng.uniform() - 3, 6 * rng.uniform() - 3, 6 * rng.uniform() - 3);
    }
    return points;
}

TEST(Implicit, RoundedConeIsTheUnionOfItsBalls) {
    const Vec3 a(-0.5, 0.2, 0.1);
    const Vec3 b(0.9, 1.1, -0.4);
    constexpr int kNumBalls = 4000;
    for (const Vec3& p : random_points()) {
        double nearest = std::numeric_limits<double>::infinity();
        for (int i = 0; i <= kNumBalls; ++i) {
            const double t = double(i) / kNumBalls;
            nearest = std::min(nearest, sphere_distance(p, a + t * (b - a), 1.0 - 0.6 * t));
        }
        // Balls at a spacing of s miss the minimum by less than s.
        const double spacing = (b - a).norm() / kNumBalls;
        EXPECT_NEAR(rounded_cone_distance(p, a, b, 1.0, 0.4), nearest, spacing);
    }
}

TEST(Implicit, EllipsoidVanishesOnItsSurfaceWithAUnitGradient) {
    const Vec3 center(0.3, -0.2, 0.5);
    const Vec3 radii(1.0, 2.0, 0.5);
    for (const Vec3& direction : random_points()) {
        const Vec3 p = center + direction.normalized().cwiseProduct(radii);
        EXPECT_NEAR(ellipsoid_distance(p, center, radii), 0, 1e-12);
        const auto distance = [&](const Vec3& q) { return ellipsoid_distance(q, center, radii); };
        EXPECT_NEAR(distance_gradient(distance, p, 1e-5).norm(), 1, 1e-6);
    }
}

TEST(Implicit, CylinderHasItsRadiusAndItsLength) {
    const auto distance = [](double x, double y) {
        return rounded_cylinder_distance({x, y, 0}, {0, -1, 0}, {0, 1, 0}, 0.5, 0.1);
    };
    EXPECT_NEAR(distance(0.5, 0), 0, 1e-12);
    EXPECT_NEAR(distance(0, 1), 0, 1e-12);
    EXPECT_NEAR(distance(0, 1.7), 0.7, 1e-12);
    EXPECT_NEAR(distance(0.9, 0), 0.4, 1e-12);
    // The rim is a quarter circle of radius 0.1 about (0.4, 0.9).
    EXPECT_NEAR(distance(0.4 + 0.1 * std::sqrt(0.5), 0.9 + 0.1 * std::sqrt(0.5)), 0, 1e-12);
}

TEST(Implicit, SmoothUnionIsExactAwayFromTheSeam) {
    EXPECT_DOUBLE_EQ(smooth_union(0.3, 0.9, 0.5), 0.3);
    EXPECT_DOUBLE_EQ(smooth_union(0.9, 0.3, 0.5), 0.3);
    EXPECT_DOUBLE_EQ(smooth_union(0.3, 0.3, 0.4), 0.3 - 0.1);
    EXPECT_DOUBLE_EQ(smooth_difference(0.3, -0.9, 0.5), 0.9);
}

TEST(Implicit, ChainIsTheUnionOfItsCones) {
    const std::vector<ChainPoint> chain = {{{0, 0, 0}, 0.5}, {{1, 0, 0}, 0.4}, {{1, 1, 0}, 0.2}};
    for (const Vec3& p : random_points()) {
        const double first = rounded_cone_distance(p, {0, 0, 0}, {1, 0, 0}, 0.5, 0.4);
        const double second = rounded_cone_distance(p, {1, 0, 0}, {1, 1, 0}, 0.4, 0.2);
        EXPECT_DOUBLE_EQ(chain_distance(p, chain), std::min(first, second));
    }
}

}  // namespace
}  // namespace patina
