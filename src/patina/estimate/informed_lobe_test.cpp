// The filled lobe and the looks together, on texels made for it.
#include "patina/estimate/informed_lobe.h"

#include "patina/base/random.h"
#include "patina/estimate/joint_fit.h"
#include "patina/math/statistics.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "support/scenes.h"
#include "support/synthetic_texel.h"
#include <cmath>
#include <vector>

namespace patina {
namespace {

constexpr std::size_t kNumLooks = 8;
const Reflectance kTruth{Rgb(0.5, 0.4, 0.3), 0.4, 0.15};
const LogLobe kOff(-0.2, 0.2);  // the filling, less the truth

Reflectance reflectance_of(const LogLobe& lobe, const JointFit& joint) {
    Reflectance result;
    result.roughness = std::exp(lobe[1]);
    result.specular = std::exp(lobe[0]) / square(result.roughness);
    result.diffuse = joint.diffuse_with(result.specular, result.roughness);
    return result;
}

// Turns until nothing moves; leaves the last evidence.
LogLobe come_to_rest(std::span<const FitRow> rows,
                     const LogLobe& filled,
                     const LobeSpread& spread,
                     LobeEvidence& evidence) {
    JointFit joint;
    joint.load(rows);
    LogLobe lobe = filled;
    for (int turn = 0; turn < 20; ++turn) {
        evidence = lobe_evidence(rows, reflectance_of(lobe, joint), filled, 1);
        lobe = informed_lobe(filled, spread, evidence);
    }
    return lobe;
}

TEST(InformedLobe, IsTheTruthWhereLooksTellIt) {
    SyntheticTexel texel(kNumLooks, 3 * kTruth.roughness);
    texel.show(kTruth);
    for (FitRow& row : texel.rows()) row.weight = Rgb::Constant(1e6);
    LobeEvidence evidence;
    const LogLobe filled = log_lobe(kTruth) + kOff;
    const LogLobe lobe = come_to_rest(texel.rows(), filled, {1, 1}, evidence);
    // The prior draws by its precision over that of the looks.
    const LogLobe drawn = informed_covariance({1, 1}, evidence.information) * kOff;
    EXPECT_LT(drawn.norm(), 0.01);
    EXPECT_LT((lobe - log_lobe(kTruth) - drawn).norm(), 0.1 * drawn.norm() + 1e-4);
}

TEST(InformedLobe, IsTheFillingWhereNoLookReachesIt) {
    SyntheticTexel texel(kNumLooks, 0);
    for (std::size_t k = 0; k < kNumLooks; ++k) texel.place_lamp(k, 8 * kTruth.roughness);
    texel.show(kTruth);
    LobeEvidence evidence;
    const LogLobe filled = log_lobe(kTruth) + kOff;
    EXPECT_LT((come_to_rest(texel.rows(), filled, {0.3, 0.1}, evidence) - filled).norm(), 1e-6);
}

TEST(InformedLobe, ErrsAsItsCovarianceSays) {
    constexpr int kTexels = 2000;
    constexpr LobeSpread kSpread = {0.05, 0.03};
    constexpr double kNoise = 0.01;
    double sum = 0;
    for (int i = 0; i < kTexels; ++i) {
        Rng rng(1, Pass::tests, std::uint64_t(i));
        // No look in the core of the lobe: filling and looks count alike.
        SyntheticTexel texel(kNumLooks, 3 * kTruth.roughness);
        for (std::size_t k = 0; k < 3; ++k)
            texel.place_lamp(k, (2 + 0.3 * double(k)) * kTruth.roughness);
        texel.show(kTruth, kNoise, 0, rng);
        const LogLobe truth = log_lobe(kTruth);
        const LogLobe filled = truth + LogLobe(kSpread.specular_albedo * rng.normal(),
                                               kSpread.roughness * rng.normal());
        LobeEvidence evidence;
        const LogLobe error = come_to_rest(texel.rows(), filled, kSpread, evidence) - truth;
        const Eigen::Matrix2d covariance = informed_covariance(kSpread, evidence.information);
        sum += error.dot(covariance.inverse() * error);
    }
    // chi^2 with two degrees of freedom has mean 2 and variance 4; false-alarm rate 1e-5.
    EXPECT_NEAR(sum / kTexels, 2, normal_quantile(1 - 0.5e-5) * std::sqrt(4.0 / kTexels));
}

TEST(InformedLobe, MeasuredLobesJudgeTheLooks) {
    constexpr LobeSpread kSpread = {0.2, 0.1};
    LobeEvidence own;
    own.information = informed_covariance(kSpread, Eigen::Matrix2d::Zero()).inverse() * 1e4;
    // The looks confirm each measured lobe.
    std::vector<LobeEvidence> judges(100, own);
    EXPECT_EQ(evidence_weight(judges, kSpread), 1);
    // They are sure of a lobe that is off by more than the filling ever is, at any weight.
    for (LobeEvidence& judge : judges) judge.pull = own.information * LogLobe(1, 0.5);
    EXPECT_EQ(evidence_weight(judges, kSpread), 0);
    // Too few to say.
    EXPECT_EQ(evidence_weight(std::vector<LobeEvidence>(10, own), kSpread), 0);
}

TEST(InformedLobe, PoolsWhatNeighboursTell) {
    constexpr int kSide = 7;
    const TexelAtlas atlas =
        build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), kSide, kSide);
    LobeEvidence own;
    own.information << 3, 1, 1, 2;
    own.pull = own.information * kOff;
    const std::size_t middle = std::size_t(kSide) * kSide / 2;
    const double degree = atlas.neighbor_begin[middle + 1] - atlas.neighbor_begin[middle];
    const auto pooled = [&](float link) {
        LargeVector<LobeEvidence> evidence(atlas.texels.size(), own);
        const std::vector<float> links(atlas.neighbors.size(), link);
        pool_evidence(atlas, links, evidence);
        return evidence[middle];
    };
    const LobeEvidence apart = pooled(0);
    EXPECT_LT((apart.information - own.information).norm(), 1e-12);
    EXPECT_LT((apart.pull - own.pull).norm(), 1e-12);
    // (1 + degree)^2 ways of two steps, 1 + degree of them back.
    const LobeEvidence joined = pooled(1);
    EXPECT_LT((joined.information - (1 + degree) * own.information).norm(), 1e-9);
    EXPECT_LT((joined.pull - joined.information * kOff).norm(), 1e-9);
}

}  // namespace
}  // namespace patina
