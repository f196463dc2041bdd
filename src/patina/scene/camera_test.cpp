#include "patina/scene/camera.h"

#include "patina/base/random.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

RigidTransform tilted_pose() {
    RigidTransform pose;
    pose.rotation = (Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized())).toRotationMatrix();
    pose.translation = Vec3(0.3, -0.2, 1.5);
    return pose;
}

Camera pinhole(const std::array<double, 5>& distortion = {}) {
    Camera camera;
    camera.width = 640;
    camera.height = 480;
    camera.fx = 500;
    camera.fy = 520;
    camera.cx = 320;
    camera.cy = 240;
    camera.distortion = distortion;
    return camera;
}

TEST(Camera, CentredCameraSeesItsAxisAtTheImageCentre) {
    const auto pixel = pinhole().project(Vec3(0, 0, 2));
    ASSERT_TRUE(pixel);
    EXPECT_EQ(*pixel, Vec2(320, 240));
}

TEST(Camera, ImageRunsRightAndDown) {
    // One focal length of x makes 500 pixels; the first pixel's centre lies at (0.5, 0.5).
    const auto pixel = pinhole().project(Vec3(-319.5 / 500, -239.5 / 520, 1));
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - Vec2(0.5, 0.5)).norm(), 1e-12);
}

TEST(Camera, PinholeDoesNotSeeWhatIsBehindIt) {
    EXPECT_FALSE(pinhole().project(Vec3(0, 0, -1)));
    EXPECT_FALSE(pinhole().project(Vec3(1, 0, 0)));
}

TEST(Camera, DoesNotSeeWhereItsDistortionOverflows) {
    constexpr double kHuge = 1.5e308;
    EXPECT_FALSE(pinhole({kHuge, -kHuge, 0, 0, 0}).project(Vec3(1, 1, 1)));
}

// OpenCV's formula worked out by hand at (x, y) = (0.5, 0.25), r^2 = 0.3125.
TEST(Camera, DistortsAsOpenCvDoes) {
    const double k1 = 0.1;
    const double k2 = 0.02;
    const double p1 = 0.003;
    const double p2 = -0.004;
    const double k3 = 0.005;
    const double s = 0.3125;
    const double radial = 1 + k1 * s + k2 * s * s + k3 * s * s * s;
    const double x = 0.5 * radial + 2 * p1 * 0.125 + p2 * (s + 0.5);
    const double y = 0.25 * radial + p1 * (s + 0.125) + 2 * p2 * 0.125;
    const auto pixel = pinhole({k1, k2, p1, p2, k3}).project(Vec3(1, 0.5, 2));
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - Vec2(500 * x + 320, 520 * y + 240)).norm(), 1e-10);
}

class CameraRoundTrip : public testing::TestWithParam<Camera> {};

TEST_P(CameraRoundTrip, RaysLeadBackToTheirPixel) {
    Camera camera = GetParam();
    camera.world_from_camera = tilted_pose();
    Rng rng(1, Pass::tests, 0);
    for (int i = 0; i < 500; ++i) {
        const double u = rng.uniform() * camera.width;
        const double v = rng.uniform() * camera.height;
        const Ray ray = camera.ray(Vec2(u, v));
        EXPECT_NEAR(ray.direction.norm(), 1, 1e-12);
        const Vec3 p = ray.origin + (0.5 + rng.uniform()) * ray.direction;
        const auto pixel = camera.project(p);
        ASSERT_TRUE(pixel);
        // The undistortion stops at 1e-12 of the image plane, times a focal length of 520 pixels.
        EXPECT_LT((*pixel - Vec2(u, v)).norm(), 1e-8);
    }
}

Camera orthographic() {
    Camera camera;
    camera.model = CameraModel::orthographic;
    camera.width = 100;
    camera.height = 50;
    camera.pixel_size = 0.02;
    return camera;
}

INSTANTIATE_TEST_SUITE_P(Models,
                         CameraRoundTrip,
                         testing::Values(pinhole(),
                                         pinhole({-0.25, 0.08, 0.001, -0.002, -0.01}),
                                         pinhole({0.3, -0.1, -0.003, 0.001, 0.05}),
                                         orthographic()));

// With k1 = -1/3 alone, r_d = r - r^3/3 turns back at r = 1, where r_d = 2/3.
TEST(Camera, SeesNothingWhereTheDistortionFoldsOver) {
    const Camera camera = pinhole({-1.0 / 3, 0, 0, 0, 0});
    EXPECT_TRUE(camera.project(Vec3(0.999, 0, 1)));
    EXPECT_FALSE(camera.project(Vec3(1.001, 0, 1)));
    EXPECT_FALSE(camera.project(Vec3(0, -1.7, 1)));
}

// Slope 1 - 3 s + 2.05 s^2 (k1 = -1, k2 = 0.41): negative from s = 0.51 to 0.95, then positive
// again.
TEST(Camera, StaysBlindBeyondAFoldThatTurnsForwardAgain) {
    const Camera camera = pinhole({-1, 0.41, 0, 0, 0});
    EXPECT_TRUE(camera.project(Vec3(std::sqrt(0.5), 0, 1)));
    EXPECT_FALSE(camera.project(Vec3(std::sqrt(0.7), 0, 1)));
    EXPECT_FALSE(camera.project(Vec3(std::sqrt(2.0), 0, 1)));
}

TEST(Camera, RayOfAPixelThatDistortionNeverReachesEndsAtTheRim) {
    const Camera camera = pinhole({-1.0 / 3, 0, 0, 0, 0});
    const Ray ray = camera.ray(Vec2(320 + 500 * 0.9, 240));
    // The rim lies at tan = 1; the search closes in on it from inside.
    EXPECT_NEAR(ray.direction.x() / ray.direction.z(), 1, 1e-3);
    EXPECT_LT(ray.direction.x() / ray.direction.z(), 1);
}

TEST(Camera, OrthographicRaysAreParallelAndAPixelApart) {
    const Camera camera = orthographic();
    const Ray first = camera.ray(Vec2(0.5, 0.5));
    const Ray second = camera.ray(Vec2(1.5, 0.5));
    EXPECT_EQ(first.direction, Vec3(0, 0, 1));
    EXPECT_EQ(second.direction, Vec3(0, 0, 1));
    EXPECT_LT((second.origin - first.origin - Vec3(0.02, 0, 0)).norm(), 1e-15);
    EXPECT_LT((first.origin - Vec3(-0.99, -0.49, 0)).norm(), 1e-15);
    EXPECT_EQ(camera.direction_from(Vec3(4, 5, 6), 0), Vec3(0, 0, -1));
    EXPECT_EQ(camera.distance_from(Vec3(4, 5, 6), 0), 6);
    EXPECT_TRUE(camera.project(Vec3(0, 0, -1)));
}

TEST(Camera, DepthIsZOfItsFrame) {
    Camera camera = pinhole();
    camera.world_from_camera = tilted_pose();
    const Vec3 p = camera.world_from_camera.point(Vec3(0.1, 0.2, 3));
    EXPECT_NEAR(camera.depth_of(p), 3, 1e-12);
    EXPECT_NEAR(camera.distance_from(p, 0), Vec3(0.1, 0.2, 3).norm(), 1e-12);
}

TEST(Camera, RegisteredCameraStandsAtItsPosition) {
    Camera camera;
    camera.model = CameraModel::registered;
    camera.position = Vec3(0, 1, 2);
    EXPECT_LT((camera.direction_from(Vec3(0, 0, 2), 0.5) - Vec3::UnitY()).norm(), 1e-15);
    EXPECT_NEAR(camera.distance_from(Vec3(0, 0, 2), 0.5), 1, 1e-15);
}

TEST(Camera, ScannerCameraTurnsWithTheColumn) {
    Camera camera;
    camera.model = CameraModel::registered;
    camera.frame = FrameOfReference::scanner;
    camera.position = Vec3(0, 0, 2);
    EXPECT_LT((camera.direction_from(Vec3(1, 0, 0), kPi / 2) - Vec3::UnitX()).norm(), 1e-15);
    EXPECT_NEAR(camera.distance_from(Vec3(1, 0, 0), kPi / 2), 1, 1e-15);
}

}  // namespace
}  // namespace patina
