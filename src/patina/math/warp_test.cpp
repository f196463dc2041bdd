#include "patina/math/warp.h"

#include "patina/base/random.h"
#include "patina/math/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

namespace patina {
namespace {

// Of one test; there are fewer than 100 such tests in the suite, so that all together stay below
// 1e-3.
constexpr double kFalseAlarmRate = 1e-5;
constexpr int kNumSamples = 200000;
constexpr int kNumHeights = 40;
constexpr int kNumAzimuths = 16;

using Warp = std::function<Vec3(const std::array<double, 2>&)>;
// Density per solid angle of a direction with this z, about +z [1/sr].
using Density = std::function<double(double)>;

// Integral of the density over z, Simpson's rule with 1000 intervals, times 2 pi.
double probability_between(const Density& density, double z0, double z1) {
    constexpr int kNumIntervals = 1000;
    const double step = (z1 - z0) / kNumIntervals;
    double sum = density(z0) + density(z1);
    for (int i = 1; i < kNumIntervals; ++i) sum += (i % 2 == 1 ? 4 : 2) * density(z0 + i * step);
    return 2 * kPi * sum * step / 3;
}

// p-value of the samples in cells of z in [z_begin, 1] and azimuth.
double p_value(const Warp& warp, const Density& density, double z_begin) {
    std::vector<double> observed(kNumHeights * kNumAzimuths + 1, 0);
    Rng rng(11, Pass::tests, 0);
    for (int i = 0; i < kNumSamples; ++i) {
        const double u0 = rng.uniform();
        const double u1 = rng.uniform();
        const Vec3 w = warp({u0, u1});
        EXPECT_NEAR(w.norm(), 1, 1e-12);
        const double share = (w.z() - z_begin) / (1 - z_begin);
        const double turn = std::atan2(w.y(), w.x()) / (2 * kPi) + 0.5;
        if (share < 0) {
            ++observed.back();
            continue;
        }
        const int height = std::min(int(share * kNumHeights), kNumHeights - 1);
        const int azimuth = std::min(int(turn * kNumAzimuths), kNumAzimuths - 1);
        ++observed[std::size_t(height * kNumAzimuths + azimuth)];
    }
    std::vector<double> expected(observed.size(), 0);
    double total = 0;
    for (int height = 0; height < kNumHeights; ++height) {
        const double z0 = z_begin + (1 - z_begin) * height / kNumHeights;
        const double z1 = z_begin + (1 - z_begin) * (height + 1) / kNumHeights;
        const double probability = probability_between(density, z0, z1);
        total += probability;
        for (int azimuth = 0; azimuth < kNumAzimuths; ++azimuth) {
            expected[std::size_t(height * kNumAzimuths + azimuth)] =
                kNumSamples * probability / kNumAzimuths;
        }
    }
    expected.back() = std::max(0.0, kNumSamples * (1 - total));
    return chi_square_test(observed, expected).p_value;
}

TEST(CosineHemisphere, FollowsItsDensity) {
    EXPECT_GT(p_value(
                  square_to_cosine_hemisphere, [](double z) { return z / kPi; }, 0),
              kFalseAlarmRate);
}

TEST(UniformSphere, FollowsItsDensity) {
    EXPECT_GT(p_value(
                  square_to_sphere, [](double) { return 1 / (4 * kPi); }, -1),
              kFalseAlarmRate);
}

TEST(UniformSphere, IsToldFromTheCosineDensity) {
    EXPECT_LT(p_value(
                  square_to_sphere, [](double z) { return std::max(z, 0.0) / kPi; }, -1),
              kFalseAlarmRate);
}

class VonMisesFisher : public testing::TestWithParam<double> {
  protected:
    double kappa() const { return GetParam(); }
    // Beyond this the density is below exp(-30) of its peak.
    double lowest_z() const { return std::max(-1.0, 1 - 30 / kappa()); }
};

TEST_P(VonMisesFisher, FollowsItsDensity) {
    EXPECT_GT(p_value(
                  [this](const std::array<double, 2>& u) {
                      return square_to_von_mises_fisher(u, kappa());
                  },
                  [this](double z) { return von_mises_fisher_pdf(z, kappa()); },
                  lowest_z()),
              kFalseAlarmRate);
}

TEST_P(VonMisesFisher, DensityIntegratesToOne) {
    const Density density = [this](double z) { return von_mises_fisher_pdf(z, kappa()); };
    // Simpson's rule errs by (30/1000)^4/180 = 5e-9 of the integral, the cut tail by exp(-30).
    EXPECT_NEAR(probability_between(density, lowest_z(), 1), 1, 1e-7);
}

TEST_P(VonMisesFisher, StaysOnTheSphereAtTheCornersOfTheSquare) {
    const double last = 1 - 0x1p-32;
    for (const double u0 : {0.0, last}) {
        for (const double u1 : {0.0, last}) {
            EXPECT_NEAR(square_to_von_mises_fisher({u0, u1}, kappa()).norm(), 1, 1e-12);
        }
    }
}

// 1/sigma^2 for sigma of 1.4, 0.32, 0.1 and 0.01 radians.
INSTANTIATE_TEST_SUITE_P(Concentrations, VonMisesFisher, testing::Values(0.5, 10.0, 100.0, 1e4));

TEST(Frame, IsOrthonormalAndRightHandedForAnyNormal) {
    Rng rng(12, Pass::tests, 0);
    std::vector<Vec3> normals = {
        {0, 0, 1}, {0, 0, -1}, {1, 0, 0.0}, {1, 0, -0.0}, Vec3(1e-9, 0, -1).normalized()};
    for (int i = 0; i < 1000; ++i) {
        const double u0 = rng.uniform();
        normals.push_back(square_to_sphere({u0, rng.uniform()}));
    }
    for (const Vec3& normal : normals) {
        const Frame frame(normal);
        Mat3 axes;
        axes << frame.tangent, frame.bitangent, frame.normal;
        EXPECT_LT((axes.transpose() * axes - Mat3::Identity()).norm(), 1e-12) << normal.transpose();
        EXPECT_NEAR(axes.determinant(), 1, 1e-12);
        EXPECT_LT((frame.to_world(Vec3::UnitZ()) - normal).norm(), 1e-15);
    }
}

TEST(RotateAboutY, TakesForwardToTheAzimuth) {
    for (const double azimuth : {0.0, 0.3, 2.0, -4.0}) {
        const Vec3 expected(std::sin(azimuth), 0, std::cos(azimuth));
        EXPECT_LT((rotate_about_y(azimuth, Vec3::UnitZ()) - expected).norm(), 1e-15);
        EXPECT_EQ(rotate_about_y(azimuth, Vec3::UnitY()), Vec3::UnitY());
    }
}

}  // namespace
}  // namespace patina
