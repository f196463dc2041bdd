#include "patina/transport/path_budget.h"

#include "patina/base/parallel.h"
#include "patina/base/random.h"

#include <gtest/gtest.h>

#include "support/false_alarms.h"
#include <algorithm>
#include <numeric>

namespace patina {
namespace {

constexpr ShareLimits kLimits = {112, 32, 2048, 8};

std::int64_t sum_of(const std::vector<int>& paths) {
    return std::accumulate(paths.begin(), paths.end(), std::int64_t(0));
}

TEST(SharePaths, SpendsTheBudgetInUnitsWithinTheLimits) {
    Rng rng(1, Pass::tests, 0);
    std::vector<double> deviation(1001);
    for (double& value : deviation) value = std::exp(3 * rng.normal());
    const std::vector<int> paths = share_paths(deviation, kLimits);
    const std::int64_t budget = std::int64_t(deviation.size()) * kLimits.mean;
    EXPECT_LE(sum_of(paths), budget);
    EXPECT_GT(sum_of(paths), budget - kLimits.unit);
    for (const int count : paths) {
        EXPECT_GE(count, kLimits.smallest);
        EXPECT_LE(count, kLimits.largest);
        EXPECT_EQ(count % kLimits.unit, 0);
    }
    EXPECT_EQ(*std::min_element(paths.begin(), paths.end()), kLimits.smallest);
    EXPECT_EQ(*std::max_element(paths.begin(), paths.end()), kLimits.largest);
}

TEST(SharePaths, FollowsTheDeviationBetweenTheLimits) {
    const std::vector<int> paths = share_paths(std::vector<double>{1, 2, 3, 4, 5}, {96, 8, 512, 8});
    EXPECT_EQ(paths, (std::vector<int>{32, 64, 96, 128, 160}));
}

TEST(SharePaths, TreatsAllAlikeWhereNothingTellsThemApart) {
    EXPECT_EQ(share_paths(std::vector<double>(9, 0.0), kLimits), std::vector<int>(9, kLimits.mean));
    EXPECT_EQ(share_paths(std::vector<double>(9, 3.0), kLimits), std::vector<int>(9, kLimits.mean));
}

// One pixel cannot hold the budget of the other ones, which seem free of noise.
TEST(SharePaths, SpendsWhatTheLargestNumberLeavesOnTheOthers) {
    std::vector<double> deviation(100, 0.0);
    deviation[7] = 1;
    const std::vector<int> paths = share_paths(deviation, kLimits);
    EXPECT_EQ(paths[7], kLimits.largest);
    EXPECT_GT(sum_of(paths), 100 * kLimits.mean - kLimits.unit);
}

// An image of the radiance 1: a path brings 1 / p with the probability p, else 0. Rare bright ones
// are in one corner. The last column shows no surface.
constexpr int kWidth = 33;
constexpr int kHeight = 32;
constexpr int kCorner = 10;
constexpr int kMeanPaths = 256;

bool is_shown(std::size_t pixel) { return pixel % kWidth != kWidth - 1; }
bool is_noisy(std::size_t pixel) { return pixel % kWidth < kCorner && pixel / kWidth < kCorner; }
double probability(std::size_t pixel) { return is_noisy(pixel) ? 0.02 : 0.5; }
double path_variance(std::size_t pixel) { return 1 / probability(pixel) - 1; }

PathSum trace(std::uint64_t seed, std::size_t pixel, std::uint32_t stream, int num_paths) {
    PathSum sum;
    if (!is_shown(pixel)) return sum;
    sum.num_seen = num_paths;
    Rng rng(seed, Pass::tests, pixel * kNumPathStreams + stream);
    for (int i = 0; i < num_paths; ++i) {
        if (rng.uniform() < probability(pixel)) sum.radiance += 1 / probability(pixel);
    }
    return sum;
}

std::vector<int> plan_of(std::uint64_t seed) {
    Progress quiet;
    return plan_paths(
        kWidth,
        kHeight,
        kMeanPaths,
        [seed](std::size_t pixel, std::uint32_t stream, int num_paths) {
            return trace(seed, pixel, stream, num_paths);
        },
        quiet);
}

TEST(PlanPaths, KeepsTheMeanOverPixelsThatShowTheSurface) {
    const std::vector<int> plan = plan_of(1);
    std::int64_t paths = 0;
    for (std::size_t i = 0; i < plan.size(); ++i) {
        if (is_shown(i)) paths += plan[i];
    }
    // One in eight belongs to the pilot.
    const std::int64_t budget = kHeight * (kWidth - 1) * (kMeanPaths - kMeanPaths / 8);
    EXPECT_LE(paths, budget);
    EXPECT_GT(paths, budget - kMeanPaths / 16);
    EXPECT_EQ(plan[kWidth - 1], *std::min_element(plan.begin(), plan.end()));
}

TEST(PlanPaths, DoesNotDependOnTheThreads) {
    const auto plan_with = [](int threads) {
        const ThreadLimit limit(threads);
        return plan_of(2);
    };
    EXPECT_EQ(plan_with(1), plan_with(2));
}

TEST(PlanPaths, LeavesTheMeanAsItIsAndLowersTheNoise) {
    constexpr std::size_t kNumImages = 150;
    std::vector<double> corner(kNumImages);  // mean over the noisy pixels of each image
    std::vector<double> gain(kNumImages);    // of squared error, over kMeanPaths everywhere
    std::vector<double> excess(kNumImages);  // of the stated variance over the squared error
    parallel_for(
        kNumImages,
        [&](std::size_t image) {
            const std::uint64_t seed = image + 1;
            const std::vector<int> plan = plan_of(seed);
            for (std::size_t i = 0; i < plan.size(); ++i) {
                if (!is_shown(i)) continue;
                const PathSum first = trace(seed, i, 0, plan[i] / 2);
                const PathSum second = trace(seed, i, 1, plan[i] / 2);
                const double value = (first.radiance + second.radiance)[0] / plan[i];
                gain[image] += path_variance(i) / kMeanPaths - square(value - 1);
                excess[image] += noise_variance(first, second)[0] - square(value - 1);
                if (is_noisy(i)) corner[image] += value / square(kCorner);
            }
        },
        1);
    EXPECT_TRUE(agrees(estimate_of(corner), 1));
    EXPECT_TRUE(agrees(estimate_of(excess), 0));
    const SampleMean gained = estimate_of(gain);
    EXPECT_GT(gained.mean, gained.standard_error * student_threshold(double(kNumImages - 1)));
}

// Their difference has the variance of one path over the paths of each half.
TEST(NoiseVariance, IsThatOfTheMeanOfBothHalves) {
    constexpr std::size_t kNumPixels = 20000;
    std::vector<double> stated(kNumPixels);
    for (std::size_t i = 0; i < kNumPixels; ++i) {
        Rng rng(5, Pass::tests, i);
        const auto half = [&rng](int num_seen) {
            PathSum sum;
            sum.num_seen = num_seen;
            for (int path = 0; path < num_seen; ++path) sum.radiance += 3 * rng.normal();
            return sum;
        };
        const PathSum first = half(4);
        stated[i] = noise_variance(first, half(8))[1];
    }
    EXPECT_TRUE(agrees(estimate_of(stated), 9.0 / 12));
    EXPECT_EQ(noise_variance({Rgb::Constant(1), 1}, {})[0], 0);
}

}  // namespace
}  // namespace patina
