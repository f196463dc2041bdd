#include "patina/plan/information.h"

#include "patina/base/random.h"
#include "patina/estimate/texel_fit.h"

#include <Eigen/LU>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace patina {
namespace {

constexpr std::size_t kTexels = 40;

// Random looks at kTexels texels, up to three at each.
LookTable random_looks(std::uint64_t seed) {
    LookTable table;
    table.begin.push_back(0);
    for (std::size_t i = 0; i < kTexels; ++i) {
        Rng rng(seed, Pass::tests, i);
        const int count = int(4 * rng.uniform());
        for (int k = 0; k < count; ++k) {
            LookTerm term;
            term.irradiance = float(0.5 + 2 * rng.uniform());
            term.theta_r_squared = float(square(0.6 * rng.uniform()));
            term.lobe_cosines = float(1 + rng.uniform());
            term.is_joined = k > 0 && rng.uniform() < 0.3;
            table.terms.push_back(term);
        }
        table.begin.push_back(std::uint32_t(table.terms.size()));
    }
    return table;
}

LookNoise some_noise() { return {1e-5, 2e-5, 0.01}; }

double radiance_of(std::span<const LookTerm> terms, const Reflectance& reflectance) {
    double radiance = 0;
    for (const LookTerm& term : terms) {
        const double lobe = double(term.lobe_cosines) *
                            lobe_gaussian(double(term.theta_r_squared), reflectance.roughness);
        radiance += double(term.irradiance) / kPi *
                    (reflectance.diffuse.mean() + reflectance.specular * lobe);
    }
    return radiance;
}

TEST(LookGradients, AgreeWithDifferencesOfTheRadiance) {
    const SupposedSurface surface(SurfacePrior{});
    LookTable looks;
    looks.begin = {0, 2};
    looks.terms = {{1.5F, 0.01F, 1.2F, false}, {0.7F, 0.05F, 1.6F, true}};
    const LookGradients gradients = look_gradients(looks, surface, some_noise());
    ASSERT_EQ(gradients.rows.size(), 3U);
    constexpr double kStep = 1e-5;
    for (std::size_t k = 0; k < 3; ++k) {
        const Reflectance at = surface.of(0, k);
        const auto difference = [&](Reflectance low, Reflectance high) {
            return (radiance_of(looks.terms, high) - radiance_of(looks.terms, low)) / (2 * kStep);
        };
        std::array<Reflectance, 3> low = {at, at, at};
        std::array<Reflectance, 3> high = {at, at, at};
        low[0].diffuse -= kStep;
        high[0].diffuse += kStep;
        low[1].specular -= kStep;
        high[1].specular += kStep;
        low[2].roughness -= kStep;
        high[2].roughness += kStep;
        const double noise = std::sqrt(some_noise().variance(radiance_of(looks.terms, at)) / 3);
        for (std::size_t p = 0; p < 3; ++p) {
            const auto i = Eigen::Index(p);
            const double expected =
                difference(low[p], high[p]) * surface.prior_stddev(0, k)[i] / noise;
            // Single precision, and the differences' error of the order of kStep.
            EXPECT_NEAR(double(gradients.rows[k][i]), expected, 1e-4 * std::abs(expected) + 1e-6);
        }
    }
}

TEST(Knowledge, GainIsTheRiseOfTheLogarithmOfTheDeterminant) {
    const SupposedSurface surface(SurfacePrior{});
    const LookGradients first = look_gradients(random_looks(1), surface, some_noise());
    const LookGradients second = look_gradients(random_looks(2), surface, some_noise());
    Knowledge known(surface, kTexels);
    known.add(first);
    double expected = 0;
    for (std::size_t i = 0; i < kTexels; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            Mat3 precision = Mat3::Identity();
            const auto add = [&](const LookGradients& looks) {
                for (std::size_t look = looks.begin[i]; look < looks.begin[i + 1]; ++look) {
                    const Vec3 g = looks.rows[3 * look + k].cast<double>();
                    precision += g * g.transpose();
                }
                return std::log(precision.determinant());
            };
            const double before = add(first);
            expected += add(second) - before;
        }
    }
    EXPECT_NEAR(known.gain(second), expected / (3 * kTexels), 1e-6);
}

TEST(Knowledge, GainIsMonotoneAndSubmodular) {
    const SupposedSurface surface(SurfacePrior{});
    std::vector<LookGradients> lamps;
    for (std::uint64_t seed = 10; seed < 16; ++seed) {
        lamps.push_back(look_gradients(random_looks(seed), surface, some_noise()));
    }
    Knowledge known(surface, kTexels);
    double previous = known.gain(lamps.back());
    EXPECT_GT(previous, 0);
    for (std::size_t i = 0; i + 1 < lamps.size(); ++i) {
        known.add(lamps[i]);
        const double gain = known.gain(lamps.back());
        EXPECT_GE(gain, 0);
        EXPECT_LE(gain, previous);
        previous = gain;
    }
}

// The prior is a ten-thousandth of the information here, so errors agree to as much.
TEST(Knowledge, StandardErrorsAreThoseOfTheFit) {
    Reflectance map;
    map.diffuse = Rgb::Constant(0.4);
    map.specular = 0.3;
    map.roughness = 0.2;
    const SupposedSurface surface(SurfacePrior{}, {map});
    LookTable looks;
    looks.begin = {0, 8};
    std::vector<LampTerm> terms;
    for (int i = 0; i < 8; ++i) {
        const float theta = 0.08F * float(i);
        looks.terms.push_back({1.5F, theta * theta, 1.1F, false});
        terms.push_back({Rgbf::Constant(1.5F), theta * theta, 1.1F});
    }
    std::vector<FitRow> rows;
    for (const LampTerm& term : terms) {
        FitRow& row = rows.emplace_back();
        row.lamps = std::span(&term, 1);
        row.irradiance = term.irradiance.cast<double>();
        row.radiance = predict(row, map);
        row.weight = Rgb::Constant(1 / some_noise().variance(row.radiance.mean()));
    }
    const FitErrors errors = fit_errors(rows, map);
    Knowledge known(surface, 1);
    known.add(look_gradients(looks, surface, some_noise()));
    const ErrorSummary summary = known.errors();
    EXPECT_NEAR(summary.specular * map.specular / errors.specular, 1, 1e-3);
    EXPECT_NEAR(summary.roughness * map.roughness / errors.roughness, 1, 1e-3);
    EXPECT_EQ(known.share_known(), errors.specular <= kKnown * map.specular ? 1 : 0);
}

TEST(Knowledge, KnowsNoMoreThanThePriorWhereNothingWasSeen) {
    const SupposedSurface surface(SurfacePrior{});
    const Knowledge known(surface, 5);
    EXPECT_DOUBLE_EQ(known.errors().diffuse, 1);
    EXPECT_DOUBLE_EQ(known.errors().specular, 1);
    EXPECT_DOUBLE_EQ(known.errors().roughness, 1);
    EXPECT_EQ(known.share_known(), 0);
}

TEST(Knowledge, NeverKnowsAPsOfZeroToATenth) {
    const SupposedSurface surface(SurfacePrior{}, {Reflectance{Rgb::Constant(0.5), 0, 0.2}});
    EXPECT_TRUE(std::isinf(Knowledge(surface, 1).errors().specular));
}

}  // namespace
}  // namespace patina
