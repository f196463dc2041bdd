// The fits of texel_fit.h under noise: repeated many times, with thresholds from the suite's
// false-alarm rate.
#include "patina/estimate/texel_fit.h"
#include "patina/math/statistics.h"

#include <gtest/gtest.h>

#include "support/comparison_level.h"
#include "support/synthetic_texel.h"
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace patina {
namespace {

const Reflectance kTruth{Rgb(0.6, 0.4, 0.3), 0.4, 0.15};
constexpr std::size_t kNumTexels = 2000;

// Errors over their stated standard errors, collected over texels.
struct Pulls {
    std::string name;
    std::vector<double> values;

    // Mean 0 and variance 1; bias: mean that is allowed besides, in standard errors.
    void expect_standard_normal(double bias) const {
        const Moments all = moments(values);
        const auto count = double(all.count);
        EXPECT_NEAR(all.mean, 0, bias + normal_threshold() / std::sqrt(count)) << name;
        // The root mean square of normal numbers has the relative standard deviation 1/sqrt(2n).
        EXPECT_NEAR(std::sqrt(all.variance), 1, normal_threshold() / std::sqrt(2 * count)) << name;
    }
};

TEST(FitJointlyUnderNoise, ReachesTheCramerRaoBoundWithoutBias) {
    std::array<Pulls, 5> pulls = {
        {{"Pd red", {}}, {"Pd green", {}}, {"Pd blue", {}}, {"Ps", {}}, {"sigma", {}}}};
    std::vector<double> misfits;
    SyntheticTexel texel(16, 0.6);
    double curvature = 0;
    for (std::size_t i = 0; i < kNumTexels; ++i) {
        Rng rng(1, Pass::tests, i);
        texel.show(kTruth, 0.01, 0.002, rng);
        const Reflectance fit = fit_jointly(texel.rows(), {});
        const FitErrors bound = fit_errors(texel.rows(), kTruth);
        for (Eigen::Index c = 0; c < 3; ++c) {
            pulls[std::size_t(c)].values.push_back((fit.diffuse[c] - kTruth.diffuse[c]) /
                                                   bound.diffuse[c]);
        }
        pulls[3].values.push_back((fit.specular - kTruth.specular) / bound.specular);
        pulls[4].values.push_back((fit.roughness - kTruth.roughness) / bound.roughness);
        misfits.push_back(fit_errors(texel.rows(), fit).misfit);
        curvature = bound.roughness / kTruth.roughness;
    }
    // Maximum likelihood is biased by the square of the relative error of sigma, the only parameter
    // that is not linear; in standard errors that is the relative error itself.
    for (const Pulls& each : pulls) each.expect_standard_normal(curvature);
    // Chi-square of 3 x 16 - 5 degrees of freedom each.
    EXPECT_NEAR(
        moments(misfits).mean, 1, normal_threshold() * std::sqrt(2.0 / (43 * double(kNumTexels))));
}

TEST(FitSpecularUnderNoise, IsUnbiasedWithPdGiven) {
    std::vector<double> errors;
    SyntheticTexel texel(16, 0.6);
    for (std::size_t i = 0; i < kNumTexels; ++i) {
        Rng rng(2, Pass::tests, i);
        texel.show(kTruth, 0.01, 0.002, rng);
        errors.push_back(fit_specular_at(texel.rows(), kTruth.diffuse, kTruth.roughness).specular -
                         kTruth.specular);
    }
    const Moments all = moments(errors);
    EXPECT_NEAR(all.mean, 0, normal_threshold() * std::sqrt(all.variance / double(kNumTexels)));
}

// Looks whose irradiance is known with noise, as that of photons is.
class NoisyIrradiance : public testing::Test {
  protected:
    static constexpr double kNoise = 0.2;  // relative
    static constexpr std::size_t kNumLooks = 200;

    // Mean of the fits' red Pd over its truth. state: whether the rows say how noisy they are.
    template <typename Fit>
    static Moments relative_diffuse(bool state, const Fit& fit) {
        constexpr std::size_t kTexels = 400;
        std::vector<double> values;
        for (std::size_t i = 0; i < kTexels; ++i) {
            Rng rng(4, Pass::tests, i);
            SyntheticTexel texel(kNumLooks, 1.0);
            texel.show(kTruth);
            for (FitRow& row : texel.rows()) {
                row.pixel_class = PixelClass::diffuse;
                const Rgb variance = (kNoise * row.irradiance).square();
                for (Eigen::Index c = 0; c < 3; ++c) {
                    row.irradiance[c] += std::sqrt(variance[c]) * rng.normal();
                }
                if (state) row.irradiance_variance = variance;
            }
            values.push_back(fit(texel.rows()) / kTruth.diffuse[0]);
        }
        return moments(values);
    }
    static double threshold(const Moments& all) {
        // A ratio of sums over n looks is biased by about its variance per look over n.
        return 4 * square(kNoise) / double(kNumLooks) +
               normal_threshold() * std::sqrt(all.variance / double(all.count));
    }
    static double diffuse_step(std::span<const FitRow> rows) {
        return fit_diffuse(rows, kTruth, {})[0];
    }
};

TEST_F(NoisyIrradiance, DoesNotBiasTheDiffuseStep) {
    const Moments all = relative_diffuse(true, diffuse_step);
    EXPECT_NEAR(all.mean, 1, threshold(all));
}

TEST_F(NoisyIrradiance, DoesNotBiasTheJointFit) {
    const Moments all = relative_diffuse(true, [](std::span<const FitRow> rows) {
        FitOptions options;
        options.min_roughness = options.max_roughness = kTruth.roughness;
        return fit_jointly(rows, options).diffuse[0];
    });
    EXPECT_NEAR(all.mean, 1, threshold(all));
}

TEST_F(NoisyIrradiance, AttenuatesPdUnlessItsVarianceIsStated) {
    const Moments all = relative_diffuse(false, diffuse_step);
    // Least squares attenuates by the signal's share of the second moment.
    EXPECT_NEAR(all.mean, 1 / (1 + square(kNoise)), threshold(all));
}

// Rows that are nearly all noise must not divide by nearly nothing.
TEST_F(NoisyIrradiance, TakesAwayAtMostHalfOfTheInformation) {
    SyntheticTexel texel(8, 1.0);
    texel.show(kTruth);
    for (FitRow& row : texel.rows()) row.irradiance_variance = 100 * row.irradiance.square();
    EXPECT_NEAR(diffuse_step(texel.rows()), 2 * kTruth.diffuse[0], 1e-12);
}

}  // namespace
}  // namespace patina
