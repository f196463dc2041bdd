#include "patina/math/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace patina {
namespace {

TEST(Quantile, IsLinearBetweenSortedValues) {
    const std::vector<double> values = {4, 1, 3, 2};
    EXPECT_EQ(quantile(values, 0), 1);
    EXPECT_EQ(quantile(values, 1), 4);
    EXPECT_DOUBLE_EQ(quantile(values, 0.5), 2.5);
    EXPECT_DOUBLE_EQ(quantile(values, 0.25), 1.75);
}

TEST(Quantile, OfNothingIsNan) { EXPECT_TRUE(std::isnan(quantile({}, 0.5))); }

TEST(Median, OfAnOddNumberIsTheMiddleValue) { EXPECT_EQ(median({5, -1, 2}), 2); }

TEST(Moments, AreThoseOfThePopulation) {
    const std::vector<double> values = {2, 4, 4, 4, 5, 5, 7, 9};
    const Moments result = moments(values);
    EXPECT_EQ(result.count, 8u);
    EXPECT_DOUBLE_EQ(result.mean, 5);
    EXPECT_DOUBLE_EQ(result.variance, 4);
}

TEST(Moments, OfNothingAreZero) {
    EXPECT_EQ(moments({}).count, 0u);
    EXPECT_EQ(moments({}).variance, 0);
}

TEST(RankCorrelation, SeesAnyRisingOrFallingRelation) {
    const std::vector<double> x = {1, 2, 3, 4};
    EXPECT_DOUBLE_EQ(rank_correlation(x, std::vector<double>{1, 10, 100, 1000}), 1);
    EXPECT_DOUBLE_EQ(rank_correlation(x, std::vector<double>{4, 1, 0, -9}), -1);
    // Ranks 0 1 2 3 and 1 0 3 2: 1 - 6 * 4 / (4 * 15).
    EXPECT_DOUBLE_EQ(rank_correlation(x, std::vector<double>{2, 1, 4, 3}), 0.6);
}

TEST(RankCorrelation, SharesRanksOfEqualValues) {
    const std::vector<double> x = {1, 1, 2, 2};
    EXPECT_DOUBLE_EQ(rank_correlation(x, std::vector<double>{5, 5, 7, 7}), 1);
    EXPECT_DOUBLE_EQ(rank_correlation(x, std::vector<double>{5, 7, 5, 7}), 0);
    EXPECT_EQ(rank_correlation(x, std::vector<double>{5, 5, 5, 5}), 0);
}

// Values of Abramowitz and Stegun, table 26.1.
TEST(NormalCdf, MatchesTheTable) {
    EXPECT_DOUBLE_EQ(normal_cdf(0), 0.5);
    EXPECT_NEAR(normal_cdf(1), 0.841344746068543, 1e-15);
    EXPECT_NEAR(normal_cdf(-2), 0.022750131948179, 1e-15);
}

TEST(NormalQuantile, InvertsTheDistributionFunction) {
    for (const double p : {1e-12, 1e-6, 0.001, 0.02, 0.3, 0.5, 0.7, 0.98, 0.999, 1 - 1e-6}) {
        EXPECT_NEAR(normal_cdf(normal_quantile(p)) / p, 1, 1e-11) << p;
    }
    EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
}

// For two degrees of freedom the survival is exp(-x/2), for four (1 + x/2) exp(-x/2), for one
// erfc(sqrt(x/2)).
TEST(ChiSquareSurvival, MatchesTheClosedForms) {
    for (const double x : {0.01, 0.5, 1.0, 3.0, 10.0, 40.0}) {
        EXPECT_NEAR(chi_square_survival(x, 2) / std::exp(-x / 2), 1, 1e-12) << x;
        EXPECT_NEAR(chi_square_survival(x, 4) / ((1 + x / 2) * std::exp(-x / 2)), 1, 1e-12) << x;
        EXPECT_NEAR(chi_square_survival(x, 1) / std::erfc(std::sqrt(x / 2)), 1, 1e-12) << x;
    }
    EXPECT_EQ(chi_square_survival(0, 3), 1);
}

TEST(ChiSquareTest, AddsTheCells) {
    const std::vector<double> observed = {12, 8, 10};
    const std::vector<double> expected = {10, 10, 10};
    const ChiSquareTest test = chi_square_test(observed, expected);
    EXPECT_DOUBLE_EQ(test.statistic, 0.8);
    EXPECT_EQ(test.degrees_of_freedom, 2);
    EXPECT_NEAR(test.p_value, std::exp(-0.4), 1e-12);
}

TEST(ChiSquareTest, PoolsCellsOfSmallExpectation) {
    // 1 + 2 + 3 make one pool of 6; 10 and 20 stand alone.
    const std::vector<double> observed = {3, 20, 2, 10, 1};
    const std::vector<double> expected = {3, 20, 2, 10, 1};
    EXPECT_EQ(chi_square_test(observed, expected).degrees_of_freedom, 2);
}

TEST(ChiSquareTest, KeepsTheCellsLeftAfterTheLastPool) {
    // 3 + 3 make a pool of 6, to which the third cell is added: one pool, nothing lost.
    const std::vector<double> observed = {3, 3, 12};
    const std::vector<double> expected = {3, 3, 3};
    EXPECT_DOUBLE_EQ(chi_square_test(observed, expected).statistic, 9);
}

TEST(ChiSquareTest, SeesCountsOutsideTheExpectedSupport) {
    const std::vector<double> observed = {100, 100, 100};
    const std::vector<double> expected = {150, 150, 0};
    // The empty cell is pooled with one of the others: 50^2/150 from each of the two pools.
    EXPECT_NEAR(chi_square_test(observed, expected).statistic, 100.0 / 3, 1e-12);
}

}  // namespace
}  // namespace patina
