#include "patina/estimate/scale_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace patina {
namespace {

constexpr std::size_t kNumBlocks = 6;
constexpr std::size_t kNumSets = 4;

// Costs by a formula of ln k, the block and the set of lamps.
// So many that their noise does not count.
constexpr double kLooks = 1e6;

class FormulaTrials final : public ProfileTrials {
  public:
    using Cost = std::function<double(double x, std::size_t block, std::size_t set)>;
    explicit FormulaTrials(Cost cost, double clamped_share = 0)
        : cost_(std::move(cost)), clamped_share_(clamped_share) {}

    void settle(double) override {}
    ProfileTrial try_at(double x, double) override {
        ProfileTrial trial;
        trial.clamped_share = clamped_share_;
        for (std::size_t block = 0; block < kNumBlocks; ++block) {
            for (std::size_t set = 0; set < kNumSets; ++set) {
                trial.costs.push_back(kLooks * cost_(x, block, set));
            }
        }
        return trial;
    }

  private:
    Cost cost_;
    double clamped_share_;
};

// A parabola in each cell; its lowest point swings about ln 2 from block to block.
double swinging(double x, std::size_t block, std::size_t) {
    const double lowest = std::log(2.0) + (block % 2 == 0 ? 0.05 : -0.05);
    return 100 * (x - lowest) * (x - lowest);
}

TEST(FindScale, FindsTheLowestPointAndItsErrorFromTheBlocks) {
    FormulaTrials trials(swinging);
    const ScaleEstimate scale = find_scale(trials, 0, kNumSets);
    EXPECT_TRUE(scale.told);
    EXPECT_NEAR(scale.factor, 2, 1e-9);
    EXPECT_EQ(scale.factor, scale.best_factor);
    // The mean of six numbers of +-0.05, their standard deviation with the correction 6/5. All four
    // sets of lamps of a block say the same, which must not count as four times as much.
    EXPECT_NEAR(scale.standard_error, 0.05 / std::sqrt(5.0), 1e-9);
}

TEST(FindScale, TellsNothingFromALevelCost) {
    FormulaTrials trials([](double, std::size_t, std::size_t) { return 7.0; });
    const ScaleEstimate scale = find_scale(trials, 0.3, kNumSets);
    EXPECT_FALSE(scale.told);
    EXPECT_EQ(scale.factor, 1);
    EXPECT_TRUE(std::isinf(scale.standard_error));
    EXPECT_FALSE(scale.reason.empty());
}

TEST(FindScale, TellsNothingWhereTheCostFallsForEver) {
    for (const double sign : {-1.0, 1.0}) {
        FormulaTrials trials(
            [sign](double x, std::size_t, std::size_t) { return std::exp(sign * x); });
        EXPECT_FALSE(find_scale(trials, 0, kNumSets).told);
    }
}

TEST(FindScale, TellsNothingWhereTheErrorIsLarge) {
    FormulaTrials trials([](double x, std::size_t block, std::size_t) {
        const double lowest = block % 2 == 0 ? 0.3 : -0.3;
        return (x - lowest) * (x - lowest);
    });
    const ScaleEstimate scale = find_scale(trials, 0.3, kNumSets);
    EXPECT_FALSE(scale.told);
    EXPECT_EQ(scale.factor, 1);
    EXPECT_NEAR(scale.best_factor, 1, 1e-9);
    EXPECT_NEAR(scale.standard_error, 0.3 / std::sqrt(5.0), 1e-9);
}

// What rounding makes of a cost that depends on nothing.
TEST(FindScale, TellsNothingFromLessThanTheNoiseOfTheLooks) {
    FormulaTrials trials([](double x, std::size_t block, std::size_t) {
        const double lowest = block % 2 == 0 ? 1e-3 : -1e-3;
        return 1e-6 * (x - lowest) * (x - lowest);
    });
    const ScaleEstimate scale = find_scale(trials, 0, kNumSets);
    EXPECT_FALSE(scale.told);
    EXPECT_NEAR(scale.standard_error, 1 / std::sqrt(double(kNumBlocks * kNumSets)), 1e-9);
}

TEST(FindScale, TellsNothingThatTheTexelsCannotReflect) {
    FormulaTrials trials(swinging, 0.5);
    const ScaleEstimate scale = find_scale(trials, 0, kNumSets);
    EXPECT_FALSE(scale.told);
    EXPECT_NE(scale.reason.find("more light than they get"), std::string::npos);
}

TEST(ClusteredDeviation, KnowsErrorsThatBlocksOrLampsShare) {
    const auto scores = [](const std::function<double(std::size_t, std::size_t)>& score) {
        std::vector<double> all;
        for (std::size_t block = 0; block < kNumBlocks; ++block) {
            for (std::size_t set = 0; set < kNumSets; ++set) all.push_back(score(block, set));
        }
        return all;
    };
    const auto sign = [](std::size_t i) { return i % 2 == 0 ? 1.0 : -1.0; };
    // Shared by the sets of a block: six sums of 4, corrected by 6/5.
    EXPECT_NEAR(clustered_deviation(
                    scores([&](std::size_t block, std::size_t) { return sign(block); }), kNumSets),
                std::sqrt(6 * 16 * 6.0 / 5),
                1e-12);
    // Shared by the blocks of a set: four sums of 6, corrected by 4/3.
    EXPECT_NEAR(clustered_deviation(scores([&](std::size_t, std::size_t set) { return sign(set); }),
                                    kNumSets),
                std::sqrt(4 * 36 * 4.0 / 3),
                1e-12);
}

}  // namespace
}  // namespace patina
