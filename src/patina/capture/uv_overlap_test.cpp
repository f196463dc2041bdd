#include "patina/capture/uv_overlap.h"

#include "patina/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace patina {
namespace {

constexpr double kTolerance = 1e-6;  // [uv]

Mesh mesh_of(const std::vector<Vec2f>& uvs, const std::vector<Triangle>& triangles) {
    Mesh mesh;
    mesh.uvs = uvs;
    mesh.triangles = triangles;
    mesh.positions.resize(uvs.size(), Vec3f::Zero());
    return mesh;
}

// A grid of n x n squares of two triangles each, rotated in the unit square so that no coordinate
// is round.
Mesh rotated_grid(std::uint32_t n) {
    Mesh mesh;
    const float angle = 0.3F;
    const float scale = 0.7F / float(n);
    for (std::uint32_t j = 0; j <= n; ++j) {
        for (std::uint32_t i = 0; i <= n; ++i) {
            const float x = float(i) * scale;
            const float y = float(j) * scale;
            mesh.uvs.emplace_back(0.25F + std::cos(angle) * x - std::sin(angle) * y,
                                  0.05F + std::sin(angle) * x + std::cos(angle) * y);
        }
    }
    for (std::uint32_t j = 0; j < n; ++j) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i;
            mesh.triangles.push_back({a, a + 1, a + n + 2});
            mesh.triangles.push_back({a, a + n + 2, a + n + 1});
        }
    }
    return mesh;
}

double area_of(const std::vector<Vec2>& polygon) {
    double twice = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2& p = polygon[i];
        const Vec2& q = polygon[(i + 1) % polygon.size()];
        twice += p.x() * q.y() - p.y() * q.x();
    }
    return twice / 2;
}

std::vector<Vec2> corners_of(const Mesh& mesh, const Triangle& triangle) {
    std::vector<Vec2> corners;
    for (const std::uint32_t corner : triangle) corners.push_back(mesh.uvs[corner].cast<double>());
    if (area_of(corners) < 0) std::swap(corners[1], corners[2]);
    return corners;
}

// Area that two triangles share: one cut by each edge of the other (Sutherland, Hodgman 1974).
double shared_area(const std::vector<Vec2>& clipped, const std::vector<Vec2>& clipping) {
    std::vector<Vec2> polygon = clipped;
    for (std::size_t e = 0; e < clipping.size(); ++e) {
        const Vec2 from = clipping[e];
        const Vec2 edge = clipping[(e + 1) % clipping.size()] - from;
        const auto side = [&](const Vec2& p) {
            return edge.x() * (p.y() - from.y()) - edge.y() * (p.x() - from.x());
        };
        std::vector<Vec2> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Vec2& p = polygon[i];
            const Vec2& q = polygon[(i + 1) % polygon.size()];
            if (side(p) >= 0) kept.push_back(p);
            if ((side(p) >= 0) != (side(q) >= 0)) {
                kept.push_back(p + (q - p) * (side(p) / (side(p) - side(q))));
            }
        }
        polygon = kept;
    }
    return area_of(polygon);
}

TEST(UvOverlap, IsNotRaisedByNeighbours) {
    EXPECT_FALSE(find_uv_overlap(rotated_grid(50), kTolerance));
}

TEST(UvOverlap, IsNotRaisedByMirroredNeighbours) {
    const Mesh mesh = mesh_of({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 3, 2}});
    EXPECT_FALSE(find_uv_overlap(mesh, kTolerance));
}

TEST(UvOverlap, FindsANeighbourFoldedOver) {
    const Mesh mesh = mesh_of({{0, 0}, {1, 0}, {0.5F, 1}, {0.6F, 0.9F}}, {{0, 1, 2}, {0, 1, 3}});
    const auto overlap = find_uv_overlap(mesh, kTolerance);
    ASSERT_TRUE(overlap);
    EXPECT_EQ(overlap->first, 0U);
    EXPECT_EQ(overlap->second, 1U);
}

TEST(UvOverlap, FindsATriangleWithinAnother) {
    const Mesh mesh = mesh_of({{0, 0}, {1, 0}, {0, 1}, {0.2F, 0.2F}, {0.3F, 0.2F}, {0.2F, 0.3F}},
                              {{3, 4, 5}, {0, 1, 2}});
    EXPECT_TRUE(find_uv_overlap(mesh, kTolerance));
}

TEST(UvOverlap, FindsTheSameTriangleTwice) {
    Mesh mesh = rotated_grid(20);
    mesh.triangles.push_back(mesh.triangles[123]);
    const auto overlap = find_uv_overlap(mesh, kTolerance);
    ASSERT_TRUE(overlap);
    EXPECT_EQ(overlap->first, 123U);
    EXPECT_EQ(overlap->second, 800U);
}

TEST(UvOverlap, NamesTheFirstFaultHoweverFarItIs) {
    Mesh mesh = rotated_grid(60);
    mesh.triangles.push_back(mesh.triangles[7100]);
    mesh.triangles.push_back(mesh.triangles[5000]);
    const auto overlap = find_uv_overlap(mesh, kTolerance);
    ASSERT_TRUE(overlap);
    EXPECT_EQ(overlap->first, 5000U);
    EXPECT_EQ(overlap->second, 7201U);
}

TEST(UvOverlap, ToleratesLessThanTheTolerance) {
    const auto chart_pair = [](float depth) {
        return mesh_of({{0, 0}, {0.5F, 0}, {0.5F, 1}, {0.5F - depth, 0}, {1, 0}, {0.5F - depth, 1}},
                       {{0, 1, 2}, {3, 4, 5}});
    };
    EXPECT_FALSE(find_uv_overlap(chart_pair(0.0009F), 0.001));
    EXPECT_TRUE(find_uv_overlap(chart_pair(0.0011F), 0.001));
}

// The probability that random triangles share an area between the two thresholds' is below 1e-4.
TEST(UvOverlap, AgreesWithTheAreaThatTwoTrianglesShare) {
    constexpr int kTrials = 2000;
    constexpr double kNoArea = 1e-10;
    int num_overlapping = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        Rng rng(7, Pass::tests, std::uint64_t(trial));
        std::vector<Vec2f> uvs;
        for (int i = 0; i < 6; ++i) {
            const auto u = float(rng.uniform());
            const auto v = float(rng.uniform());
            uvs.emplace_back(u, v);
        }
        const Mesh mesh = mesh_of(uvs, {{0, 1, 2}, {3, 4, 5}});
        const double area =
            shared_area(corners_of(mesh, mesh.triangles[0]), corners_of(mesh, mesh.triangles[1]));
        EXPECT_EQ(find_uv_overlap(mesh, kTolerance).has_value(), area > kNoArea)
            << "trial " << trial << ", shared area " << area;
        num_overlapping += area > kNoArea ? 1 : 0;
    }
    // Both answers are well represented.
    EXPECT_GT(num_overlapping, kTrials / 10);
    EXPECT_LT(num_overlapping, kTrials * 9 / 10);
}

}  // namespace
}  // namespace patina
