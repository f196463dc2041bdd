#include "patina/scan/figurines.h"

#include "patina/base/random.h"
#include "patina/scan/material.h"
#include "patina/scan/mesh_topology.h"
#include "patina/scan/object.h"
#include "patina/scan/surface_nets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

namespace patina {
namespace {

constexpr std::size_t kLeastTriangles = 50'000;

struct Range {
    double low = 1e9;
    double high = -1e9;

    void add(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

class Figurines : public testing::TestWithParam<ObjectKind> {};

INSTANTIATE_TEST_SUITE_P(BAndC,
                         Figurines,
                         testing::Values(ObjectKind::b, ObjectKind::c),
                         [](const testing::TestParamInfo<ObjectKind>& kind) {
                             return std::string(kind.param == ObjectKind::b ? "Cat" : "Pig");
                         });

TEST_P(Figurines, AreClosedSurfacesOfManyTrianglesStandingOnTheGround) {
    const SimulatedObject object = make_object(GetParam(), 8, 8);
    const MeshTopology topology = mesh_topology(object.mesh);
    EXPECT_EQ(topology.num_open_edges, 0u);
    EXPECT_GE(object.mesh.triangles.size(), kLeastTriangles);
    const Bounds bounds = bounds_of(object.mesh);
    EXPECT_NEAR(bounds.low.y(), 0, 0.001);
    EXPECT_GT(bounds.high.y(), 0.13);
    EXPECT_LT(bounds.high.y(), 0.21);
}

TEST_P(Figurines, ReflectanceIsRealAndVariesOverTheSurface) {
    const SimulatedObject object = make_object(GetParam(), 8, 8);
    Range diffuse;
    Range gloss;
    Range roughness;
    for (const Reflectance& value : object.reflectance) {
        for (const double channel : value.diffuse) diffuse.add(channel);
        gloss.add(value.specular * 2 * square(value.roughness));
        roughness.add(value.roughness);
        ASSERT_FALSE(project_to_feasible(value).was_clamped);
    }
    constexpr double kRounding = 1e-12;
    EXPECT_GE(diffuse.low, kObjectMinDiffuse);
    EXPECT_LE(diffuse.high, kObjectMaxDiffuse);
    EXPECT_GE(gloss.low, kObjectMinGloss - kRounding);
    EXPECT_LE(gloss.high, kObjectMaxGloss + kRounding);
    EXPECT_GE(roughness.low, kObjectMinRoughness);
    EXPECT_LE(roughness.high, kObjectMaxRoughness);
    EXPECT_GT(diffuse.high, 4 * diffuse.low);
    EXPECT_GT(gloss.high, 2 * gloss.low);
    EXPECT_GT(roughness.high, 2 * roughness.low);
}

// What surface_nets() relies on when it skips empty space.
TEST_P(Figurines, DistanceIsNeverFarTooLarge) {
    const Figurine figurine = GetParam() == ObjectKind::b ? make_cat() : make_pig();
    const Mesh mesh = surface_nets(figurine.distance, {figurine.bounds, 0.003});
    const Vec3 size = figurine.bounds.high - figurine.bounds.low;
    Rng rng(1, Pass::tests, 0);
    for (int i = 0; i < 500; ++i) {
        const Vec3 share(rng.uniform(), rng.uniform(), rng.uniform());
        const Vec3 p = figurine.bounds.low + share.cwiseProduct(size);
        double nearest = std::numeric_limits<double>::infinity();
        for (const Vec3f& vertex : mesh.positions) {
            nearest = std::min(nearest, (vertex.cast<double>() - p).norm());
        }
        EXPECT_LE(std::abs(figurine.distance(p)), kMaxDistanceRatio * nearest) << p.transpose();
    }
}

TEST(Crease, IsDeepInAGapAndFlatOnABall) {
    const SignedDistance ball = [](const Vec3& p) { return sphere_distance(p, Vec3::Zero(), 1); };
    EXPECT_NEAR(crease_depth(ball, Vec3::UnitX(), Vec3::UnitX(), 0.1), 0, 1e-12);
    const SignedDistance gap = [](const Vec3& p) { return 0.05 - std::abs(p.x()); };
    EXPECT_EQ(crease_depth(gap, Vec3(-0.05, 0, 0), Vec3::UnitX(), 0.1), 1);
    EXPECT_NEAR(crease_depth(gap, Vec3(-0.05, 0, 0), Vec3::UnitX(), 0.06), 1 - 0.04 / 0.06, 1e-12);
}

}  // namespace
}  // namespace patina
