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

}  // namespace
}  // namespace patina
