#include "patina/estimate/texel_fit.h"

#include <gtest/gtest.h>

#include "support/synthetic_texel.h"
#include <array>
#include <cmath>
#include <limits>

namespace patina {
namespace {

const Reflectance kTruth{Rgb(0.6, 0.4, 0.3), 0.4, 0.15};

// Golden sections start from two steps of the grid, 2 log(0.6 / 0.03) / 13 = 0.461 of log sigma,
// and shrink them 14 times by 0.618: sigma is within 5.5e-4 of its best value, relative. Ps follows
// it by at most d log Ps / d log sigma = <theta_r^2 / sigma^2>, below 2 over the lobe, and Pd by
// less.
constexpr double kSearchError = 5.5e-4;
// Sums of a few dozen products in double precision.
constexpr double kRoundOff = 1e-12;

void expect_near(const Rgb& value, const Rgb& expected, double relative) {
    for (Eigen::Index c = 0; c < 3; ++c) {
        EXPECT_NEAR(value[c], expected[c], relative * expected[c]) << "channel " << c;
    }
}

TEST(TexelFit, PredictionIsIrradianceTimesTheReflectanceOfTheLobe) {
    const Vec3 n = Vec3(0.1, 0.2, 1).normalized();
    const Vec3 w_i = Vec3(0.5, -0.2, 0.9).normalized();
    const Vec3 w_v = Vec3(-0.2, 0.6, 0.8).normalized();
    LampTerm lamp;
    lamp.irradiance = Rgbf(2.0f, 1.5f, 0.5f);
    lamp.theta_r_squared = float(mirror_angle_squared(n, w_i, w_v));
    lamp.lobe_cosines = float(lobe_cosines(n.dot(w_i), n.dot(w_v)));
    FitRow row;
    row.irradiance = lamp.irradiance.cast<double>();
    row.lamps = std::span(&lamp, 1);
    // Angles and cosines are stored as floats: 6e-8 each, times theta_r^2 / 2 sigma^2 below 3.
    expect_near(predict(row, kTruth), Rgb(row.irradiance * evaluate(kTruth, n, w_i, w_v)), 3e-7);
}

TEST(TexelFit, LampsOfOneLookAddUp) {
    SyntheticTexel texel(2, 0.2);
    const std::array lamps = {texel.rows()[0].lamps[0], texel.rows()[1].lamps[0]};
    FitRow both;
    both.irradiance = texel.rows()[0].irradiance + texel.rows()[1].irradiance;
    both.lamps = lamps;
    expect_near(predict(both, kTruth),
                Rgb(predict(texel.rows()[0], kTruth) + predict(texel.rows()[1], kTruth)),
                kRoundOff);
}

TEST(TexelFit, IndirectLobeIsAParabolaInOctavesOfRoughness) {
    FitRow row;
    row.indirect_roughness = 0.2;
    row.indirect_lobe.half = Rgbf::Constant(1);
    row.indirect_lobe.same = Rgbf::Constant(2);
    row.indirect_lobe.twice = Rgbf::Constant(4);
    const auto at = [&](double octaves) {
        const double roughness = 0.2 * std::exp2(octaves);
        return lobe_basis(row, roughness)[0] / square(roughness);
    };
    constexpr double kFloat = 1e-6;
    for (const double octaves : {-1.0, -0.5, 0.0, 0.3, 1.0}) {
        EXPECT_NEAR(at(octaves), 2 + 1.5 * octaves + 0.5 * square(octaves), kFloat) << octaves;
    }
    // Nothing is extrapolated.
    EXPECT_NEAR(at(-2), at(-1), kFloat);
    EXPECT_NEAR(at(2), at(1), kFloat);
}

// Radiance has the capture's own unit, so no light is too faint.
TEST(TexelFit, FaintIndirectLobeCountsToo) {
    FitRow row;
    row.indirect_lobe = {Rgbf::Constant(1e-12f), Rgbf::Constant(1e-12f), Rgbf::Constant(1e-12f)};
    const double roughness = row.indirect_roughness;
    EXPECT_NEAR(lobe_basis(row, roughness)[0] / (1e-12 * square(roughness)), 1, 1e-6);
}

TEST(Classes, FollowTheMirrorAngleWhileThereAreNoMaps) {
    const FitOptions options;
    FitRow row;
    const auto at = [&](double sigmas) {
        row.theta_r = sigmas * options.initial_roughness;
        return classify_by_angle(row, options);
    };
    EXPECT_EQ(at(0), PixelClass::specular);
    EXPECT_EQ(at(1.99), PixelClass::specular);
    EXPECT_EQ(at(2.01), PixelClass::neither);
    EXPECT_EQ(at(3.49), PixelClass::neither);
    EXPECT_EQ(at(3.51), PixelClass::diffuse);
}

// A look of which the lobe makes the given share.
class ClassesByShare : public testing::Test {
  protected:
    PixelClass classify(double share, PixelClass previous) {
        SyntheticTexel texel(1, 0);
        const FitRow& row = texel.rows()[0];
        Reflectance present{Rgb::Constant(0.5), 0, 0.2};
        const double diffuse = (present.diffuse * row.irradiance).mean();
        present.specular = share / (1 - share) * diffuse / lobe_basis(row, 0.2).mean();
        return classify_by_share(row, present, previous, options_);
    }
    FitOptions options_;
};

TEST_F(ClassesByShare, FollowThePredictedShare) {
    const PixelClass none = PixelClass::neither;
    EXPECT_EQ(classify(0, none), PixelClass::diffuse);
    EXPECT_EQ(classify(0.019, none), PixelClass::diffuse);
    EXPECT_EQ(classify(0.021, none), PixelClass::neither);
    EXPECT_EQ(classify(0.299, none), PixelClass::neither);
    EXPECT_EQ(classify(0.301, none), PixelClass::specular);
}

TEST_F(ClassesByShare, HoldOnUntilTheShareHasLeftByHalf) {
    EXPECT_EQ(classify(0.029, PixelClass::diffuse), PixelClass::diffuse);
    EXPECT_EQ(classify(0.031, PixelClass::diffuse), PixelClass::neither);
    EXPECT_EQ(classify(0.201, PixelClass::specular), PixelClass::specular);
    EXPECT_EQ(classify(0.199, PixelClass::specular), PixelClass::neither);
    // A class does not hold on to what lies in another one.
    EXPECT_EQ(classify(0.01, PixelClass::specular), PixelClass::diffuse);
    EXPECT_EQ(classify(0.4, PixelClass::diffuse), PixelClass::specular);
}

TEST_F(ClassesByShare, UnlitLooksAreDiffuse) {
    EXPECT_EQ(classify_by_share(FitRow(), kTruth, PixelClass::neither, options_),
              PixelClass::diffuse);
}

TEST(FitDiffuse, RecoversPdWhenTheLobeIsKnown) {
    SyntheticTexel texel(16, 1.0);
    texel.show(kTruth);
    texel.classify({});
    ASSERT_TRUE(has_diffuse_row(texel.rows()));
    expect_near(fit_diffuse(texel.rows(), kTruth, {}), kTruth.diffuse, kRoundOff);
}

TEST(FitDiffuse, TakesDiffuseRowsAloneWhereThereAreAny) {
    SyntheticTexel texel(16, 1.0);
    texel.show(kTruth);
    texel.classify({});
    for (FitRow& row : texel.rows()) {
        if (row.pixel_class != PixelClass::diffuse) row.radiance *= 10;
    }
    expect_near(fit_diffuse(texel.rows(), kTruth, {}), kTruth.diffuse, kRoundOff);
}

TEST(FitDiffuse, TakesTheNextBestRowsWhereThereAreNoDiffuseOnes) {
    SyntheticTexel texel(16, 0.5);  // up to 3.3 sigma_0
    texel.show(kTruth);
    texel.classify({});
    ASSERT_FALSE(has_diffuse_row(texel.rows()));
    for (FitRow& row : texel.rows()) {
        if (row.pixel_class == PixelClass::specular) row.radiance *= 10;
    }
    expect_near(fit_diffuse(texel.rows(), kTruth, {}), kTruth.diffuse, kRoundOff);
    SyntheticTexel highlight(5, 0.2);
    highlight.show(kTruth);
    highlight.classify({});
    expect_near(fit_diffuse(highlight.rows(), kTruth, {}), kTruth.diffuse, kRoundOff);
}

TEST(FitDiffuse, LiteralFitTakesTheTailOfTheLobeForDiffuse) {
    const Reflectance broad{kTruth.diffuse, kTruth.specular, 0.3};  // reaches into T_diff
    SyntheticTexel texel(16, 1.0);
    texel.show(broad);
    texel.classify({});
    // Least squares: the bias is the lobe's regression on the irradiance.
    Rgb tail = Rgb::Zero();
    Rgb whole = Rgb::Zero();
    for (const FitRow& row : texel.rows()) {
        if (row.pixel_class != PixelClass::diffuse) continue;
        tail += broad.specular * lobe_basis(row, broad.roughness) * row.irradiance;
        whole += row.irradiance.square();
    }
    const Rgb bias = tail / whole;
    EXPECT_GT(bias.minCoeff(), 0.02);
    FitOptions literal;
    literal.literal = true;
    expect_near(fit_diffuse(texel.rows(), broad, literal), broad.diffuse + bias, kRoundOff);
    expect_near(fit_diffuse(texel.rows(), broad, {}), broad.diffuse, kRoundOff);
}

TEST(FitDiffuse, IsZeroWithoutLightAndNeverNegative) {
    SyntheticTexel texel(4, 1.0);
    for (FitRow& row : texel.rows()) row.radiance = Rgb::Constant(-0.1);
    EXPECT_TRUE(fit_diffuse(texel.rows(), {}, {}).isZero());
    for (FitRow& row : texel.rows()) row.irradiance = Rgb::Zero();
    EXPECT_TRUE(fit_diffuse(texel.rows(), {}, {}).isZero());
    EXPECT_TRUE(fit_diffuse({}, {}, {}).isZero());
}

TEST(FitSpecular, RecoversPsAndSigmaWhenPdIsKnown) {
    for (const double roughness : {0.08, 0.15, 0.3}) {
        const Reflectance truth{kTruth.diffuse, kTruth.specular, roughness};
        SyntheticTexel texel(16, 4 * roughness);
        texel.show(truth);
        const SpecularFit fit = fit_specular(texel.rows(), truth.diffuse, {});
        EXPECT_TRUE(fit.has_rows);
        EXPECT_NEAR(fit.roughness, roughness, kSearchError * roughness);
        EXPECT_NEAR(fit.specular, truth.specular, 2 * kSearchError * truth.specular);
        const SpecularFit known = fit_specular_at(texel.rows(), truth.diffuse, roughness);
        EXPECT_NEAR(known.specular, truth.specular, kRoundOff);
    }
}

TEST(FitSpecular, LeavesDiffuseRowsFarFromTheMirrorDirectionOut) {
    const FitOptions options;
    SyntheticTexel texel(32, 1.0);
    texel.show(kTruth);
    texel.classify(options);
    for (FitRow& row : texel.rows()) {
        if (row.pixel_class == PixelClass::diffuse) row.radiance *= 10;
    }
    const SpecularFit fit = fit_specular(texel.rows(), kTruth.diffuse, options);
    EXPECT_NEAR(fit.specular, kTruth.specular, 2 * kSearchError * kTruth.specular);
}

// Otherwise a texel once thought matte would stay so.
TEST(FitSpecular, FindsTheLobeOfRowsThatCountAsDiffuse) {
    SyntheticTexel texel(16, 0.6);
    texel.show(kTruth);
    for (FitRow& row : texel.rows()) row.pixel_class = PixelClass::diffuse;
    const SpecularFit fit = fit_specular(texel.rows(), kTruth.diffuse, {});
    EXPECT_NEAR(fit.specular, kTruth.specular, 2 * kSearchError * kTruth.specular);
}

TEST(FitSpecular, SaysWhenNoRowIsInTheLobe) {
    SyntheticTexel texel(4, 1.0);
    texel.classify({});
    EXPECT_FALSE(fit_specular(texel.rows().last(1), kTruth.diffuse, {}).has_rows);
    EXPECT_FALSE(fit_specular({}, kTruth.diffuse, {}).has_rows);
    EXPECT_FALSE(fit_specular_at({}, kTruth.diffuse, 0.2).has_rows);
}

TEST(FitSpecular, IsNeverNegative) {
    SyntheticTexel texel(8, 0.4);
    texel.show({kTruth.diffuse, 0, 0.2});
    EXPECT_EQ(fit_specular(texel.rows(), Rgb(2 * kTruth.diffuse), {}).specular, 0);
}

TEST(FitJointly, RecoversAllWithoutKnowingAny) {
    for (const double roughness : {0.08, 0.15, 0.3}) {
        const Reflectance truth{kTruth.diffuse, kTruth.specular, roughness};
        SyntheticTexel texel(16, 4 * roughness);
        texel.show(truth);
        const Reflectance fit = fit_jointly(texel.rows(), {});
        EXPECT_NEAR(fit.roughness, roughness, kSearchError * roughness);
        EXPECT_NEAR(fit.specular, truth.specular, 2 * kSearchError * truth.specular);
        expect_near(fit.diffuse, truth.diffuse, 2 * kSearchError);
    }
}

TEST(FitJointly, FindsMatteSurfacesMatte) {
    const Reflectance matte{kTruth.diffuse, 0, 0.2};
    SyntheticTexel texel(16, 0.6);
    texel.show(matte);
    const Reflectance fit = fit_jointly(texel.rows(), {});
    EXPECT_NEAR(fit.specular, 0, kRoundOff);
    expect_near(fit.diffuse, matte.diffuse, kRoundOff);
}

// The parameters as one vector: Pd of the channels, Ps, sigma.
using Parameters = Eigen::Matrix<double, 5, 1>;
Reflectance reflectance_of(const Parameters& p) { return {Rgb(p[0], p[1], p[2]), p[3], p[4]}; }

TEST(FitErrors, AreTheInverseOfTheNumericalInformation) {
    SyntheticTexel texel(12, 0.5);
    Rng rng(3, Pass::tests, 0);
    texel.show(kTruth, 0.02, 0.005, rng);
    Parameters at;
    at << kTruth.diffuse[0], kTruth.diffuse[1], kTruth.diffuse[2], kTruth.specular,
        kTruth.roughness;
    // Central differences: errors of step^2 / sigma^2 in the derivative by sigma.
    constexpr double kStep = 1e-5;
    Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
    for (const FitRow& row : texel.rows()) {
        Eigen::Matrix<double, 3, 5> jacobian;
        for (Eigen::Index p = 0; p < 5; ++p) {
            const Parameters step = kStep * Parameters::Unit(p);
            const Rgb difference =
                predict(row, reflectance_of(at + step)) - predict(row, reflectance_of(at - step));
            jacobian.col(p) = (difference / (2 * kStep)).matrix();
        }
        information += jacobian.transpose() * row.weight.matrix().asDiagonal() * jacobian;
    }
    const Eigen::Matrix<double, 5, 5> covariance = information.inverse();
    const auto expected = [&](Eigen::Index p) { return std::sqrt(covariance(p, p)); };
    constexpr double kTolerance = 1e-6;
    const FitErrors errors = fit_errors(texel.rows(), kTruth);
    for (Eigen::Index c = 0; c < 3; ++c) {
        EXPECT_NEAR(errors.diffuse[c] / expected(c), 1, kTolerance);
        EXPECT_NEAR(errors.diffuse_lobe_known[c] * std::sqrt(information(c, c)), 1, kTolerance);
    }
    EXPECT_NEAR(errors.specular / expected(3), 1, kTolerance);
    EXPECT_NEAR(errors.roughness / expected(4), 1, kTolerance);
    const Eigen::Matrix<double, 4, 4> sigma_known = information.topLeftCorner<4, 4>().inverse();
    EXPECT_NEAR(errors.specular_sigma_known / std::sqrt(sigma_known(3, 3)), 1, kTolerance);
}

TEST(FitErrors, AreInfiniteForWhatTheLooksDoNotTell) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    SyntheticTexel texel(8, 0);  // all in the mirror direction: sigma has no effect
    texel.show(kTruth);
    const FitErrors errors = fit_errors(texel.rows(), kTruth);
    EXPECT_EQ(errors.specular, kInfinity);
    EXPECT_EQ(errors.roughness, kInfinity);
    EXPECT_LT(errors.specular_sigma_known, kInfinity);
    EXPECT_LT(errors.diffuse.maxCoeff(), kInfinity);
    EXPECT_GT(errors.diffuse.minCoeff(), errors.diffuse_lobe_known.maxCoeff());
    const FitErrors none = fit_errors({}, kTruth);
    EXPECT_EQ(none.specular_sigma_known, kInfinity);
    EXPECT_EQ(none.diffuse.minCoeff(), kInfinity);
    EXPECT_EQ(none.diffuse_lobe_known.minCoeff(), kInfinity);
}

}  // namespace
}  // namespace patina
