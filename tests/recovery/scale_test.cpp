// Lamps of unknown common strength: told from bounced light, and not told where there is none.
#include "patina/pipeline/estimate_capture.h"
#include "patina/pipeline/truth_comparison.h"

#include <gtest/gtest.h>

#include "simulated_capture.h"
#include "support/shared_data.h"

namespace patina {
namespace {

// Of the scale and of Pd: what the project claims [-].
constexpr double kTolerance = 0.03;
constexpr double kStated = 0.7;  // of the lamps' true strength [-]

Estimate estimate(const Capture& capture) {
    Progress progress;
    return estimate_reflectance(capture, EstimateOptions{}, progress);
}

void expect_scale_told(const ScaleEstimate& scale) {
    EXPECT_TRUE(scale.told) << scale.reason;
    EXPECT_NEAR(scale.factor * kStated, 1, kTolerance);
    EXPECT_LT(scale.standard_error, kLargestScaleError);
    EXPECT_GT(scale.standard_error, 0);
}

TEST(AbsoluteScale, IsToldFromTheBouncedLightOfAChannel) {
    const auto folder = shared_data("captures/channel");
    if (!folder) GTEST_SKIP() << "needs captures/channel of the shared data (PATINA_SHARED)";
    Capture capture = load_capture(*folder);
    multiply_lamps(kStated, capture.description);
    capture.description.radiometry.scale_unknown = true;
    const Estimate told = estimate(capture);
    ASSERT_TRUE(told.scale.has_value());
    expect_scale_told(*told.scale);
    const Comparison::Truth truth = compare_with_truth(
        make_result(capture, EstimateOptions{}, told).maps, load_truth(capture.description));
    EXPECT_NEAR(truth.diffuse->mean_relative_error, 0, kTolerance);
    EXPECT_LE(truth.diffuse->median_absolute_relative_error, kTolerance);
    // The scale's error is part of every texel's.
    for (std::size_t i = 0; i < told.maps.size(); ++i) {
        EXPECT_GE((told.errors[i].diffuse / told.maps[i].diffuse.max(1e-9)).minCoeff(),
                  told.scale->standard_error * (1 - 1e-12));
    }
}

// A matte groove under lamps on either side: each wall bounces the light of the other's.
TEST(AbsoluteScale, IsToldFromTheBouncedLightOfASimulatedGroove) {
    ScanOptions options;
    options.columns = 120;
    options.rows = 16;
    options.samples_per_pixel = 64;
    options.heldout_sample_factor = 1;
    const SimulatedCapture groove(ObjectKind::v45, {4, 14, 24, 34, 44, 54}, options);
    Capture capture = groove.capture();
    multiply_lamps(kStated, capture.description);
    capture.description.radiometry.scale_unknown = true;
    expect_scale_told(*estimate(capture).scale);
}

// What the convex say of themselves: nothing. Their maps are then those of the lamps as stated, to
// the last bit, errors included.
void expect_untold(Capture capture) {
    const Estimate absolute = estimate(capture);
    capture.description.radiometry.scale_unknown = true;
    const Estimate unknown = estimate(capture);
    EXPECT_FALSE(absolute.scale.has_value());
    ASSERT_TRUE(unknown.scale.has_value());
    EXPECT_FALSE(unknown.scale->told);
    EXPECT_EQ(unknown.scale->factor, 1);
    EXPECT_FALSE(unknown.scale->reason.empty());
    const auto maps = [&](const Estimate& of) {
        return make_result(capture, EstimateOptions{}, of).maps;
    };
    EXPECT_EQ(maps(absolute).diffuse.data, maps(unknown).diffuse.data);
    EXPECT_EQ(maps(absolute).specular.data, maps(unknown).specular.data);
    EXPECT_EQ(maps(absolute).diffuse_stderr.data, maps(unknown).diffuse_stderr.data);
}

TEST(AbsoluteScale, IsNotToldFromABall) {
    const auto folder = shared_data("captures/real_ball");
    if (!folder) GTEST_SKIP() << "needs captures/real_ball of the shared data (PATINA_SHARED)";
    expect_untold(load_capture(*folder));
}

TEST(AbsoluteScale, IsNotLookedForByOtherMethods) {
    ScanOptions options;
    options.columns = 16;
    options.rows = 16;
    options.samples_per_pixel = 4;
    options.heldout_sample_factor = 1;
    const SimulatedCapture plates(ObjectKind::a, {12, 25, 42, 55}, options);
    Capture capture = plates.capture();
    capture.description.radiometry.scale_unknown = true;
    EstimateOptions direct;
    direct.method = Method::direct;
    Progress progress;
    const Estimate unknown = estimate_reflectance(capture, direct, progress);
    ASSERT_TRUE(unknown.scale.has_value());
    EXPECT_FALSE(unknown.scale->told);
    EXPECT_EQ(unknown.scale->factor, 1);
}

}  // namespace
}  // namespace patina
