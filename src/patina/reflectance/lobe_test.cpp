#include "patina/reflectance/lobe.h"

#include "patina/base/random.h"
#include "patina/math/warp.h"

#include <gtest/gtest.h>

#include "support/direction_sampler.h"
#include "support/false_alarms.h"
#include <optional>
#include <ostream>
#include <vector>

namespace patina {
namespace {

Vec3 direction_at(double angle, double azimuth = 0) {
    return {
        std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)};
}

// A tilted normal, so that nothing depends on the axes.
const Frame kFrame(Vec3(0.48, -0.6, 0.64));

Reflectance grey(double diffuse, double specular, double roughness) {
    return {Rgb::Constant(diffuse), specular, roughness};
}

TEST(MirrorAngle, IsExactFromZeroToPi) {
    const double sine = 0.6;
    const Vec3 n = Vec3::UnitZ();
    const Vec3 w_i(sine, 0, -0.8);  // the angle is defined below the horizon too
    const Vec3 mirror(-sine, 0, -0.8);
    const Vec3 across = Vec3::UnitY();
    for (const double angle : {1e-9, 1e-4, 0.3, 1.5, 1.6, 2.8, kPi - 1e-4, kPi - 1e-9}) {
        const Vec3 w_o = std::cos(angle) * mirror + std::sin(angle) * across;
        // The components carry a rounding of 1.1e-16 each; four of them bound the angle's error.
        EXPECT_NEAR(std::sqrt(mirror_angle_squared(n, w_i, w_o)), angle, 5e-16 * 4) << angle;
    }
}

TEST(MirrorAngle, IsSymmetricBitByBit) {
    for (std::uint64_t i = 0; i < 1000; ++i) {
        Rng rng(1, Pass::tests, i);
        const Vec3 w_i = square_to_sphere({rng.uniform(), rng.uniform()});
        const Vec3 w_o = square_to_sphere({rng.uniform(), rng.uniform()});
        EXPECT_EQ(mirror_angle_squared(kFrame.normal, w_i, w_o),
                  mirror_angle_squared(kFrame.normal, w_o, w_i));
    }
}

TEST(Evaluate, IsEquationOneOfThePaperAwayFromGrazing) {
    const Reflectance reflectance{Rgb(0.5, 0.3, 0.1), 0.8, 0.2};
    const double angle_i = radians(30);
    const double angle_o = radians(45);  // in the plane of incidence, 15 degrees off the mirror
    const Rgb f =
        evaluate(reflectance, Vec3::UnitZ(), direction_at(angle_i), direction_at(angle_o, kPi));
    const double gaussian = std::exp(-square(radians(15)) / (2 * square(0.2)));
    const double lobe = 0.8 * gaussian / (std::cos(angle_i) * std::cos(angle_o));
    const Rgb expected = (reflectance.diffuse + lobe) / kPi;
    for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(f[channel], expected[channel], 1e-14);
    }
}

TEST(Evaluate, KeepsTheFloorUnderBothCosines) {
    const double angle = std::acos(0.05);
    const Rgb f =
        evaluate(grey(0, 0.5, 0.1), Vec3::UnitZ(), direction_at(angle), direction_at(angle, kPi));
    EXPECT_NEAR(f[0], 0.5 / square(kCosineFloor) / kPi, 1e-13);
}

TEST(Evaluate, IsZeroWhereACosineIsNotPositive) {
    const Reflectance reflectance = grey(0.5, 0.5, 0.5);
    const Vec3 up = direction_at(0.5);
    const Vec3 level = Vec3::UnitX();
    const Vec3 down = direction_at(kPi - 0.5);
    for (const Vec3& w : {level, down}) {
        EXPECT_TRUE((evaluate(reflectance, Vec3::UnitZ(), w, up) == 0).all());
        EXPECT_TRUE((evaluate(reflectance, Vec3::UnitZ(), up, w) == 0).all());
    }
}

TEST(Evaluate, IsReciprocal) {
    for (std::uint64_t i = 0; i < 1000; ++i) {
        Rng rng(2, Pass::tests, i);
        const Reflectance reflectance{
            Rgb(rng.uniform(), rng.uniform(), rng.uniform()),
            rng.uniform(),
            kMinRoughness + (kMaxRoughness - kMinRoughness) * rng.uniform()};
        const Vec3 w_i =
            kFrame.to_world(square_to_cosine_hemisphere({rng.uniform(), rng.uniform()}));
        const Vec3 w_o =
            kFrame.to_world(square_to_cosine_hemisphere({rng.uniform(), rng.uniform()}));
        const Rgb forth = evaluate(reflectance, kFrame.normal, w_i, w_o);
        const Rgb back = evaluate(reflectance, kFrame.normal, w_o, w_i);
        EXPECT_LE(((forth - back).abs() / forth).maxCoeff(), 1e-12);
    }
}

TEST(LobeDerivative, AgreesWithCentralDifferences) {
    for (const double roughness : {0.02, 0.1, 0.3, 0.6}) {
        for (const double angle_in_sigmas : {0.0, 0.5, 1.0, 2.5}) {
            const double squared = square(angle_in_sigmas * roughness);
            // The step balances the third derivative (relative error step^2) against rounding.
            const double step = 1e-5 * roughness;
            const auto value = [&](double sigma) {
                return lobe_derivative(squared, 0.7, 0.1, sigma).value;
            };
            const double difference =
                (value(roughness + step) - value(roughness - step)) / (2 * step);
            const double scale = value(roughness) / roughness;
            EXPECT_NEAR(lobe_derivative(squared, 0.7, 0.1, roughness).by_roughness,
                        difference,
                        1e-8 * scale);
        }
    }
}

TEST(LobeDerivative, HasTheValueOfEvaluate) {
    const Vec3 w_i = direction_at(0.9);
    const Vec3 w_o = direction_at(0.7, 3.0);
    const double squared = mirror_angle_squared(Vec3::UnitZ(), w_i, w_o);
    EXPECT_NEAR(lobe_derivative(squared, w_i.z(), w_o.z(), 0.25).value,
                evaluate(grey(0, 1, 0.25), Vec3::UnitZ(), w_i, w_o)[0],
                1e-14);
}

TEST(ProjectToFeasible, BringsEveryDirectionalAlbedoBelowTheBound) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(3, Pass::tests, i);
        const Reflectance wild{
            Rgb(rng.normal(), rng.normal(), rng.normal()), 5 * rng.normal(), rng.normal()};
        const Projection projection = project_to_feasible(wild);
        const Reflectance& r = projection.reflectance;
        EXPECT_GE(r.diffuse.minCoeff(), 0);
        EXPECT_GE(r.specular, 0);
        EXPECT_GE(r.roughness, kMinRoughness);
        EXPECT_LE(r.roughness, kMaxRoughness);
        const double albedo = r.specular * lobe_albedo(rng.uniform(), r.roughness);
        EXPECT_LE(r.diffuse.maxCoeff() + r.specular * max_lobe_albedo(r.roughness), kMaxAlbedo);
        // The interpolation error of the table, once for the maximum and once for the value.
        const double table_error = 2 * 3e-5 * 2 * square(r.roughness) / kCosineFloor * r.specular;
        EXPECT_LE(r.diffuse.maxCoeff() + albedo, kMaxAlbedo + table_error);
    }
}

TEST(ProjectToFeasible, LeavesFeasibleValuesAlone) {
    const Reflectance feasible{Rgb(0.5, 0.2, 0.1), 0.4, 0.1};
    EXPECT_FALSE(project_to_feasible(feasible).was_clamped);
    const Projection once = project_to_feasible(grey(0.9, 4, 0.3));
    EXPECT_TRUE(once.was_clamped);
    EXPECT_FALSE(project_to_feasible(once.reflectance).was_clamped);
}

TEST(ProjectToFeasible, ScalesBothAlbedosByOneFactor) {
    const Projection projection = project_to_feasible({Rgb(0.9, 0.6, 0.3), 4, 0.3});
    const double factor = projection.reflectance.specular / 4;
    EXPECT_LT(factor, 1);
    EXPECT_NEAR(projection.reflectance.diffuse[0], 0.9 * factor, 1e-15);
    EXPECT_NEAR(projection.reflectance.diffuse[2], 0.3 * factor, 1e-15);
}

struct SamplerCase {
    double diffuse;
    double specular;
    double roughness;
    double angle_degrees;
};

void PrintTo(const SamplerCase& c, std::ostream* out) {
    *out << "Pd " << c.diffuse << ", Ps " << c.specular << ", sigma " << c.roughness << ", "
         << c.angle_degrees << " degrees";
}

class SampleLobe : public testing::TestWithParam<SamplerCase> {
  protected:
    const Reflectance reflectance_ =
        grey(GetParam().diffuse, GetParam().specular, GetParam().roughness);
    const double angle_ = radians(GetParam().angle_degrees);
    const Vec3 n_ = kFrame.normal;
    const Vec3 w_i_ = kFrame.to_world(direction_at(angle_, 1.0));

    [[nodiscard]] LobeSample draw(Rng& rng) const {
        const double choice = rng.uniform();
        const double u = rng.uniform();
        return sample_lobe(reflectance_, n_, w_i_, choice, {u, rng.uniform()});
    }
    [[nodiscard]] DirectionSampler sampler() const {
        return {2 * n_.dot(w_i_) * n_ - w_i_,
                [this](Rng& rng) -> std::optional<Vec3> {
                    const LobeSample sample = draw(rng);
                    return sample.pdf > 0 ? std::optional<Vec3>(sample.w_o) : std::nullopt;
                },
                [this](const Vec3& w) { return sample_lobe_pdf(reflectance_, n_, w_i_, w); }};
    }
};

TEST_P(SampleLobe, FollowsItsDensity) {
    constexpr int kNumSamples = 100000;
    const DirectionSamplerTest test = test_direction_sampler(sampler(), kNumSamples, 4);
    EXPECT_GE(test.chi_square.p_value, kComparisonLevel)
        << "statistic " << test.chi_square.statistic << " for "
        << test.chi_square.degrees_of_freedom << " degrees of freedom";
    // The density falls short of 1 by what is lost below the horizon. Midpoints miss up to one
    // percent of the cells that the horizon cuts, which hold a tenth of the mass at most.
    constexpr double kQuadratureError = 1e-3;
    EXPECT_LE(test.pdf_integral, 1 + kQuadratureError);
    const double lost = 1 - test.pdf_integral;
    const double deviation =
        std::sqrt(std::max(lost * (1 - lost), 1.0 / kNumSamples) / kNumSamples);
    EXPECT_NEAR(test.lost_share, lost, normal_threshold() * deviation + kQuadratureError);
}

TEST_P(SampleLobe, ReturnsTheDensityAndWeightOfItsDirection) {
    for (std::uint64_t i = 0; i < 1000; ++i) {
        Rng rng(5, Pass::tests, i);
        const LobeSample sample = draw(rng);
        if (sample.pdf == 0) {
            EXPECT_TRUE((sample.weight == 0).all());
            continue;
        }
        EXPECT_NEAR(sample.w_o.norm(), 1, 1e-12);
        EXPECT_NEAR(sample.pdf / sample_lobe_pdf(reflectance_, n_, w_i_, sample.w_o), 1, 1e-12);
        const Rgb expected =
            evaluate(reflectance_, n_, w_i_, sample.w_o) * n_.dot(sample.w_o) / sample.pdf;
        EXPECT_LE((sample.weight - expected).abs().maxCoeff(), 1e-12);
    }
}

TEST_P(SampleLobe, HasWeightsThatAreBoundedAndAverageToTheAlbedo) {
    constexpr int kNumSamples = 100000;
    const double cos_i = n_.dot(w_i_);
    const double lobe_energy =
        2 * square(reflectance_.roughness) / std::max(cos_i, kCosineFloor) * reflectance_.specular;
    const double bound = reflectance_.diffuse[0] + lobe_energy;
    std::vector<double> weights;
    for (std::uint64_t i = 0; i < kNumSamples; ++i) {
        Rng rng(6, Pass::tests, i);
        weights.push_back(draw(rng).weight[0]);
        ASSERT_LE(weights.back(), bound * (1 + 1e-12));
    }
    const double albedo = reflectance_.diffuse[0] +
                          reflectance_.specular * lobe_albedo(cos_i, reflectance_.roughness);
    // The table's error, and the rounding of a sum of that many numbers.
    const double bias = 3e-5 * lobe_energy + kNumSamples * 2.2e-16;
    EXPECT_TRUE(agrees(estimate_of(weights), albedo, bias));
}

INSTANTIATE_TEST_SUITE_P(Materials,
                         SampleLobe,
                         testing::Values(SamplerCase{0.7, 0, 0.2, 40},
                                         SamplerCase{0, 5, 0.05, 20},
                                         SamplerCase{0.3, 1, 0.1, 60},
                                         SamplerCase{0.5, 0.5, 0.2, 0},
                                         SamplerCase{0.2, 1, 0.3, 80},
                                         SamplerCase{0.1, 0.3, 0.6, 89}));

TEST(SampleLobe, LosesEverySampleOfALightBehindTheSurface) {
    const LobeSample sample =
        sample_lobe(grey(0.5, 0.5, 0.2), Vec3::UnitZ(), -Vec3::UnitZ(), 0.5, {0.3, 0.3});
    EXPECT_EQ(sample.pdf, 0);
    EXPECT_TRUE((sample.weight == 0).all());
}

}  // namespace
}  // namespace patina
