#include "patina/scene/unwrap.h"

#include "patina/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace patina {
namespace {

Mesh random_triangles(std::size_t count) {
    Mesh mesh;
    Rng rng(1, Pass::tests, 0);
    for (std::uint32_t i = 0; i < 3 * count; ++i) {
        const double x = rng.uniform();
        const double y = rng.uniform();
        mesh.positions.push_back(Vec3(x, y, rng.uniform()).cast<float>());
        mesh.normals.emplace_back(0.0f, 0.0f, 1.0f);
    }
    for (std::uint32_t i = 0; i < count; ++i)
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    return mesh;
}

// Whether the triangle and an axis-aligned unit cell share more than a border: no edge of either
// separates them.
bool overlaps_cell(const std::array<Vec2, 3>& triangle, int i, int j) {
    const auto separated = [&](const Vec2& axis) {
        constexpr double kFar = 1e30;
        double low = kFar;
        double high = -kFar;
        double cell_low = kFar;
        double cell_high = -kFar;
        for (const Vec2& p : triangle) {
            low = std::min(low, axis.dot(p));
            high = std::max(high, axis.dot(p));
        }
        for (const Vec2& p : {Vec2(i, j), Vec2(i + 1, j), Vec2(i, j + 1), Vec2(i + 1, j + 1)}) {
            cell_low = std::min(cell_low, axis.dot(p));
            cell_high = std::max(cell_high, axis.dot(p));
        }
        return high <= cell_low || cell_high <= low;
    };
    if (separated(Vec2::UnitX()) || separated(Vec2::UnitY())) return false;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 edge = triangle[(k + 1) % 3] - triangle[k];
        if (separated(Vec2(-edge.y(), edge.x()))) return false;
    }
    return true;
}

bool holds(const std::array<Vec2, 3>& t, const Vec2& p) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 edge = t[(k + 1) % 3] - t[k];
        const Vec2 to_p = p - t[k];
        // Charts are counter-clockwise, as their triangles are.
        if (edge.x() * to_p.y() - edge.y() * to_p.x() <= 0) return false;
    }
    return true;
}

class Unwrap : public testing::TestWithParam<std::array<int, 3>> {};

TEST_P(Unwrap, GivesEveryChartTexelsOfItsOwn) {
    const auto [count, width, height] = GetParam();
    const auto mesh = unwrap(random_triangles(std::size_t(count)), width, height);
    ASSERT_TRUE(mesh);
    ASSERT_EQ(mesh->triangles.size(), std::size_t(count));
    std::vector<int> owner(std::size_t(width * height), -1);
    for (int t = 0; t < count; ++t) {
        std::array<Vec2, 3> chart;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2f& uv = mesh->uvs[mesh->triangles[std::size_t(t)][k]];
            ASSERT_TRUE(uv.x() >= 0 && uv.x() <= 1 && uv.y() >= 0 && uv.y() <= 1);
            chart[k] = Vec2(double(uv.x()) * width, double(uv.y()) * height);
        }
        int num_centres = 0;
        for (int j = 0; j < height; ++j) {
            for (int i = 0; i < width; ++i) {
                if (!overlaps_cell(chart, i, j)) continue;
                int& cell = owner[std::size_t(j * width + i)];
                EXPECT_EQ(cell, -1) << "texel " << i << ", " << j;
                cell = t;
                if (holds(chart, Vec2(i + 0.5, j + 0.5))) ++num_centres;
            }
        }
        EXPECT_GE(num_centres, 1) << "chart " << t;
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes,
                         Unwrap,
                         testing::Values(std::array{1, 3, 3},
                                         std::array{2, 3, 4},
                                         std::array{7, 13, 9},
                                         std::array{50, 20, 40},
                                         std::array{200, 64, 48}));

TEST(UnwrapMesh, KeepsSurfaceAndNormals) {
    const Mesh mesh = random_triangles(9);
    const auto unwrapped = unwrap(mesh, 32, 32);
    ASSERT_TRUE(unwrapped);
    for (std::uint32_t t = 0; t < 9; ++t) {
        // The corners turn, the triangle stays.
        EXPECT_NEAR(triangle_area(*unwrapped, t), triangle_area(mesh, t), 1e-12);
        const Vec3 before = surface_point(mesh, t, Vec2f(0, 0)).geometric_normal;
        EXPECT_LT((surface_point(*unwrapped, t, Vec2f(0, 0)).geometric_normal - before).norm(),
                  1e-5);
    }
    EXPECT_EQ(unwrapped->normals.size(), unwrapped->positions.size());
}

TEST(UnwrapMesh, GivesNothingWhereTexelsAreTooFew) {
    EXPECT_FALSE(unwrap(random_triangles(3), 5, 5));
    EXPECT_FALSE(unwrap(random_triangles(1), 2, 100));
    EXPECT_TRUE(unwrap(random_triangles(3), 6, 3));
}

}  // namespace
}  // namespace patina
