// Variances from residuals against the scatter of many fits.
#include "patina/estimate/residual_variance.h"

#include "patina/estimate/joint_fit.h"

#include <gtest/gtest.h>

#include "support/false_alarms.h"
#include "support/scenes.h"
#include "support/synthetic_texel.h"
#include <cmath>
#include <vector>

namespace patina {
namespace {

const Reflectance kTruth{Rgb(0.6, 0.4, 0.3), 0.4, 0.15};
constexpr int kSide = 48;
constexpr std::size_t kNumLooks = 16;
constexpr double kNoise = 0.002;  // [radiance]
// Looks nearer to the mirror direction than this lie in the lobe [rad].
constexpr double kInLobe = 0.3;

enum class Channels { independent, alike };

// Root mean square of fit - truth over the predicted standard error, per parameter. lobe_noise:
// noise of looks in the lobe over that of the others.
Parameters errors_over_predicted(double lobe_noise, Channels channels) {
    const TexelAtlas atlas =
        build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), kSide, kSide);
    std::vector<ResidualEvidence> evidence;
    std::vector<Parameters> errors;
    JointFit fit;
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        SyntheticTexel texel(kNumLooks, 0.6);
        texel.show(kTruth);
        Rng rng(22, Pass::tests, i);
        for (FitRow& row : texel.rows()) {
            const double noise = kNoise * (row.theta_r < kInLobe ? lobe_noise : 1);
            const double common = rng.normal();
            for (double& channel : row.radiance) {
                channel += noise * (channels == Channels::alike ? common : rng.normal());
            }
            row.weight = Rgb::Constant(1 / square(kNoise));
        }
        fit.load(texel.rows());
        const Reflectance r = fit.solve({}, 0);
        evidence.push_back(residual_evidence(ErrorPropagation(texel.rows(), r, KnownLobe::all)));
        errors.emplace_back();
        errors.back() << (r.diffuse - kTruth.diffuse).matrix(), r.specular - kTruth.specular,
            r.roughness - kTruth.roughness;
    }
    const ResidualVariance result = residual_variance(atlas, evidence);
    Parameters sum = Parameters::Zero();
    for (std::size_t i = 0; i < errors.size(); ++i) {
        sum += (errors[i].array().square() / result.variance[i].array()).matrix();
    }
    return (sum / double(errors.size())).cwiseSqrt();
}

// The root mean square of n normal numbers scatters by 1/sqrt(2n), as does, over 5 x 5 texels each,
// what is predicted; neighbours share predictions, so that counts 25 times over.
const double kScatter =
    normal_threshold() * std::sqrt(2.0) / std::sqrt(2.0 * double(kSide * kSide));
// Reckoned in first order: the lobe's width errs by 2 % here, and so do the derivatives.
constexpr double kFirstOrder = 0.04;

TEST(ResidualVariance, HoldsWhereNoiseIsAsStated) {
    for (const Channels channels : {Channels::independent, Channels::alike}) {
        const Parameters ratio = errors_over_predicted(1, channels);
        for (int k = 0; k < kNumParameters; ++k) {
            EXPECT_NEAR(ratio[k], 1, kScatter + kFirstOrder) << k;
        }
    }
}

// Each parameter follows other looks than the rest. The correction for what the fit took off its
// residuals is exact only for equal noise, and leaves up to a tenth where it differs by two; with
// one variance for all looks Pd is off by a quarter here.
TEST(ResidualVariance, FollowsTheLooksThatDecide) {
    constexpr double kUnequal = 0.1;
    for (const double lobe_noise : {0.5, 2.0}) {
        for (const Channels channels : {Channels::independent, Channels::alike}) {
            const Parameters ratio = errors_over_predicted(lobe_noise, channels);
            for (int k = 0; k < kNumParameters; ++k) {
                EXPECT_NEAR(ratio[k], 1, kScatter + kFirstOrder + kUnequal)
                    << k << " at " << lobe_noise;
            }
        }
    }
}

}  // namespace
}  // namespace patina
