// Each reason for an unmeasured lobe on a texel made for it, and what would mend it.
#include "patina/estimate/measurability.h"

#include "patina/estimate/error_propagation.h"

#include <gtest/gtest.h>

#include "support/synthetic_texel.h"
#include <cmath>
#include <limits>

namespace patina {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kCalibration = 0.01;  // noise of a look, relative [-]
constexpr double kRead = 0.002;        // and absolute [radiance]
constexpr std::size_t kNumLooks = 12;

// Looks whose lamps stand evenly from one mirror angle to the other [rad].
class Looks {
  public:
    Looks(double nearest, double furthest, const Reflectance& truth, double read = kRead)
        : texel_(kNumLooks, 0), truth_(truth), read_(read) {
        for (std::size_t k = 0; k < kNumLooks; ++k) {
            const double share = double(k) / double(kNumLooks - 1);
            texel_.place_lamp(k, nearest + share * (furthest - nearest));
        }
        show();
    }

    void place_lamp(std::size_t k, double theta_r) {
        texel_.place_lamp(k, theta_r);
        show();
    }

    [[nodiscard]] std::span<const FitRow> rows() { return texel_.rows(); }

    // Of a texel whose lobe was filled with the truth.
    [[nodiscard]] LobeReason reason() {
        TexelFit fit;
        fit.observed = true;
        return texel_measurability(rows(), truth_, fit, 1).reason;
    }
    [[nodiscard]] LobeShortfall shortfall() { return lobe_shortfall(rows(), truth_, 1); }
    [[nodiscard]] ExpectedErrors errors() { return expected_errors(rows(), truth_, 1); }

    // What the judge of lobes says of the truth.
    [[nodiscard]] bool is_measured() {
        TexelFit fit;
        fit.reflectance = truth_;
        judge_lobe(rows(), 1, false, {}, fit);
        return fit.specular_measured;
    }

  private:
    void show() {
        Rng rng(3, Pass::tests, 0);
        texel_.show(truth_, kCalibration, read_, rng);
    }

    SyntheticTexel texel_;
    Reflectance truth_;
    double read_;
};

const Reflectance kNarrow{Rgb(0.5, 0.4, 0.3), 0.4, 0.1};
const Reflectance kWide{Rgb(0.5, 0.4, 0.3), 0.4, 0.4};
const Reflectance kFaint{Rgb(0.5, 0.4, 0.3), 0.03, 0.1};

TEST(Measurability, LampsFarFromTheMirrorDirectionAreNotInTheLobe) {
    Looks looks(0.5, 1.0, kNarrow);
    EXPECT_FALSE(looks.is_measured());
    EXPECT_EQ(looks.reason(), LobeReason::no_lamp_in_lobe);
    EXPECT_LT(looks.shortfall().noise, 1);
    EXPECT_GT(looks.shortfall().off_lobe, 1);
    // Looks that reach into the lobe mend it.
    for (const std::size_t k : {0u, 1u, 2u}) looks.place_lamp(k, 0.06 * double(k));
    EXPECT_TRUE(looks.is_measured());
    EXPECT_EQ(looks.reason(), LobeReason::unconfirmed);
}

TEST(Measurability, LampsAtTheEdgeOfANoisyLobeAreNotInIt) {
    // Two looks inside two sigma, at a seventh of the lobe's height and less.
    Looks looks(0.19, 0.8, kFaint);
    EXPECT_FALSE(looks.is_measured());
    EXPECT_TRUE(has_look_inside(looks.rows(), kFaint.roughness));
    EXPECT_EQ(looks.reason(), LobeReason::no_lamp_in_lobe);
}

TEST(Measurability, LampsBesideTheLensDoNotSpanAWideLobe) {
    Looks looks(0.02, 0.12, kWide);
    EXPECT_FALSE(looks.is_measured());
    EXPECT_EQ(looks.reason(), LobeReason::narrow_baseline);
    EXPECT_LT(looks.shortfall().off_lobe, 1);
    EXPECT_GT(looks.shortfall().diffuse, 10);
    // Pd is as unknown as Ps: what it may be off by is what the lobe may take from it.
    EXPECT_GT(looks.errors().diffuse, 10 * kCalibration);
    // Lamps aside mend it, though none comes nearer to the mirror direction.
    for (const std::size_t k : {9u, 10u, 11u}) looks.place_lamp(k, 0.3 * double(k - 8));
    EXPECT_TRUE(looks.is_measured());
    EXPECT_EQ(looks.reason(), LobeReason::unconfirmed);
    EXPECT_LT(looks.errors().diffuse, 2 * kCalibration);
}

TEST(Measurability, OneLookInTheLobeDoesNotTellItsWidth) {
    Looks looks(0.8, 1.2, kNarrow);
    looks.place_lamp(0, 0.03);
    EXPECT_FALSE(looks.is_measured());
    EXPECT_EQ(looks.reason(), LobeReason::few_angles);
    EXPECT_LT(looks.shortfall().diffuse, 1.1);
    EXPECT_LT(looks.errors().specular, kSpecularRelativeError);
    looks.place_lamp(1, 0.12);
    EXPECT_TRUE(looks.is_measured());
    EXPECT_EQ(looks.reason(), LobeReason::unconfirmed);
}

TEST(Measurability, NoiseDrownsALobeThatLampsSpan) {
    Looks clear(0, 0.6, kNarrow);
    EXPECT_TRUE(clear.is_measured());
    Looks noisy(0, 0.6, kNarrow, 0.5);
    EXPECT_FALSE(noisy.is_measured());
    EXPECT_EQ(noisy.reason(), LobeReason::noise);
}

TEST(Measurability, ALobeThatShouldShowIsUnconfirmed) {
    Looks looks(0, 0.6, kNarrow);
    EXPECT_EQ(looks.reason(), LobeReason::unconfirmed);
}

TEST(Measurability, WhatIsMeasuredNeedsNoReason) {
    Looks looks(0, 0.6, kNarrow);
    TexelFit fit;
    EXPECT_EQ(texel_measurability({}, kNarrow, fit, 1).reason, LobeReason::not_observed);
    fit.observed = fit.specular_measured = true;
    EXPECT_EQ(texel_measurability(looks.rows(), kNarrow, fit, 1).reason, LobeReason::matte);
    fit.roughness_measured = true;
    EXPECT_EQ(texel_measurability(looks.rows(), kNarrow, fit, 1).reason, LobeReason::measured);
}

TEST(Measurability, LooksWithoutAnyResidualStillTellOnlyWhatTheySee) {
    Looks looks(100, 200, kNarrow);  // [rad]: the lobe is 0 there, to the last bit
    TexelFit fit;
    fit.observed = true;
    fit.misfit = 0;
    const TexelMeasurability found = texel_measurability(looks.rows(), kNarrow, fit, 0);
    EXPECT_EQ(found.reason, LobeReason::no_lamp_in_lobe);
    EXPECT_EQ(found.errors.specular, kInfinity);
    EXPECT_EQ(found.errors.roughness, kInfinity);
    EXPECT_LT(found.errors.diffuse, 1e-6);
}

// The product of the factors is the error that the judge compares with its mark.
TEST(Measurability, TheCausesMultiplyToTheWholeShortfall) {
    Looks looks(0.02, 0.25, kNarrow);
    const LobeShortfall shortfall = looks.shortfall();
    const FitErrors errors = fit_errors(looks.rows(), kNarrow);
    const double whole = std::max(errors.specular / largest_specular_error(kNarrow.specular),
                                  errors.roughness / largest_roughness_error(kNarrow.roughness));
    EXPECT_NEAR(shortfall.noise * shortfall.off_lobe * shortfall.diffuse * shortfall.width / whole,
                1,
                1e-9);
}

TEST(Measurability, ExpectsTheErrorsOfTheLinearisedFit) {
    Looks looks(0, 0.6, kNarrow);
    const ExpectedErrors errors = looks.errors();
    const Parameters sigma_given =
        ErrorPropagation(looks.rows(), kNarrow, KnownLobe::specular).own_variance();
    const Parameters all = ErrorPropagation(looks.rows(), kNarrow, KnownLobe::all).own_variance();
    EXPECT_NEAR(errors.specular * kNarrow.specular / std::sqrt(sigma_given[3]), 1, 1e-6);
    EXPECT_NEAR(errors.roughness * kNarrow.roughness / std::sqrt(all[4]), 1, 1e-6);
    // But for what is known of Ps beforehand, next to nothing here.
    EXPECT_NEAR(
        errors.diffuse * kNarrow.diffuse.mean() / std::sqrt(sigma_given.head<3>().mean()), 1, 1e-3);
    EXPECT_NEAR(expected_errors(looks.rows(), kNarrow, 3).specular / errors.specular, 3, 1e-9);
}

TEST(Measurability, ALookThatShowsNoLobeTellsPdAlone) {
    Looks looks(2.0, 2.5, kNarrow);
    const ExpectedErrors errors = looks.errors();
    EXPECT_LT(errors.diffuse, kCalibration);
    EXPECT_GT(errors.specular, 1);
    EXPECT_EQ(expected_errors({}, kNarrow, 1).diffuse, kInfinity);
    EXPECT_EQ(expected_errors({}, kNarrow, 1).specular, kInfinity);
}

}  // namespace
}  // namespace patina
