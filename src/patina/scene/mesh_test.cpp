#include "patina/scene/mesh.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

// A right triangle of the xy plane with legs 2 and 3, normal +z.
Mesh right_triangle() {
    Mesh mesh;
    mesh.positions = {{0, 0, 1}, {2, 0, 1}, {0, 3, 1}};
    mesh.normals.assign(3, Vec3f(0, 0, 0));
    mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

TEST(SurfacePoint, InterpolatesBetweenTheCorners) {
    const SurfacePoint point = surface_point(right_triangle(), 0, Vec2f(0.25f, 0.5f));
    EXPECT_LT((point.position - Vec3(0.5, 1.5, 1)).norm(), 1e-12);
    EXPECT_EQ(point.geometric_normal, Vec3(0, 0, 1));
    EXPECT_EQ(surface_uv(right_triangle(), 0, Vec2f(0.25f, 0.5f)), Vec2(0.25, 0.5));
}

TEST(SurfacePoint, SmoothNormalIsUnit) {
    Mesh mesh = right_triangle();
    mesh.normals = {Vec3f(0, 0, 1), Vec3f(1, 0, 0), Vec3f(0, 1, 0)};
    const SurfacePoint point = surface_point(mesh, 0, Vec2f(0.5f, 0));
    EXPECT_LT((point.normal - Vec3(1, 0, 1).normalized()).norm(), 1e-12);
    EXPECT_EQ(point.geometric_normal, Vec3(0, 0, 1));
}

TEST(SurfacePoint, FallsBackToTheGeometricNormal) {
    Mesh mesh = right_triangle();
    EXPECT_EQ(surface_point(mesh, 0, Vec2f(0.3f, 0.3f)).normal, Vec3(0, 0, 1));
    mesh.normals[1] = Vec3f(1, 0, 0);  // one corner alone has a normal
    EXPECT_EQ(surface_point(mesh, 0, Vec2f(0.3f, 0.3f)).normal, Vec3(0, 0, 1));
    mesh.normals = {Vec3f(1, 0, 0), Vec3f(-1, 0, 0), Vec3f(0, 1, 0)};  // cancel between two corners
    EXPECT_EQ(surface_point(mesh, 0, Vec2f(0.5f, 0)).normal, Vec3(0, 0, 1));
    mesh.normals.clear();
    EXPECT_EQ(surface_point(mesh, 0, Vec2f(0.3f, 0.3f)).normal, Vec3(0, 0, 1));
}

TEST(SurfacePoint, OfATriangleWithoutAreaHasNoNan) {
    Mesh mesh = right_triangle();
    mesh.positions[2] = mesh.positions[1];
    const SurfacePoint point = surface_point(mesh, 0, Vec2f(0.3f, 0.3f));
    EXPECT_NEAR(point.geometric_normal.norm(), 1, 1e-12);
    EXPECT_NEAR(point.normal.norm(), 1, 1e-12);
}

TEST(Mesh, KnowsItsAreaAndBounds) {
    const Mesh mesh = right_triangle();
    EXPECT_DOUBLE_EQ(triangle_area(mesh, 0), 3);
    const Bounds bounds = bounds_of(mesh);
    EXPECT_EQ(bounds.low, Vec3(0, 0, 1));
    EXPECT_EQ(bounds.high, Vec3(2, 3, 1));
    EXPECT_DOUBLE_EQ(bounds.diagonal(), std::sqrt(13.0));
    EXPECT_EQ(bounds_of(Mesh{}).diagonal(), 0);
}

}  // namespace
}  // namespace patina
