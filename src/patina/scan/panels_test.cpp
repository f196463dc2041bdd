#include "patina/scan/panels.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

std::vector<Panel> two_panels() {
    return {{Vec3(0, 2, 0), Vec3(3, 0, 0), Vec3(0, -2, 0), 2},
            {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 0, 1), 1}};
}

TEST(Panels, PointOfTheTextureHasThatTextureCoordinate) {
    const std::vector<Panel> panels = two_panels();
    const Mesh mesh = mesh_of_panels(panels);
    for (const double u : {0.001, 0.24, 0.51, 0.999}) {
        for (const double v : {0.001, 0.3, 0.66, 0.67, 0.8, 0.999}) {
            const SurfacePoint point = point_on_panels(mesh, panels, {u, v});
            const Vec2 uv = surface_uv(mesh, point.triangle, point.barycentric);
            EXPECT_NEAR(uv.x(), u, 1e-6);
            EXPECT_NEAR(1 - uv.y(), v, 1e-6);
        }
    }
}

TEST(Panels, TextureRunsDownThePanelsInTheirShares) {
    const std::vector<Panel> panels = two_panels();
    const Mesh mesh = mesh_of_panels(panels);
    const SurfacePoint standing = point_on_panels(mesh, panels, {0.5, 1.0 / 3});
    EXPECT_TRUE(standing.position.isApprox(Vec3(1.5, 1, 0), 1e-6));
    EXPECT_TRUE(standing.geometric_normal.isApprox(Vec3::UnitZ(), 1e-6));
    const SurfacePoint lying = point_on_panels(mesh, panels, {0.5, 5.0 / 6});
    EXPECT_TRUE(lying.position.isApprox(Vec3(1.5, 0, 0.5), 1e-6));
    EXPECT_TRUE(lying.geometric_normal.isApprox(Vec3::UnitY(), 1e-6));
}

TEST(Panels, NormalsAreThoseOfTheReflectingSide) {
    const Mesh mesh = mesh_of_panels(two_panels());
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const SurfacePoint point = surface_point(mesh, i, Vec2f::Constant(0.3f));
        EXPECT_NEAR(point.geometric_normal.dot(point.normal), 1, 1e-6);
    }
}

}  // namespace
}  // namespace patina
