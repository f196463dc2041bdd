#include "patina/pipeline/uv_locator.h"

#include "patina/base/random.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

// Squares over [0, 1]^2 of the texture and [0, 2] x [0, 3] in space, cut in two each.
Mesh flat_grid(int cells) {
    Mesh mesh;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const float u = float(i) / float(cells);
            const float v = float(j) / float(cells);
            mesh.positions.emplace_back(2 * u, 3 * v, 0.0f);
            mesh.uvs.emplace_back(u, v);
            mesh.normals.emplace_back(0.0f, 0.0f, 1.0f);
        }
    }
    const auto at = [cells](int i, int j) { return std::uint32_t(j * (cells + 1) + i); };
    for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

TEST(UvLocator, FindsThePointOfEveryPosition) {
    const Mesh mesh = flat_grid(7);
    const UvLocator locator(mesh, 5, 9);
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(1, Pass::tests, i);
        const double u = rng.uniform();
        const double v = rng.uniform();
        const auto point = locator.find({u, v});
        ASSERT_TRUE(point.has_value()) << u << " " << v;
        // Single-precision uvs and positions.
        EXPECT_NEAR(point->position.x(), 2 * u, 1e-6);
        EXPECT_NEAR(point->position.y(), 3 * v, 1e-6);
    }
}

TEST(UvLocator, FindsCornersAndEdges) {
    const Mesh mesh = flat_grid(4);
    const UvLocator locator(mesh, 4, 4);
    for (const double u : {0.0, 0.25, 0.5, 1.0}) {
        for (const double v : {0.0, 0.25, 0.5, 1.0}) {
            EXPECT_TRUE(locator.find({u, v}).has_value()) << u << " " << v;
        }
    }
}

TEST(UvLocator, FindsNothingBesideTheCharts) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, Vec3f::UnitZ());
    mesh.uvs = {{0.1f, 0.1f}, {0.6f, 0.1f}, {0.1f, 0.6f}};
    mesh.triangles = {{0, 1, 2}};
    const UvLocator locator(mesh, 8, 8);
    EXPECT_TRUE(locator.find({0.2, 0.2}).has_value());
    EXPECT_FALSE(locator.find({0.5, 0.5}).has_value());
    EXPECT_FALSE(locator.find({0.05, 0.2}).has_value());
    EXPECT_FALSE(locator.find({0.9, 0.9}).has_value());
}

}  // namespace
}  // namespace patina
