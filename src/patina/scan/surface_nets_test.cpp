#include "patina/scan/surface_nets.h"

#include "patina/scan/mesh_topology.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

const Bounds kBounds{Vec3::Constant(-1.6), Vec3::Constant(1.6)};

double total_area(const Mesh& mesh) {
    double area = 0;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) area += triangle_area(mesh, i);
    return area;
}

double torus(const Vec3& p) { return std::hypot(std::hypot(p.x(), p.z()) - 1.0, p.y()) - 0.4; }

double ball(const Vec3& p) { return sphere_distance(p, Vec3::Zero(), 1.0); }

TEST(SurfaceNets, SphereIsClosedAndOfTheRightArea) {
    const double cell = 0.05;
    const Mesh mesh = surface_nets(ball, {kBounds, cell});
    const MeshTopology topology = mesh_topology(mesh);
    EXPECT_EQ(topology.num_open_edges, 0u);
    EXPECT_EQ(topology.euler_characteristic, 2);
    // A chord of length h on the unit sphere is shorter than its arc by h^2 / 24; the quads'
    // diagonals are at most 2 sqrt(3) cells long, and areas shrink twice as much as lengths.
    EXPECT_NEAR(total_area(mesh) / (4 * kPi), 1, square(2 * std::sqrt(3.0) * cell) / 12);
}

TEST(SurfaceNets, VerticesLieOnTheSurfaceWithItsNormals) {
    const Mesh mesh = surface_nets(ball, {kBounds, 0.1});
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3 p = mesh.positions[i].cast<double>();
        // Single precision: 2^-24 of a coordinate below 2.
        EXPECT_NEAR(p.norm(), 1, 2e-6);
        // Central differences over 0.005 are exact to its square.
        EXPECT_NEAR(mesh.normals[i].cast<double>().dot(p.normalized()), 1, 1e-5);
    }
}

TEST(SurfaceNets, TrianglesFaceOutwards) {
    // Cells off the torus's symmetry: on it, opposite corners of a quad may fall together.
    const Bounds bounds{Vec3(-1.63, -1.61, -1.64), Vec3::Constant(1.6)};
    const Mesh mesh = surface_nets(torus, {bounds, 0.1});
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const SurfacePoint point = surface_point(mesh, i, Vec2f::Constant(1.0f / 3.0f));
        EXPECT_GT(point.geometric_normal.dot(point.normal), 0);
    }
}

TEST(SurfaceNets, TorusHasItsHole) {
    const MeshTopology topology = mesh_topology(surface_nets(torus, {kBounds, 0.1}));
    EXPECT_EQ(topology.num_open_edges, 0u);
    EXPECT_EQ(topology.euler_characteristic, 0);
}

// Slanted plates thinner than a cell cross the grid's faces at opposite corners.
TEST(SurfaceNets, StaysClosedWhereTheSamplesAreAmbiguous) {
    const auto plates = [](const Vec3& p) {
        const Vec3 across = Vec3(1, 1, 0.3).normalized();
        const double wave = std::abs(std::remainder(p.dot(across), 0.31)) - 0.05;
        return std::max(wave, ball(p));
    };
    const Mesh mesh = surface_nets(plates, {kBounds, 0.13});
    EXPECT_GT(mesh.triangles.size(), 100u);
    EXPECT_EQ(mesh_topology(mesh).num_open_edges, 0u);
}

}  // namespace
}  // namespace patina
