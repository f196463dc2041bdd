// Standard errors against the scatter of many fits, and against the search itself.
#include "patina/estimate/error_propagation.h"

#include "patina/estimate/joint_fit.h"
#include "patina/math/statistics.h"

#include <gtest/gtest.h>

#include "support/false_alarms.h"
#include "support/synthetic_texel.h"
#include <array>
#include <cmath>
#include <vector>

namespace patina {
namespace {

const Reflectance kTruth{Rgb(0.6, 0.4, 0.3), 0.4, 0.15};
constexpr std::size_t kNumTexels = 2000;
constexpr double kNoise = 0.002;  // [radiance]

Parameters parameters_of(const Reflectance& r) {
    return {r.diffuse[0], r.diffuse[1], r.diffuse[2], r.specular, r.roughness};
}

// Adds noise to looks of the truth; shared: the same in the three channels of a look.
void add_noise(SyntheticTexel& texel, bool shared, Rng& rng) {
    texel.show(kTruth);
    for (FitRow& row : texel.rows()) {
        const double common = rng.normal();
        for (double& channel : row.radiance) channel += kNoise * (shared ? common : rng.normal());
        row.weight = Rgb::Constant(1 / square(kNoise));
    }
}

// Root mean square of (fit - truth) over the predicted standard error, per parameter; and the
// moments that all residuals together show.
struct Scatter {
    Parameters ratio = Parameters::Zero();
    ResidualMoments moments;
};

Scatter scatter(std::size_t num_looks, bool shared) {
    SyntheticTexel texel(num_looks, 0.6);
    texel.show(kTruth);
    for (FitRow& row : texel.rows()) row.weight = Rgb::Constant(1 / square(kNoise));
    const ErrorPropagation at_truth(texel.rows(), kTruth, KnownLobe::all);
    const Parameters& variance = shared ? at_truth.shared_variance() : at_truth.own_variance();
    Scatter result;
    JointFit fit;
    for (std::size_t i = 0; i < kNumTexels; ++i) {
        Rng rng(shared ? 21 : 20, Pass::tests, i * 100 + num_looks);
        add_noise(texel, shared, rng);
        fit.load(texel.rows());
        const Reflectance fitted = fit.solve({}, 0);
        result.ratio += (parameters_of(fitted) - parameters_of(kTruth)).cwiseAbs2();
        result.moments += ErrorPropagation(texel.rows(), fitted, KnownLobe::all).moments();
    }
    result.ratio = (result.ratio.array() / variance.array() / double(kNumTexels)).sqrt();
    return result;
}

// The root mean square of normal numbers scatters by 1/sqrt(2n); the fit is not linear in sigma,
// which adds about the square of its relative error: below 1 % here.
const double kScatter = normal_threshold() / std::sqrt(2.0 * double(kNumTexels)) + 0.01;

TEST(ErrorPropagation, PredictsTheScatterOfNoisyFits) {
    for (const std::size_t num_looks : {8u, 16u, 60u}) {
        const Scatter own = scatter(num_looks, false);
        for (int k = 0; k < kNumParameters; ++k) {
            EXPECT_NEAR(own.ratio[k], 1, kScatter) << num_looks << " looks, parameter " << k;
        }
        const double tolerance =
            normal_threshold() * std::sqrt(2.0 / (3.0 * double(num_looks * kNumTexels)));
        EXPECT_NEAR(own.moments.own_variance(), 1, 2 * tolerance + 0.01) << num_looks;
        EXPECT_NEAR(own.moments.shared_variance(), 0, 2 * tolerance + 0.01) << num_looks;
    }
}

TEST(ErrorPropagation, PredictsTheScatterOfErrorsThatChannelsShare) {
    const Scatter shared = scatter(16, true);
    for (int k = 0; k < kNumParameters; ++k) EXPECT_NEAR(shared.ratio[k], 1, kScatter) << k;
    // The fit takes off a little more of what is shared than of what is not.
    EXPECT_NEAR(shared.moments.shared_variance(), 1, 0.1);
    EXPECT_LT(shared.moments.own_variance(), 0.1);
}

TEST(ErrorPropagation, RespondsAsTheFitDoes) {
    SyntheticTexel texel(12, 0.6);
    texel.show(kTruth);
    const ErrorPropagation propagation(texel.rows(), kTruth, KnownLobe::all);
    std::vector<Rgb> change;
    for (std::size_t k = 0; k < texel.rows().size(); ++k) {
        change.push_back(1e-3 * Rgb(std::sin(double(k)), std::cos(2.0 * double(k)), 0.5));
    }
    for (std::size_t k = 0; k < change.size(); ++k) texel.rows()[k].radiance += change[k];
    JointFit fit;
    fit.load(texel.rows());
    const Parameters found = parameters_of(fit.solve({}, 0)) - parameters_of(kTruth);
    const Parameters predicted = propagation.response(change);
    // To first order; the search of sigma ends within 1e-4 of its logarithm.
    for (int k = 0; k < kNumParameters; ++k) {
        EXPECT_NEAR(found[k], predicted[k], 0.05 * predicted.norm()) << k;
    }
}

TEST(ErrorPropagation, LeavesAGivenLobeAlone) {
    SyntheticTexel texel(12, 0.6);
    texel.show(kTruth);
    const std::vector<Rgb> change(texel.rows().size(), Rgb::Constant(1e-3));
    const Parameters free = ErrorPropagation(texel.rows(), kTruth, KnownLobe::all).response(change);
    const Parameters given =
        ErrorPropagation(texel.rows(), kTruth, KnownLobe::none).response(change);
    EXPECT_NE(free[3], 0);
    EXPECT_NEAR(given[3], 0, 1e-15);
    EXPECT_NEAR(given[4], 0, 1e-15);
    EXPECT_GT(given[0], 0);
}

// Whatever else may be told of the lobe: nothing changes nothing, all of it leaves Pd as if the
// lobe were given.
TEST(ErrorPropagation, SharesWhatElseIsToldOfTheLobe) {
    SyntheticTexel texel(12, 0.6);
    texel.show(kTruth);
    for (FitRow& row : texel.rows()) row.weight = Rgb::Constant(1 / square(kNoise));
    const ErrorPropagation free(texel.rows(), kTruth, KnownLobe::all);
    const ErrorPropagation given(texel.rows(), kTruth, KnownLobe::none);
    constexpr double kScale = 1.7;
    const Parameters untold = free.share_beside(Eigen::Matrix2d::Zero(), kScale);
    const Parameters told = free.share_beside(1e12 * Eigen::Matrix2d::Identity(), kScale);
    for (int k = 0; k < kNumParameters; ++k) EXPECT_NEAR(untold[k], 1, 1e-9) << k;
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(told[k] * free.own_variance()[k] / given.own_variance()[k], 1, 1e-4) << k;
    }
    EXPECT_LT(told[3], 1e-4);
    EXPECT_LT(told[4], 1e-4);
    // As much again of sigma alone, whose variance is then halved.
    Eigen::Matrix2d again = Eigen::Matrix2d::Zero();
    again(1, 1) = 1 / (square(kScale) * free.own_variance()[4]);
    EXPECT_NEAR(free.share_beside(again, kScale)[4], 0.5, 1e-6);
}

// Residuals are those of the best fit, wherever the model is linearised about.
TEST(ErrorPropagation, LeavesTheLeastResiduals) {
    SyntheticTexel texel(12, 0.6);
    Rng rng(22, Pass::tests, 0);
    add_noise(texel, false, rng);
    JointFit fit;
    fit.load(texel.rows());
    const Reflectance best = fit.solve({}, 0);
    Reflectance drawn = best;
    drawn.specular *= 1.01;
    drawn.roughness *= 0.99;
    drawn.diffuse *= 1.01;
    const ErrorPropagation at_best(texel.rows(), best, KnownLobe::all);
    const ErrorPropagation beside(texel.rows(), drawn, KnownLobe::all);
    EXPECT_NEAR(beside.moments().own / at_best.moments().own, 1, 0.01);
    EXPECT_NEAR(beside.pull(beside.residuals()).head<4>().norm() /
                    beside.pull(std::vector<Rgb>(12, Rgb::Constant(kNoise))).head<4>().norm(),
                0,
                1e-9);
}

}  // namespace
}  // namespace patina
