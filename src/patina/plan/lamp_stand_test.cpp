#include "patina/plan/lamp_stand.h"

#include "patina/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scenes.h"
#include <functional>
#include <string>
#include <vector>

namespace patina {
namespace {

// A unit square about the origin that faces +z, and a camera 4 above it.
Capture square_capture() {
    Capture capture;
    capture.mesh = rectangle(Vec3(-0.5, -0.5, 0), Vec3::UnitX(), Vec3::UnitY());
    Camera camera;
    camera.model = CameraModel::registered;
    camera.position = Vec3(0, 0, 4);
    capture.description.cameras = {camera};
    return capture;
}

TEST(StandLamps, DomeIsEvenAndFacesTheCameras) {
    LampStandOptions options;
    options.dome = 400;
    const std::vector<Light> lamps = stand_lamps(square_capture(), options);
    ASSERT_EQ(lamps.size(), 400U);
    int num_upper = 0;
    Vec3 mean = Vec3::Zero();
    for (const Light& lamp : lamps) {
        EXPECT_NEAR(lamp.position.norm(), 4, 1e-12);
        // White facing it has radiance 1: E / pi with E = I / r^2.
        EXPECT_NEAR(lamp.intensity.mean() / square(4) / kPi, 1, 1e-12);
        EXPECT_GE(lamp.position.z() / 4, std::cos(radians(80)));
        num_upper += int(lamp.position.z() / 4 > 0.5 * (1 + std::cos(radians(80))));
        mean += lamp.position / 400;
    }
    // Half of the solid angle holds half of the lamps; across the axis they balance.
    EXPECT_EQ(num_upper, 200);
    EXPECT_LT(std::hypot(mean.x(), mean.y()), 0.05);
    EXPECT_EQ(lamps[0].id, "D00");
    EXPECT_EQ(lamps[399].id, "D399");
}

TEST(StandLamps, GridStandsAcrossTheAxis) {
    LampStandOptions options;
    options.grid_across = 3;
    options.grid_along = 2;
    options.radius = 2;
    options.spacing = 0.5;
    options.center = Vec3(1, 0, 0);
    options.axis = Vec3(0, 0, 3);
    const std::vector<Light> lamps = stand_lamps(square_capture(), options);
    ASSERT_EQ(lamps.size(), 6U);
    EXPECT_LT((lamps[0].position - Vec3(0.5, 0.25, 2)).norm(), 1e-12);
    EXPECT_LT((lamps[5].position - Vec3(1.5, -0.25, 2)).norm(), 1e-12);
}

TEST(StandLamps, TurnsWithTheScannerWhenAllCamerasDo) {
    Capture capture = square_capture();
    LampStandOptions options;
    options.dome = 1;
    EXPECT_EQ(stand_lamps(capture, options)[0].frame, FrameOfReference::world);
    capture.description.cameras[0].frame = FrameOfReference::scanner;
    EXPECT_EQ(stand_lamps(capture, options)[0].frame, FrameOfReference::scanner);
}

TEST(StandLamps, RefusesToStandInsideTheObject) {
    LampStandOptions options;
    options.dome = 8;
    options.radius = 0.5;
    EXPECT_THROW((void)stand_lamps(square_capture(), options), Error);
}

TEST(LampStandOptions, NamesTheWordThatDoesNotFit) {
    const auto expect = [](const char* message,
                           const std::function<void(LampStandOptions&)>& change) {
        LampStandOptions options;
        change(options);
        try {
            validate(options);
            FAIL() << message;
        } catch (const Error& error) {
            EXPECT_STREQ(error.what(), message);
        }
    };
    expect("--grid: is given besides --dome (expected one of the two)", [](auto& o) {
        o.dome = 3;
        o.grid_across = o.grid_along = 2;
    });
    expect("--grid: is 3x0 (expected 1 or more each)", [](auto& o) { o.grid_across = 3; });
    expect("--grid: is -3x-1 (expected 1 or more each)", [](auto& o) {
        o.grid_across = -3;
        o.grid_along = -1;
    });
    expect("--radius: has nothing to place (expected --dome or --grid besides)",
           [](auto& o) { o.radius = 1; });
    expect("--center: has nothing to place (expected --dome or --grid besides)",
           [](auto& o) { o.center = Vec3::Zero(); });
    expect("--axis: has nothing to place (expected --dome or --grid besides)",
           [](auto& o) { o.axis = Vec3::UnitX(); });
    expect("--spacing: has nothing to place (expected --grid besides)", [](auto& o) {
        o.dome = 3;
        o.spacing = 1;
    });
    expect("--axis: is 0,0,0 (expected a direction)", [](auto& o) {
        o.dome = 3;
        o.axis = Vec3::Zero();
    });
}

}  // namespace
}  // namespace patina
