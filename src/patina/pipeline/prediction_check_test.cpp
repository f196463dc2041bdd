#include "patina/pipeline/prediction_check.h"

#include "patina/base/random.h"

#include <gtest/gtest.h>

#include "support/false_alarms.h"
#include <cmath>

namespace patina {
namespace {

constexpr int kCount = 20000;
// The square of a normal number has the variance 2; noise and check each have their own sample.
const double kTolerance = normal_threshold() * std::sqrt(2 * 2.0 / kCount);

TEST(PredictionCheck, FindsOneForNoiseLikeThatOfTheUsedShots) {
    ResidualNoise noise;
    PredictionSums sums;
    for (const bool used : {true, false}) {
        for (int i = 0; i < kCount; ++i) {
            Rng rng(used ? 40 : 41, Pass::tests, std::uint64_t(i));
            const double radiance = 0.01 * std::exp(4 * rng.uniform());
            const double residual = 0.02 * radiance * rng.normal();
            if (used) {
                noise.add(radiance, residual);
            } else {
                sums.add(residual, noise.variance(radiance, 1));
            }
        }
    }
    const auto check = sums.result();
    ASSERT_TRUE(check.has_value());
    EXPECT_NEAR(check->reduced_chi_square, 1, kTolerance);
    // Within half an octave the deviation varies by a factor 1.4, which rounds the peak off.
    EXPECT_NEAR(check->coverage68, 0.683, 0.02);
    EXPECT_NEAR(check->coverage95, 0.95, 0.01);
}

TEST(PredictionCheck, SeesResidualsTwiceAsLarge) {
    ResidualNoise noise;
    noise.add(1, 0.1);
    PredictionSums sums;
    sums.add(0.2, noise.variance(1, 1));
    EXPECT_NEAR(sums.result()->reduced_chi_square, 4, 1e-12);
    EXPECT_EQ(sums.result()->coverage95, 0);
}

TEST(PredictionCheck, TakesTheNearestBrightnessThatIsKnown) {
    ResidualNoise noise;
    EXPECT_EQ(noise.variance(1, 1), 0);
    noise.add(0.01, 0.1);
    noise.add(1, 0.3);
    EXPECT_NEAR(noise.variance(100, 2), 2 * 0.09, 1e-12);
    EXPECT_NEAR(noise.variance(0, 1), 0.01, 1e-12);
}

TEST(PredictionCheck, CountsWhatFittingTakesOff) {
    EXPECT_NEAR(fitted_share(10, true), 10 / (10 - 5.0 / 3), 1e-12);
    EXPECT_NEAR(fitted_share(10, false), 10.0 / 9, 1e-12);
    EXPECT_EQ(fitted_share(2, true), 1);
    EXPECT_FALSE(PredictionSums().result().has_value());
}

}  // namespace
}  // namespace patina
