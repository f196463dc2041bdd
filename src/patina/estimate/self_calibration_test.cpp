// Errors that all texels share, put into looks and found again.
#include "patina/estimate/self_calibration.h"

#include "patina/base/parallel.h"
#include "patina/estimate/joint_fit.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "support/false_alarms.h"
#include "support/scenes.h"
#include "support/synthetic_texel.h"
#include <cmath>
#include <vector>

namespace patina {
namespace {

const Reflectance kTruth{Rgb(0.6, 0.4, 0.3), 0.4, 0.15};
constexpr std::size_t kNumLooks = 10;
constexpr std::size_t kTexelsPerPatch = 6;
constexpr double kNoise = 0.003;  // [radiance]
// What the capture states: every lamp's intensity to so much, relative.
constexpr double kStated = 0.02;

// Every look has a lamp of its own, which shines brighter than stated by kStated times its error.
SharedErrors find(const Eigen::VectorXd& errors, std::size_t num_patches, std::uint64_t seed) {
    SelfCalibration calibration(kNumLooks);
    JointFit fit;
    for (std::size_t patch = 0; patch < num_patches; ++patch) {
        Rng rng(seed, Pass::tests, patch);
        // Half of the noise is the same in a whole patch.
        std::vector<Rgb> common(kNumLooks);
        for (Rgb& noise : common) noise = Rgb(rng.normal(), rng.normal(), rng.normal());
        for (std::size_t i = 0; i < kTexelsPerPatch; ++i) {
            SyntheticTexel texel(kNumLooks, 0.6);
            texel.show(kTruth);
            std::vector<SharedChange> changes;
            for (std::size_t k = 0; k < kNumLooks; ++k) {
                FitRow& row = texel.rows()[k];
                const Rgb change = kStated * row.radiance;
                changes.push_back({k, std::vector<Rgb>(kNumLooks, Rgb::Zero())});
                changes.back().radiance[k] = change;
                const Rgb own(rng.normal(), rng.normal(), rng.normal());
                row.radiance +=
                    errors[Eigen::Index(k)] * change + kNoise * std::sqrt(0.5) * (own + common[k]);
                row.weight = Rgb::Constant(1 / square(kNoise));
            }
            fit.load(texel.rows());
            const Reflectance fitted = fit.solve({}, 0);
            calibration.add(patch, texel.rows(), {texel.rows(), fitted, KnownLobe::all}, changes);
        }
    }
    return calibration.solve();
}

Eigen::VectorXd draw_errors(std::uint64_t seed) {
    Rng rng(seed, Pass::tests, 12345);
    Eigen::VectorXd errors(kNumLooks);
    for (double& error : errors) error = rng.normal();
    return errors;
}

// (x - found)' covariance^-1 (x - found) is chi-square with as many degrees of freedom as there are
// errors, mean d and variance 2 d.
TEST(SelfCalibration, ErrsAsItSays) {
    constexpr std::size_t kNumCaptures = 40;
    std::vector<double> distances(kNumCaptures);
    std::vector<double> unknown(kNumCaptures);
    parallel_for(
        kNumCaptures,
        [&](std::size_t i) {
            const Eigen::VectorXd errors = draw_errors(i);
            const SharedErrors found = find(errors, SelfCalibration::kNumPatches, 100 + i);
            const Eigen::VectorXd left = errors - found.value;
            distances[i] = left.dot(found.covariance.ldlt().solve(left));
            unknown[i] = found.covariance.trace() / double(kNumLooks);
        },
        1);
    // Covariances from 256 patches scatter by a tenth; the fit is linear to a tenth at errors of
    // two percent.
    constexpr double kBias = 0.15 * double(kNumLooks);
    EXPECT_TRUE(agrees(estimate_of(distances), double(kNumLooks), kBias));
    // What all lamps have in common is reflectance, and two more combinations are a lobe's height
    // and width. The rest is told.
    EXPECT_GT(estimate_of(unknown).mean, 0.9 / double(kNumLooks));
    EXPECT_LT(estimate_of(unknown).mean, 4.0 / double(kNumLooks));
}

TEST(SelfCalibration, LeavesWhatIsStatedWhereNothingTells) {
    const SharedErrors none = SelfCalibration(4).solve();
    EXPECT_EQ(none.value, Eigen::VectorXd::Zero(4));
    EXPECT_EQ(none.covariance, Eigen::MatrixXd::Identity(4, 4));
    // As many errors as patches.
    const SharedErrors few = find(draw_errors(1), kNumLooks, 1);
    EXPECT_EQ(few.value, Eigen::VectorXd::Zero(kNumLooks));
    EXPECT_EQ(few.covariance, Eigen::MatrixXd::Identity(kNumLooks, kNumLooks));
}

// Residuals that ask for lamps six stated deviations off tell of something else.
TEST(SelfCalibration, BelievesNothingIncredible) {
    const Eigen::VectorXd errors = 6 * draw_errors(1).normalized() * std::sqrt(double(kNumLooks));
    const SharedErrors found = find(errors, SelfCalibration::kNumPatches, 1);
    EXPECT_EQ(found.value, Eigen::VectorXd::Zero(kNumLooks));
    EXPECT_EQ(found.covariance, Eigen::MatrixXd::Identity(kNumLooks, kNumLooks));
}

TEST(SelfCalibration, PatchesCutTheTexelDomain) {
    const TexelAtlas atlas =
        build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), 64, 32);
    std::vector<int> count(SelfCalibration::kNumPatches, 0);
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        ++count[SelfCalibration::patch_of(atlas, i)];
    }
    for (const int texels : count) EXPECT_EQ(texels, 8);
}

}  // namespace
}  // namespace patina
