#include "patina/estimate/lobe_misfit.h"

#include "patina/base/random.h"
#include "patina/math/statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/synthetic_texel.h"
#include <cmath>

namespace patina {
namespace {

constexpr std::size_t kNumTexels = 400;
constexpr std::size_t kNumLooks = 16;
constexpr double kNearest = 0.05;  // of the lamps to the mirror direction [rad]
constexpr double kFurthest = 0.5;
const Reflectance kCore{Rgb(0.5, 0.4, 0.3), 0.4, 0.1};
// What a lobe with long tails has besides: as much albedo again, twice as wide.
const Reflectance kTail{Rgb::Zero(), 0.1, 0.2};

// Noise of 1 % that the channels of a look share, on texels whose lobe has, or has not, tails that
// the model knows nothing of.
std::vector<double> misfits_of(bool has_tails) {
    std::vector<double> misfits;
    for (std::size_t i = 0; i < kNumTexels; ++i) {
        Rng rng(5, Pass::tests, i);
        SyntheticTexel texel(kNumLooks, 0);
        for (std::size_t k = 0; k < kNumLooks; ++k) {
            const double share = (double(k) + rng.uniform()) / double(kNumLooks);
            texel.place_lamp(k, kNearest + share * (kFurthest - kNearest));
        }
        for (FitRow& row : texel.rows()) {
            Rgb exact = predict(row, kCore);
            if (has_tails) exact += predict(row, kTail);
            const Rgb deviation = 0.01 * exact + 0.002;
            row.radiance = exact + deviation * rng.normal();
            row.weight = deviation.square().inverse();
        }
        const auto misfit = left_out_misfit(texel.rows(), kCore, {}, 1, FitOptions());
        if (misfit) misfits.push_back(*misfit);
    }
    return misfits;
}

using Misfits = std::vector<std::optional<double>>;

TEST(LobeMisfit, IsOneWhereTheLobeIsTheModels) {
    const std::vector<double> misfits = misfits_of(false);
    ASSERT_GT(misfits.size(), kNumTexels / 2);
    // The density of chi-square with one degree of freedom at its median 0.455 is 0.471, so that
    // the median of n has the deviation 1 / (2 x 0.471 sqrt(n)). Four of them: one false alarm in
    // 16 000.
    const double deviation = 1 / (2 * 0.471 * std::sqrt(double(misfits.size())));
    EXPECT_NEAR(median(misfits), 0.455, 4 * deviation);
}

TEST(LobeMisfit, ShowsTailsThatTheModelHasNot) {
    const std::vector<double> misfits = misfits_of(true);
    ASSERT_GT(misfits.size(), kNumTexels / 4);
    EXPECT_GT(lobe_misfit_factor(Misfits(misfits.begin(), misfits.end())), 2);
}

TEST(LobeMisfit, CountsErrorsThatTheLooksShare) {
    SyntheticTexel texel(kNumLooks, kFurthest);
    Rng rng(5, Pass::tests, 0);
    texel.show(kCore, 0.01, 0.002, rng);
    const auto misfit = [&](std::span<const std::vector<Rgb>> changes) {
        return left_out_misfit(texel.rows(), kCore, changes, 1, FitOptions()).value();
    };
    // The deepest look alone, by three of its standard deviations: its own variance of 1 and what
    // the others add become larger by nine.
    std::vector<std::vector<Rgb>> changes = {std::vector<Rgb>(kNumLooks, Rgb::Zero())};
    changes[0][0] = 3 * texel.rows()[0].weight.rsqrt();
    const double alone = misfit({});
    const double shared = misfit(changes);
    ASSERT_GT(alone, 0);
    // variance = residual^2 / misfit, and with v >= 1 the noise's, shared / alone = v / (v + 9).
    EXPECT_GE(shared / alone, 1 / 10.0);
    EXPECT_LT(shared / alone, 1);
    const double noise_variance = 9 / (alone / shared - 1);
    EXPECT_GE(noise_variance, 1 - 1e-9);
}

TEST(LobeMisfit, LeavesFewLooksAlone) {
    SyntheticTexel texel(4, 0.3);
    texel.show(kCore);
    EXPECT_EQ(left_out_misfit(texel.rows(), kCore, {}, 1, FitOptions()), std::nullopt);
}

TEST(LobeMisfit, LeavesOutOnlyWhereTheOthersMeasureALobe) {
    SyntheticTexel texel(kNumLooks, 0);
    for (std::size_t k = 1; k < kNumLooks; ++k) texel.place_lamp(k, 0.6 + 0.02 * double(k));
    Rng rng(5, Pass::tests, 0);
    texel.show(kCore, 0.01, 0.002, rng);
    EXPECT_EQ(left_out_misfit(texel.rows(), kCore, {}, 1, FitOptions()), std::nullopt);
}

TEST(LobeMisfitFactor, IsTheRootOfTheMedianOverThatOfChiSquareAndAtLeastOne) {
    EXPECT_NEAR(lobe_misfit_factor(Misfits(40, 0.4549 * 9)), 3, 1e-3);
    EXPECT_EQ(lobe_misfit_factor(Misfits(40, 0.1)), 1);
    // Texels that tell nothing do not count.
    Misfits few(10, 100.0);
    few.resize(100);
    EXPECT_EQ(lobe_misfit_factor(few), 1);
}

TEST(MisfitStride, AsksAboutAsManyTexelsOfAnyNumber) {
    std::vector<TexelFit> fits(100'000);
    EXPECT_EQ(misfit_stride(fits), 1);
    for (TexelFit& fit : fits) fit.roughness_measured = true;
    EXPECT_EQ(misfit_stride(fits), 6);
}

}  // namespace
}  // namespace patina
