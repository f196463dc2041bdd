#include "patina/transport/path_tracer.h"

#include <gtest/gtest.h>

#include "support/lit_scene.h"
#include "support/scenes.h"
#include <algorithm>
#include <array>
#include <vector>

namespace patina {
namespace {

// One sample of the indirect irradiance, grey.
double indirect(const LitScene& scene,
                const SurfacePoint& point,
                SobolSampler& sampler,
                const PathTracerOptions& options = {}) {
    return trace_indirect_irradiance(
        scene.surface(), scene.field(), scene.lights, 0, point, options, sampler)[0];
}

TEST(PathTracer, OneReflectionBetweenPerpendicularSquaresIsTheirFormFactor) {
    // The light runs along the square x = 0, so it shines on z = 0 alone, which sends it on with
    // the radiosity albedo x irradiance.
    constexpr double kFormFactor = 0.2000437761;  // closed form for squares with a common edge
    constexpr double kAlbedo = 0.8;
    constexpr double kIrradiance = 2;
    const LitScene scene(perpendicular_unit_squares(),
                         lambertian(kAlbedo),
                         {directional_light(Vec3::UnitZ(), kIrradiance)});
    PathTracerOptions options;
    options.max_bounces = 1;
    const Mesh receiver = rectangle(Vec3::Zero(), Vec3::UnitY(), Vec3::UnitZ());
    const AreaSampler points(receiver);
    const SampleMean mean = randomised_mean(512, 256, 1, [&](SobolSampler& sampler) {
        const double choice = sampler.next_pair()[0];
        SurfacePoint point = points.sample(choice, sampler.next_pair());
        return indirect(scene, point, sampler, options);
    });
    EXPECT_TRUE(agrees(mean, kAlbedo * kIrradiance * kFormFactor));
}

// A wedge of two plates with the opening angle `angle` about the y axis, lit along its bisector;
// all in units of the distance from the edge at which it is looked at.
struct Wedge {
    static constexpr double kLength = 1000;
    static constexpr double kHalfWidth = 3000;

    [[nodiscard]] Mesh mesh() const {
        const Vec3 edge(0, 2 * kHalfWidth, 0);
        const Vec3 corner = -0.5 * edge;
        const Vec3 first(kLength, 0, 0);
        const Vec3 second(kLength * std::cos(angle), 0, kLength * std::sin(angle));
        Mesh plates = rectangle(corner, first, edge);
        append(plates, rectangle(corner, edge, second));
        return plates;
    }
    [[nodiscard]] Vec3 to_light() const {
        return {std::cos(0.5 * angle), 0, std::sin(0.5 * angle)};
    }

    // Share of the irradiance at distance 1 that two endless plates have and these lack, at most.
    // The lack d(x), relative to H, obeys d(x) <= albedo (missing(x) + int K(x, t) d(t) dt), where
    // K is the form factor from x to the line t of the other plate, infinitely wide, and missing(x)
    // the form factor to what lies beyond its length (crossed strings) and beyond its width (a
    // plane at the height h seen from beyond the distance D fills at most 2 h / D of the
    // cosine-weighted hemisphere).
    [[nodiscard]] double truncation(double albedo) const {
        constexpr int kNumLines = 240;
        constexpr double kNearest = 1e-5 * kLength;  // nearer lines receive d(kNearest) at most
        const double log_step = std::log(kLength / kNearest) / (kNumLines - 1);
        std::vector<double> x(kNumLines);
        for (int i = 0; i < kNumLines; ++i) x[std::size_t(i)] = kNearest * std::exp(i * log_step);
        std::vector<double> lack(kNumLines, 0.0);
        for (int iteration = 0; iteration < 60; ++iteration) {
            std::vector<double> next(kNumLines);
            for (std::size_t i = 0; i < x.size(); ++i) {
                double sum = missing(x[i]);
                for (std::size_t j = 0; j < x.size(); ++j) {
                    sum += form_factor_density(x[i], x[j]) * x[j] * log_step * lack[j];
                }
                next[i] = albedo * sum;
            }
            lack = next;
        }
        const auto at_one = std::upper_bound(x.begin(), x.end(), 1.0) - x.begin();
        return lack[std::size_t(at_one)];
    }

    [[nodiscard]] double missing(double x) const {
        const double cosine = std::cos(angle);
        const double toward_end =
            (kLength * cosine - x) / std::sqrt(square(kLength) + x * x - 2 * kLength * x * cosine);
        const double beyond_length = 0.5 * (cosine - toward_end);
        const double beyond_width = 2 * x * std::sin(angle) / kHalfWidth;
        return std::min(0.5 * (1 + cosine), beyond_length + beyond_width);
    }
    [[nodiscard]] double form_factor_density(double x, double t) const {
        const double distance_squared = x * x + t * t - 2 * x * t * std::cos(angle);
        return 0.5 * x * t * square(std::sin(angle)) / std::pow(distance_squared, 1.5);
    }

    double angle = 0;  // [rad]
};

class WedgeOfAngle : public testing::TestWithParam<double> {};

TEST_P(WedgeOfAngle, InterreflectsByTheClosedForm) {
    constexpr double kAlbedo = 0.6;
    constexpr double kIrradiance = 2;
    const Wedge wedge{radians(GetParam())};
    const LitScene scene(
        wedge.mesh(),
        lambertian(kAlbedo),
        {directional_light(wedge.to_light(), kIrradiance / std::sin(0.5 * wedge.angle))});
    SurfacePoint point;
    point.position = Vec3::UnitX();
    const Rgb direct = direct_irradiance(scene.surface(), scene.lights, 0, point);
    ASSERT_NEAR(direct[0], kIrradiance, 1e-12);

    const double loop = kAlbedo * 0.5 * (1 + std::cos(wedge.angle));
    const double total = kIrradiance / (1 - loop);
    const double truncation = wedge.truncation(kAlbedo);
    ASSERT_LT(truncation, 0.01) << "the plates are too short for this test to mean much";
    const SampleMean mean = randomised_mean(
        256, 256, 2, [&](SobolSampler& sampler) { return indirect(scene, point, sampler); });
    EXPECT_TRUE(agrees(mean, total - kIrradiance, truncation * total));
}

INSTANTIATE_TEST_SUITE_P(Degrees, WedgeOfAngle, testing::Values(60.0, 90.0, 120.0));

class SphereLitFromInside : public testing::TestWithParam<double> {};

TEST_P(SphereLitFromInside, HasAUniformIndirectIrradiance) {
    constexpr int kColumns = 128;
    constexpr double kAlbedo = 0.6;
    constexpr double kIntensity = 1.5;
    const LitScene scene(sphere(1, kColumns, kColumns / 2, SphereSide::inward),
                         lambertian(kAlbedo),
                         {point_light(Vec3(0, 0, GetParam()), kIntensity)});
    // Facets lie inside the sphere by up to 1 - cos(s / 2) of the radius, s = 2 pi sqrt(2) /
    // columns the angle across one; area, squared distance and cosine change by twice that each,
    // relatively.
    const double sagitta = 1 - std::cos(kPi * std::sqrt(2.0) / kColumns);
    const double mean_direct = kIntensity;  // 4 pi I over the area 4 pi, wherever the lamp is
    const double expected = kAlbedo * mean_direct / (1 - kAlbedo);
    for (const std::uint32_t triangle : {100U, 6000U, 12000U}) {
        const SurfacePoint point = surface_point(scene.mesh, triangle, Vec2f(0.25F, 0.25F));
        const SampleMean mean = randomised_mean(128, 128, triangle, [&](SobolSampler& sampler) {
            return indirect(scene, point, sampler);
        });
        EXPECT_TRUE(agrees(mean, expected, 6 * sagitta * expected)) << "triangle " << triangle;
    }
}

INSTANTIATE_TEST_SUITE_P(LampAt, SphereLitFromInside, testing::Values(0.0, 0.5));

TEST(PathTracer, AClosedSceneKeepsItsFlux) {
    // Each reflection keeps the share a, so all that ever arrives is Phi (1 + a + a^2 + ...).
    constexpr double kAlbedo = 0.7;
    constexpr double kIntensity = 2;
    const LitScene scene(inward_box(Vec3(1, 2, 1.5)),
                         lambertian(kAlbedo),
                         {point_light(Vec3(0.4, 0.7, 1), kIntensity)});
    const AreaSampler points(scene.mesh);
    const SampleMean mean = randomised_mean(256, 256, 4, [&](SobolSampler& sampler) {
        const double choice = sampler.next_pair()[0];
        const SurfacePoint point = points.sample(choice, sampler.next_pair());
        return points.area() * (direct_irradiance(scene.surface(), scene.lights, 0, point)[0] +
                                indirect(scene, point, sampler));
    });
    EXPECT_TRUE(agrees(mean, 4 * kPi * kIntensity / (1 - kAlbedo)));
}

struct FurnaceCase {
    Reflectance material;
    double angle_degrees;
};

class WhiteFurnace : public testing::TestWithParam<FurnaceCase> {};

TEST_P(WhiteFurnace, ReflectsTheDirectionalAlbedo) {
    const Reflectance& material = GetParam().material;
    const double cosine = std::cos(radians(GetParam().angle_degrees));
    const LitScene scene(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), material, {});
    const SurfacePoint point = surface_point(scene.mesh, 0, Vec2f(0.25F, 0.25F));
    const Vec3 w_o(std::sqrt(1 - square(cosine)), 0, cosine);
    PathTracerOptions options;
    options.sky_radiance = Rgb::Ones();
    const SampleMean mean = randomised_mean(256, 64, 5, [&](SobolSampler& sampler) {
        const OutgoingRadiance radiance = trace_path(
            scene.surface(), scene.field(), scene.lights, 0, point, w_o, options, sampler);
        return radiance.direct[0] + radiance.indirect[0];
    });
    const double albedo =
        material.diffuse[0] + material.specular * lobe_albedo(cosine, material.roughness);
    const double table_error =
        3e-5 * material.specular * 2 * square(material.roughness) / std::max(cosine, kCosineFloor);
    // Sums of this many numbers round by 1e-12 at most: a Lambertian surface has no other spread.
    EXPECT_TRUE(agrees(mean, albedo, table_error + 1e-12));
}

INSTANTIATE_TEST_SUITE_P(Materials,
                         WhiteFurnace,
                         testing::Values(FurnaceCase{lambertian(0.8), 40},
                                         FurnaceCase{{Rgb::Zero(), 3, 0.05}, 20},
                                         FurnaceCase{{Rgb::Constant(0.3), 1, 0.1}, 60},
                                         FurnaceCase{{Rgb::Constant(0.5), 0.5, 0.3}, 0},
                                         FurnaceCase{{Rgb::Constant(0.2), 0.3, 0.4}, 85}));

TEST(PathTracer, TheSkyReachesAPointAsPiTimesItsRadiance) {
    const LitScene scene(
        rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), lambertian(0.5), {});
    PathTracerOptions options;
    options.max_bounces = 0;
    options.sky_radiance = Rgb(1, 2, 3);
    SobolSampler sampler(6, Pass::tests, 0, 0);
    const Rgb irradiance =
        trace_indirect_irradiance(scene.surface(),
                                  scene.field(),
                                  scene.lights,
                                  0,
                                  surface_point(scene.mesh, 0, Vec2f(0.25F, 0.25F)),
                                  options,
                                  sampler);
    EXPECT_LE((irradiance - kPi * options.sky_radiance).abs().maxCoeff(), 1e-14);
}

TEST(PathTracer, GlossyAndMatteTransportAreReciprocal) {
    // Swapping lamp and eye, both of them far away, leaves the light that one surface sends to the
    // other unchanged: the mean over the scene of radiance towards the eye times its cosine.
    Mesh mesh = perpendicular_unit_squares();
    const Reflectance material{Rgb::Constant(0.4), 0.6, 0.25};
    const Vec3 a = Vec3(0.3, 0.2, 0.9).normalized();
    const Vec3 b = Vec3(0.8, -0.3, 0.4).normalized();
    const LitScene lit_from_a(mesh, material, {directional_light(a, 1)});
    const LitScene lit_from_b(mesh, material, {directional_light(b, 1)});
    const AreaSampler points(mesh);
    // The flux per solid angle towards w, of light reflected at least twice.
    const auto flux_towards = [&](const LitScene& scene, const Vec3& w, std::uint64_t seed) {
        return randomised_mean(256, 128, seed, [&](SobolSampler& sampler) {
            const double choice = sampler.next_pair()[0];
            const SurfacePoint point = points.sample(choice, sampler.next_pair());
            const double cosine = point.normal.dot(w);
            const bool seen =
                cosine > 0 && !scene.tracer.occluded(scene.tracer.offset(point, w), w);
            if (!seen) return 0.0;
            return cosine *
                   trace_path(
                       scene.surface(), scene.field(), scene.lights, 0, point, w, {}, sampler)
                       .indirect[0];
        });
    };
    const SampleMean forth = flux_towards(lit_from_a, b, 7);
    const SampleMean back = flux_towards(lit_from_b, a, 8);
    const SampleMean difference{
        forth.mean - back.mean, std::hypot(forth.standard_error, back.standard_error), forth.count};
    EXPECT_TRUE(agrees(difference, 0));
    EXPECT_GT(forth.mean, 20 * difference.standard_error) << "the test would see nothing";
}

TEST(PathTracer, BacksAreBlackAndStopLight) {
    // The right square shows its back to the left one, so nothing comes from it, neither light nor
    // sky.
    Mesh mesh = rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    append(mesh, rectangle(Vec3(-50, -50, 0.5), Vec3(101, 0, 0), Vec3(0, 101, 0)));
    const LitScene scene(mesh, lambertian(0.9), {point_light(Vec3(0.5, 0.5, 0.25), 1)});
    const SurfacePoint point = surface_point(scene.mesh, 0, Vec2f(0.25F, 0.25F));
    for (std::uint32_t i = 0; i < 256; ++i) {
        SobolSampler sampler(9, Pass::tests, 0, i);
        EXPECT_EQ(indirect(scene, point, sampler), 0);
    }
    SobolSampler sampler(9, Pass::tests, 1, 0);
    const OutgoingRadiance behind = trace_path(
        scene.surface(), scene.field(), scene.lights, 0, point, -Vec3::UnitZ(), {}, sampler);
    EXPECT_TRUE((behind.direct == 0).all() && (behind.indirect == 0).all());
}

TEST(PathTracer, CountsReflectionsElsewhere) {
    // In a closed scene of albedo a the n-th reflection brings a^n of the lamp's flux.
    constexpr double kAlbedo = 0.5;
    constexpr double kIntensity = 1;
    const LitScene scene(inward_box(Vec3::Ones()),
                         lambertian(kAlbedo),
                         {point_light(Vec3::Constant(0.5), kIntensity)});
    const AreaSampler points(scene.mesh);
    double expected = 0;
    for (int max_bounces = 0; max_bounces <= 4; ++max_bounces) {
        PathTracerOptions options;
        options.max_bounces = max_bounces;
        options.roulette_from = 2;
        const SampleMean mean = randomised_mean(128, 64, 10, [&](SobolSampler& sampler) {
            const double choice = sampler.next_pair()[0];
            const SurfacePoint point = points.sample(choice, sampler.next_pair());
            return points.area() * indirect(scene, point, sampler, options);
        });
        EXPECT_TRUE(agrees(mean, expected)) << max_bounces;
        expected += 4 * kPi * kIntensity * std::pow(kAlbedo, max_bounces + 1);
    }
}

}  // namespace
}  // namespace patina
