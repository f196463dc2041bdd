// The fit in lanes against the plain one of texel_fit.h, which has tests of its own.
#include "patina/estimate/joint_fit.h"

#include <gtest/gtest.h>

#include "support/synthetic_texel.h"
#include <array>
#include <cmath>
#include <vector>

namespace patina {
namespace {

const Reflectance kTruth{Rgb(0.6, 0.4, 0.3), 0.4, 0.15};
// Single precision: about a hundred sums of 2^-24 each.
constexpr double kFloat = 1e-5;
// The search of sigma ends within 1e-4 of its logarithm or a hundredth of its standard error, and
// the plain one within 5e-4.
constexpr double kSearch = 1e-3;

void expect_same(const Reflectance& a, const Reflectance& b, double tolerance) {
    for (Eigen::Index c = 0; c < 3; ++c) {
        EXPECT_NEAR(a.diffuse[c], b.diffuse[c], tolerance * b.diffuse[c]) << c;
    }
    EXPECT_NEAR(a.specular, b.specular, tolerance * b.specular);
    EXPECT_NEAR(a.roughness, b.roughness, tolerance * b.roughness);
}

TEST(JointFit, RecoversAllFromAnyStart) {
    for (const std::size_t num_looks : {6u, 8u, 13u, 24u}) {
        SyntheticTexel texel(num_looks, 0.7);
        texel.show(kTruth);
        JointFit fit;
        fit.load(texel.rows());
        for (const double start : {0.0, 0.05, 0.149, 0.3}) {
            expect_same(fit.solve({}, start), kTruth, kSearch);
        }
    }
}

TEST(JointFit, IsThePlainFitUnderNoise) {
    SyntheticTexel texel(11, 0.7);
    JointFit fit;
    for (std::uint64_t i = 0; i < 50; ++i) {
        Rng rng(11, Pass::tests, i);
        texel.show(kTruth, 0.01, 0.002, rng);
        for (FitRow& row : texel.rows()) {
            row.irradiance_variance = (0.02 * row.irradiance).square();
        }
        fit.load(texel.rows());
        expect_same(fit.solve({}, 0), fit_jointly(texel.rows(), {}), 2 * kSearch);
    }
}

// What is found is where the search stays: else maps would wander from turn to turn.
TEST(JointFit, StaysWhereItCameToRest) {
    SyntheticTexel texel(11, 0.4);
    JointFit fit;
    for (std::uint64_t i = 0; i < 50; ++i) {
        Rng rng(12, Pass::tests, i);
        texel.show(kTruth, 0.03, 0.01, rng);
        fit.load(texel.rows());
        const Reflectance found = fit.solve({}, 0);
        expect_same(fit.solve({}, found.roughness), found, kSearch);
        expect_same(fit.solve({}, 1.2 * found.roughness), found, 2 * kSearch);
    }
}

// Lobes that follow small changes of the light find the nearest minimum, and do not leap to one
// that lies far away.
TEST(JointFit, FollowsWhatIsNearAndNothingElse) {
    SyntheticTexel texel(11, 0.4);
    texel.show(kTruth);
    JointFit fit;
    fit.load(texel.rows());
    expect_same(fit.follow({}, 1.1 * kTruth.roughness), kTruth, 2 * kSearch);
    for (const double far : {0.4 * kTruth.roughness, 2.5 * kTruth.roughness}) {
        EXPECT_EQ(fit.follow({}, far).roughness, far);
        expect_same(fit.follow({}, far), fit.solve_at(far), 1e-12);
    }
}

TEST(JointFit, WidensTheLobeByTheFootprintAsThePlainPredictionDoes) {
    SyntheticTexel texel(10, 0.5);
    texel.spread(0.004f, 0.001f);
    texel.show(kTruth);
    JointFit fit;
    fit.load(texel.rows());
    expect_same(fit.solve({}, 0), kTruth, kSearch);
}

TEST(JointFit, SeesIndirectLightThroughTheLobeAsThePlainPredictionDoes) {
    SyntheticTexel texel(9, 0.7);
    for (FitRow& row : texel.rows()) {
        row.indirect_lobe = {
            Rgbf(0.5f, 0.6f, 0.7f), Rgbf(0.4f, 0.5f, 0.6f), Rgbf(0.2f, 0.3f, 0.4f)};
        row.indirect_roughness = 0.2;
    }
    const std::array<Reflectance, 3> shown = {Reflectance{kTruth.diffuse, 0.4, 0.13},
                                              {kTruth.diffuse, 0.4, 0.2},
                                              {kTruth.diffuse, 0.4, 0.5}};
    for (const Reflectance& truth : shown) {
        texel.show(truth);
        JointFit fit;
        fit.load(texel.rows());
        std::vector<double> misfits;
        fit.misfits(truth, misfits);
        for (std::size_t k = 0; k < misfits.size(); ++k) {
            // Residuals of single precision, at weights of one.
            EXPECT_LT(misfits[k], square(kFloat * texel.rows()[k].radiance.maxCoeff())) << k;
        }
        EXPECT_NEAR(fit.solve_at(truth.roughness).specular, truth.specular, 100 * kFloat);
    }
}

TEST(JointFit, AddsUpTheLampsOfOneLook) {
    SyntheticTexel texel(10, 0.7);
    const std::span<FitRow> rows = texel.rows();
    std::array<LampTerm, 2> both = {rows[0].lamps[0], rows[1].lamps[0]};
    rows[0].lamps = both;
    rows[0].irradiance += rows[1].irradiance;
    texel.show(kTruth);
    JointFit fit;
    fit.load(rows);
    expect_same(fit.solve({}, 0), kTruth, kSearch);
}

TEST(JointFit, FitsPdToALobeThatIsGiven) {
    SyntheticTexel texel(7, 0.7);
    texel.show(kTruth);
    JointFit fit;
    fit.load(texel.rows());
    const Rgb diffuse = fit.diffuse_with(kTruth.specular, kTruth.roughness);
    for (Eigen::Index c = 0; c < 3; ++c) EXPECT_NEAR(diffuse[c], kTruth.diffuse[c], 10 * kFloat);
    // A lobe that is too strong leaves less for Pd, never less than nothing.
    EXPECT_LT(fit.diffuse_with(2 * kTruth.specular, kTruth.roughness)[0], kTruth.diffuse[0]);
    EXPECT_EQ(fit.diffuse_with(1000, kTruth.roughness)[0], 0);
}

TEST(JointFit, KnowsNothingWithoutLight) {
    SyntheticTexel texel(4, 0.7);
    for (FitRow& row : texel.rows()) {
        row.irradiance = Rgb::Zero();
        row.lamps = {};
    }
    JointFit fit;
    fit.load(texel.rows());
    const Reflectance none = fit.solve({}, 0);
    EXPECT_TRUE((none.diffuse == 0).all());
    EXPECT_EQ(none.specular, 0);
}

}  // namespace
}  // namespace patina
