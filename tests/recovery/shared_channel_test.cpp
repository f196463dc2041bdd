// A capture of an independent renderer: a bright and glossy channel, two cameras, ten lamps.
#include "patina/pipeline/estimate_capture.h"
#include "patina/pipeline/truth_comparison.h"

#include <gtest/gtest.h>

#include "support/interval_coverage.h"
#include "support/shared_data.h"
#include <algorithm>

namespace patina {
namespace {

Estimate estimate(const Capture& capture, EstimateOptions& options) {
    // To save time: a twentieth of the default photons, and four turns of each loop. The maps move
    // by less than half a percent after that, and the tolerances below are three times as wide.
    options.photons.photons = 100'000;
    options.max_iterations = 4;
    options.tolerance = 0.01;
    Progress progress;
    return estimate_reflectance(capture, options, progress);
}

Comparison::Truth compare(const Capture& capture,
                          const EstimateOptions& options,
                          const Estimate& estimate) {
    return compare_with_truth(make_result(capture, options, estimate).maps,
                              load_truth(capture.description));
}

TEST(SharedChannel, PhotonsFindTheTruthThatDirectLightAloneMisses) {
    const auto folder = shared_data("captures/channel");
    if (!folder) GTEST_SKIP() << "needs captures/channel of the shared data (PATINA_SHARED)";
    const Capture capture = load_capture(*folder);

    EstimateOptions options;
    options.method = Method::direct;
    const Comparison::Truth direct = compare(capture, options, estimate(capture, options));
    EXPECT_GT(direct.diffuse->mean_relative_error, 0.20);

    options.method = Method::photon;
    const Estimate photon = estimate(capture, options);
    const Comparison::Truth truth = compare(capture, options, photon);
    EXPECT_NEAR(truth.diffuse->mean_relative_error, 0, 0.015);
    EXPECT_LE(truth.diffuse->median_absolute_relative_error, 0.03);
    EXPECT_LE(truth.specular->median_absolute_relative_error, 0.20);
    EXPECT_LE(truth.roughness->median_absolute_relative_error, 0.20);

    std::size_t num_seen = 0;
    std::size_t num_measured = 0;
    for (std::size_t i = 0; i < photon.seen.size(); ++i) {
        if (photon.seen[i] == 0) continue;
        ++num_seen;
        if (photon.status[i] != TexelStatus::filled) ++num_measured;
    }
    EXPECT_GE(double(num_measured), 0.95 * double(num_seen));
    EXPECT_LT(photon.iterations.back().change, 0.005);
}

// The same within the bars that method gather is held to, at its own defaults.
TEST(SharedChannel, GatheringFindsTheTruthCloser) {
    const auto folder = shared_data("captures/channel");
    if (!folder) GTEST_SKIP() << "needs captures/channel of the shared data (PATINA_SHARED)";
    const Capture capture = load_capture(*folder);
    EstimateOptions options;
    options.method = Method::gather;
    Progress progress;
    const Estimate gathered = estimate_reflectance(capture, options, progress);
    EXPECT_TRUE(gathered.converged);
    const Result result = make_result(capture, options, gathered);
    const TruthMaps maps = load_truth(capture.description);
    const Comparison::Truth truth = compare_with_truth(result.maps, maps);
    EXPECT_NEAR(truth.diffuse->mean_relative_error, 0, 0.005);
    EXPECT_LE(truth.diffuse->median_absolute_relative_error, 0.015);
    EXPECT_LE(truth.specular->median_absolute_relative_error, 0.06);
    EXPECT_LE(truth.roughness->median_absolute_relative_error, 0.06);
    const auto bound = compare_with_bound(capture, result.maps, maps, result.noise, progress);
    ASSERT_TRUE(bound);
    EXPECT_GE(bound->measured_share, 0.9);
    EXPECT_LE(bound->specular_ratio, 1.3);
    EXPECT_LE(bound->roughness_ratio, 1.3);
    const IntervalCoverage coverage = interval_coverage(capture, maps, gathered);
    // 62 to 74 % and 91 to 98 %, and chance: neighbours' errors are alike, so 65 000 numbers count
    // as a tenth of them at the most, and three standard deviations of the share are 2 %.
    constexpr double kChance = 0.02;
    for (const IntervalShares& shares : coverage.each()) {
        EXPECT_GE(shares.share68, 0.62 - kChance) << shares.name;
        EXPECT_LE(shares.share68, 0.74 + kChance) << shares.name;
        EXPECT_GE(shares.share95, 0.91 - kChance) << shares.name;
        EXPECT_LE(shares.share95, 0.98 + kChance) << shares.name;
    }
}

}  // namespace
}  // namespace patina
