#include "patina/raytrace/tracer.h"

#include "patina/base/random.h"
#include "patina/math/warp.h"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <vector>

namespace patina {
namespace {

// A heap of random triangles in the unit cube.
Mesh random_triangles(int count) {
    Mesh mesh;
    Rng rng(1, Pass::tests, 0);
    const auto random_point = [&rng] {
        const double x = rng.uniform();
        const double y = rng.uniform();
        return Vec3(x, y, rng.uniform());
    };
    for (int i = 0; i < count; ++i) {
        const Vec3 center = random_point();
        for (int corner = 0; corner < 3; ++corner) {
            const Vec3 p = center + 0.3 * (random_point() - Vec3::Constant(0.5));
            mesh.positions.push_back(p.cast<float>());
        }
        const auto first = static_cast<std::uint32_t>(3 * i);
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

class TracerBackends : public testing::TestWithParam<TracerBackend> {};

TEST_P(TracerBackends, AnswerManyRaysAsTheyAnswerOne) {
    constexpr std::size_t kRays = 2003;  // no multiple of a packet
    constexpr std::size_t kNotSent = 5;  // every fifth is not sent
    const Tracer tracer(random_triangles(100), GetParam());
    Rng rng(3, Pass::tests, 0);
    std::array<std::vector<float>, 3> origin;
    std::array<std::vector<float>, 3> direction;
    std::vector<float> max_distance;
    std::vector<std::int32_t> active;
    for (std::size_t i = 0; i < kRays; ++i) {
        const Vec3 w = square_to_sphere({rng.uniform(), rng.uniform()});
        for (std::size_t k = 0; k < 3; ++k) {
            origin[k].push_back(float(rng.uniform()));
            direction[k].push_back(float(w[Eigen::Index(k)]));
        }
        max_distance.push_back(float(rng.uniform()));
        active.push_back(i % kNotSent == 0 ? 0 : -1);
    }
    const RayLanes rays = {
        {origin[0], origin[1], origin[2]}, {direction[0], direction[1], direction[2]}, active};
    std::vector<std::uint32_t> triangle(kRays);
    std::vector<float> u(kRays);
    std::vector<float> v(kRays);
    std::vector<std::int32_t> lit(kRays);
    tracer.intersect_lanes(rays, {triangle, u, v});
    tracer.lit_lanes(rays, max_distance, lit);
    std::size_t num_hits = 0;
    for (std::size_t i = 0; i < kRays; ++i) {
        const Vec3 p = Vec3f(origin[0][i], origin[1][i], origin[2][i]).cast<double>();
        const Vec3 w = Vec3f(direction[0][i], direction[1][i], direction[2][i]).cast<double>();
        const auto expected = active[i] != 0 ? tracer.intersect(p, w) : std::nullopt;
        ASSERT_EQ(triangle[i], expected ? expected->triangle : kNoTriangle);
        ASSERT_EQ(lit[i] != 0, active[i] != 0 && !tracer.occluded(p, w, double(max_distance[i])));
        if (!expected) continue;
        ++num_hits;
        EXPECT_EQ(Vec2f(u[i], v[i]), expected->barycentric);
    }
    EXPECT_GT(num_hits, kRays / 10);
    EXPECT_LT(num_hits, kRays);
}

INSTANTIATE_TEST_SUITE_P(Both,
                         TracerBackends,
                         testing::Values(TracerBackend::embree, TracerBackend::brute_force));

TEST(Tracer, AgreesWithBruteForce) {
    const Mesh mesh = random_triangles(300);
    const Tracer fast(mesh, TracerBackend::embree);
    const Tracer twin(mesh, TracerBackend::brute_force);
    Rng rng(2, Pass::tests, 0);
    int num_hits = 0;
    int num_grazing = 0;
    constexpr int kRays = 20000;
    for (int i = 0; i < kRays; ++i) {
        const Vec3 origin(rng.uniform(), rng.uniform(), rng.uniform());
        const Vec3 direction = square_to_sphere({rng.uniform(), rng.uniform()});
        const auto hit = fast.intersect(origin, direction);
        const auto expected = twin.intersect(origin, direction);
        // A ray within rounding of an edge may be decided either way: counted, and bounded below.
        if (hit.has_value() != expected.has_value() ||
            (hit && hit->triangle != expected->triangle)) {
            ++num_grazing;
            continue;
        }
        if (!hit) continue;
        ++num_hits;
        EXPECT_NEAR(hit->distance, expected->distance, 1e-4);
        EXPECT_NEAR((hit->barycentric - expected->barycentric).norm(), 0, 2e-3);
        // Clear of the hit by a part in a thousand, so that single precision cannot matter.
        EXPECT_TRUE(fast.occluded(origin, direction, 1.001 * expected->distance));
        EXPECT_FALSE(fast.occluded(origin, direction, 0.999 * expected->distance));
    }
    EXPECT_GT(num_hits, kRays / 10);
    // Edges are 2^-23 wide against triangles of size 0.1: a part in 1e5 of the rays at most.
    EXPECT_LE(num_grazing, 2);
}

TEST(Tracer, OffsetPointDoesNotHitItsOwnSurface) {
    const Mesh mesh = random_triangles(100);
    const Tracer tracer(mesh);
    Rng rng(3, Pass::tests, 0);
    for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
        const SurfacePoint point = surface_point(mesh, triangle, Vec2f(0.3f, 0.3f));
        const Frame frame(point.geometric_normal);
        const Vec3 w = frame.to_world(square_to_cosine_hemisphere({rng.uniform(), rng.uniform()}));
        const auto hit = tracer.intersect(tracer.offset(point, w), w);
        EXPECT_TRUE(!hit || hit->triangle != triangle);
    }
}

TEST(Tracer, EmptyMeshIsNeverHit) {
    const Tracer tracer{Mesh{}};
    EXPECT_FALSE(tracer.intersect(Vec3::Zero(), Vec3::UnitX()));
    EXPECT_FALSE(tracer.occluded(Vec3::Zero(), Vec3::UnitX()));
}

}  // namespace
}  // namespace patina
