#include "patina/scan/object_info.h"

#include "patina/scan/rig.h"
#include "patina/scan/scanner.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

// Every eleventh candidate: lamps of all rows and columns of the grid.
std::vector<Light> some_lamps(const ScanRig& rig) {
    std::vector<Light> lamps;
    for (std::size_t i = 0; i < rig.candidates.size(); i += 11) lamps.push_back(rig.candidates[i]);
    return lamps;
}

TEST(ObjectInfo, CurvatureOfABallIsItsReciprocalRadius) {
    const SignedDistance ball = [](const Vec3& p) {
        return sphere_distance(p, Vec3::Zero(), 0.02);
    };
    EXPECT_NEAR(mean_curvature(ball, Vec3(0.02, 0, 0), 1e-4), 50, 0.01);
    const SignedDistance hollow = [&](const Vec3& p) { return -ball(p); };
    EXPECT_NEAR(mean_curvature(hollow, Vec3(0, 0.02, 0), 1e-4), -50, 0.01);
}

TEST(ObjectInfo, HalfOfEachPlateShowsADirectHighlight) {
    const SimulatedObject object = make_object(ObjectKind::a, 40, 80);
    const ScanRig rig = make_rig(object, 40, 80);
    const std::vector<double> share = highlight_coverage(object, rig.cameras[0], rig.candidates);
    ASSERT_EQ(share.size(), 2u);
    EXPECT_GE(share[0], 0.5);
    EXPECT_GE(share[1], 0.5);
}

// Research on the geometry: with lamps on the camera's side alone, nothing can be seen of the lobe.
TEST(ObjectInfo, PlatesShowNoHighlightUnderALampBesideTheCamera) {
    const SimulatedObject object = make_object(ObjectKind::a, 20, 40);
    const ScanRig rig = make_rig(object, 20, 40);
    Light beside = rig.heldout;
    beside.position = rig.cameras[0].position + Vec3(0.05, 0, 0);
    for (const double share : highlight_coverage(object, rig.cameras[0], std::span(&beside, 1))) {
        EXPECT_EQ(share, 0);
    }
}

class Creases : public testing::TestWithParam<ObjectKind> {};
INSTANTIATE_TEST_SUITE_P(BAndC, Creases, testing::Values(ObjectKind::b, ObjectKind::c));

TEST_P(Creases, GetAGoodPartOfTheirLightFromTheirWalls) {
    constexpr int kSide = 96;
    const SimulatedObject object = make_object(GetParam(), kSide, kSide);
    const ScanRig rig = make_rig(object, kSide, kSide);
    const CreaseLight light = crease_light(object, rig.cameras[0], some_lamps(rig), 32, 1);
    EXPECT_GT(light.texel_share, 0.02);
    EXPECT_GE(light.indirect, 0.15 * light.direct);
}

TEST_P(Creases, LittleIsHiddenFromTheRangeFinder) {
    EXPECT_LT(hidden_area_share(make_object(GetParam(), 8, 8)), 0.15);
}

// Light that only missing surface bounces cannot be rendered from the scan. It should cost less
// than 0.2 of 255 levels, well below the smallest difference that the paper reports (0.51). In the
// mean over the image under the held-out lamp, bounced light is 1.9 levels on the cat and 1.25 on
// the pig, and a share of the surface bounces about that share of it.
TEST_P(Creases, MissingSurfaceTakesLittleLightAway) {
    const bool is_cat = GetParam() == ObjectKind::b;
    const double bounced_levels = is_cat ? 1.9 : 1.25;
    ScanOptions options;
    options.columns = 256;
    options.rows = 128;
    const SimulatedObject object = make_object(GetParam(), options.columns, options.rows);
    const Mesh scanned = scan_geometry(object, options).mesh;
    EXPECT_LT(bounced_levels * missing_area_share(object, scanned, 0.001), 0.2);
}

TEST(ObjectInfo, OnlyWhatWasLeftOutOfTheScanIsMissing) {
    const SimulatedObject object = make_object(ObjectKind::b, 8, 8);
    EXPECT_EQ(missing_area_share(object, object.mesh, 0.001), 0);
    Mesh upper = object.mesh;
    double upper_area = 0;
    double lower_area = 0;
    upper.triangles.clear();
    for (std::uint32_t i = 0; i < object.mesh.triangles.size(); ++i) {
        const SurfacePoint point = surface_point(object.mesh, i, Vec2f::Constant(1 / 3.0f));
        const bool is_upper = point.position.y() > 0.1;
        if (is_upper) upper.triangles.push_back(object.mesh.triangles[i]);
        // The underside, cut flat on the ground with a rounded rim of 2 mm, does not count.
        const bool is_underside = point.geometric_normal.y() < -0.9 && point.position.y() < 0.002;
        if (!is_underside) {
            (is_upper ? upper_area : lower_area) += triangle_area(object.mesh, i);
        }
    }
    EXPECT_NEAR(
        missing_area_share(object, upper, 0.001), lower_area / (upper_area + lower_area), 1e-9);
}

}  // namespace
}  // namespace patina
