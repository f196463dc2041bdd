#include "patina/scene/light.h"

#include "patina/base/random.h"
#include "patina/math/warp.h"
#include "patina/scene/light_lanes.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

Light point_light(const Vec3& position) {
    Light light;
    light.position = position;
    light.intensity = Rgb(1, 2, 4);
    return light;
}

TEST(Light, PointLightFallsOffWithTheSquareOfTheDistance) {
    const LightSample sample = sample_light(point_light(Vec3(0, 0, 3)), Vec3(0, 0, 1), 0);
    EXPECT_EQ(sample.w_i, Vec3(0, 0, 1));
    EXPECT_EQ(sample.distance, 2);
    EXPECT_TRUE(sample.irradiance.isApprox(Rgb(0.25, 0.5, 1)));
}

TEST(Light, FalloffIsAPowerOfTheCosineAboutItsDirection) {
    Light light = point_light(Vec3::Zero());
    light.direction = Vec3(0, 0, 1);
    light.falloff = 3;
    // 60 degrees off the axis, at distance 1.
    const Vec3 p(std::sqrt(0.75), 0, 0.5);
    EXPECT_TRUE(sample_light(light, p, 0).irradiance.isApprox(Rgb(1, 2, 4) * 0.125, 1e-12));
}

TEST(Light, DirectedLightDoesNotShineBehindItself) {
    Light light = point_light(Vec3::Zero());
    light.direction = Vec3(0, 0, 1);
    for (const double mu : {0.0, 1.0, 2.0}) {
        light.falloff = mu;
        EXPECT_TRUE((sample_light(light, Vec3(0, 0, -1), 0).irradiance == 0).all()) << mu;
    }
}

TEST(Light, DirectionalLightIsTheSameEverywhere) {
    Light light;
    light.type = LightType::directional;
    light.direction = Vec3(0, 1, 0);
    light.irradiance = Rgb(3, 2, 1);
    const LightSample sample = sample_light(light, Vec3(7, 8, 9), 0.4);
    EXPECT_EQ(sample.w_i, Vec3(0, 1, 0));
    EXPECT_EQ(sample.distance, std::numeric_limits<double>::infinity());
    EXPECT_TRUE((sample.irradiance == Rgb(3, 2, 1)).all());
}

TEST(Light, ScannerFrameTurnsPositionAndDirection) {
    Light light = point_light(Vec3(0, 0, 2));
    light.direction = Vec3(0, 0, -1);
    light.falloff = 1;
    light.frame = FrameOfReference::scanner;
    const LightSample sample = sample_light(light, Vec3(1, 0, 0), kPi / 2);
    EXPECT_LT((sample.w_i - Vec3::UnitX()).norm(), 1e-15);
    EXPECT_NEAR(sample.distance, 1, 1e-15);
    EXPECT_TRUE(sample.irradiance.isApprox(Rgb(1, 2, 4), 1e-12));
}

TEST(Light, ScannerFrameTurnsDirectionalLights) {
    Light light;
    light.type = LightType::directional;
    light.direction = Vec3(0, 0, 1);
    light.frame = FrameOfReference::scanner;
    const LightSample sample = sample_light(light, Vec3(5, 0, 0), -kPi / 2);
    EXPECT_LT((sample.w_i + Vec3::UnitX()).norm(), 1e-15);
}

TEST(Light, GivesNothingAtTheLampItself) {
    const LightSample sample = sample_light(point_light(Vec3(1, 1, 1)), Vec3(1, 1, 1), 0);
    EXPECT_TRUE((sample.irradiance == 0).all());
    EXPECT_TRUE(sample.w_i.allFinite());
}

// --- In lanes ------------------------------------------------------------------------------------

Light random_light(Rng& rng) {
    Light light = point_light(square_to_sphere({rng.uniform(), rng.uniform()}) * 5);
    const Vec3 axis = square_to_sphere({rng.uniform(), rng.uniform()});
    if (rng.uniform() < 0.3) light.type = LightType::directional;
    if (light.type == LightType::directional || rng.uniform() < 0.7) light.direction = axis;
    if (rng.uniform() < 0.8) light.falloff = 3 * rng.uniform();
    if (rng.uniform() < 0.5) light.frame = FrameOfReference::scanner;
    light.irradiance = Rgb(3, 2, 1);
    return light;
}

// Of the direction away from the lamp to the one in which it shines; 1 where it has none.
double cosine_off_axis(const Light& light, const Vec3& w_i, double azimuth) {
    if (!light.direction) return 1;
    const bool turns = light.frame == FrameOfReference::scanner;
    return -(turns ? rotate_about_y(azimuth, *light.direction) : *light.direction).dot(w_i);
}

TEST(LaneLight, IsTheLightInSinglePrecision) {
    // Coordinates up to 5 in floats and a sine to 3e-7, over distances of 4 and more.
    constexpr double kError = 2e-6;
    Rng rng(7, Pass::tests, 0);
    int num_dark = 0;
    constexpr int kCount = 2000;
    for (int i = 0; i < kCount; ++i) {
        const Light light = random_light(rng);
        const Vec3 p = square_to_sphere({rng.uniform(), rng.uniform()}) * rng.uniform();
        const double turn = rng.uniform();
        const LightSample expected = sample_light(light, p, 2 * kPi * turn);
        const LaneLightSample lane = sample_lane_light(
            lane_light(light), float(p.x()), float(p.y()), float(p.z()), float(turn));
        EXPECT_LT((Vec3f(lane.x, lane.y, lane.z).cast<double>() - expected.w_i).norm(), kError);
        const bool is_point = light.type == LightType::point;
        if (is_point) {
            EXPECT_NEAR(double(lane.distance) / expected.distance, 1, kError);
        } else {
            EXPECT_EQ(double(lane.distance), expected.distance);
        }
        const Rgb& emitted = is_point ? light.intensity : light.irradiance;
        // On which side of the lamp's plane a point lies is not decided within the cosine's error.
        const double off_axis = cosine_off_axis(light, expected.w_i, 2 * kPi * turn);
        if (is_point && std::abs(off_axis) < kError) continue;
        const double strength = expected.irradiance.x() / emitted.x();
        const double power_error = is_point ? kError * light.falloff / std::abs(off_axis) : 0.0;
        EXPECT_NEAR(double(lane.strength), strength, kError + strength * power_error);
        num_dark += strength == 0 ? 1 : 0;
    }
    EXPECT_GT(num_dark, kCount / 10);
}

TEST(LaneLight, HasNoDirectionAtTheLampItself) {
    const LaneLight light = lane_light(point_light(Vec3(1, 2, 3)));
    const LaneLightSample sample = sample_lane_light(light, 1, 2, 3, 0);
    EXPECT_EQ(Vec3f(sample.x, sample.y, sample.z).norm(), 0);
}

}  // namespace
}  // namespace patina
