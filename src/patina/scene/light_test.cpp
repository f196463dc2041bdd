#include "patina/scene/light.h"

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

}  // namespace
}  // namespace patina
