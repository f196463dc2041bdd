#include "patina/reflectance/albedo_table.h"

#include "patina/reflectance/lobe.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

// The albedo of f itself for Ps = 1, by midpoints over circles about the mirror direction.
double brute_force_albedo(double cos_i, double roughness) {
    constexpr int kNumCircles = 1500;
    constexpr int kNumAzimuths = 1500;
    const Vec3 w_i(std::sqrt(1 - square(cos_i)), 0, cos_i);
    const Vec3 mirror(-w_i.x(), 0, cos_i);
    const Vec3 across = mirror.cross(Vec3::UnitY());
    const double reach = std::min(kPi, 9 * roughness);
    double sum = 0;
    for (int i = 0; i < kNumCircles; ++i) {
        const double theta = reach * (i + 0.5) / kNumCircles;
        double circle = 0;
        for (int j = 0; j < kNumAzimuths; ++j) {
            const double phi = kPi * (j + 0.5) / kNumAzimuths;
            const Vec3 w_o =
                std::cos(theta) * mirror +
                std::sin(theta) * (std::cos(phi) * across + std::sin(phi) * Vec3::UnitY());
            if (w_o.z() > 0) circle += w_o.z() * lobe_cosines(cos_i, w_o.z());
        }
        sum += circle * lobe_gaussian(square(theta), roughness) * std::sin(theta);
    }
    return sum * 2 * reach / (kNumCircles * kNumAzimuths);
}

TEST(AlbedoTable, AgreesWithBruteForceIntegration) {
    struct Case {
        double cos_i;
        double roughness;
    };
    for (const Case& c : {Case{1, 0.1}, Case{0.3, 0.02}, Case{0.1, 0.2}, Case{0.02, 0.6}}) {
        // 3e-5 is the table's stated error; midpoints of this spacing are good to 1e-5.
        const double scale = 2 * square(c.roughness) / std::max(c.cos_i, kCosineFloor);
        EXPECT_NEAR(lobe_albedo(c.cos_i, c.roughness),
                    brute_force_albedo(c.cos_i, c.roughness),
                    (3e-5 + 1e-5) * scale)
            << c.cos_i << " " << c.roughness;
    }
}

TEST(AlbedoTable, InterpolatesTheQuadratureToItsStatedError) {
    constexpr int kNumElevations = 331;
    constexpr int kNumRoughnesses = 17;
    for (int i = 0; i < kNumElevations; ++i) {
        const double elevation = 0.5 * kPi * (i + 0.5) / kNumElevations;
        for (int j = 0; j < kNumRoughnesses; ++j) {
            const double roughness = kMinRoughness * std::pow(kMaxRoughness / kMinRoughness,
                                                              (j + 0.5) / kNumRoughnesses);
            EXPECT_NEAR(albedo_table().relative(std::sin(elevation), roughness),
                        relative_albedo_by_quadrature(elevation, roughness),
                        3e-5);
        }
    }
}

TEST(AlbedoTable, HasTheSmallAngleLimitAtNormalIncidence) {
    // A = int exp(-t^2/(2 s^2)) sin(t) 2 dt = 2 s^2 (1 - s^2/3 + s^4/15 - ...) while the lobe stays
    // clear of the floor; the next term of the series is below s^6/105.
    for (const double sigma : {0.02, 0.05, 0.1, 0.2}) {
        const double s2 = square(sigma);
        const double series = 2 * s2 * (1 - s2 / 3 + square(s2) / 15);
        // At sigma = 0.2 the floor (at 78 degrees, 6.8 sigma) cuts off e^-23.
        EXPECT_NEAR(lobe_albedo(1, sigma), series, 2 * s2 * (3e-5 + s2 * s2 * s2 / 105));
    }
}

TEST(AlbedoTable, MaximumIsNeverExceededAndIsReached) {
    constexpr int kNumCosines = 4000;  // c0 is one of them: the albedo has its peak, a cusp, there
    for (const double roughness : {0.02, 0.037, 0.1, 0.25, 0.6}) {
        double largest = 0;
        for (int i = 1; i <= kNumCosines; ++i) {
            largest = std::max(largest, lobe_albedo(double(i) / kNumCosines, roughness));
        }
        // The stated error for either of the two.
        const double error = 2 * 3e-5 * 2 * square(roughness) / kCosineFloor;
        EXPECT_NEAR(max_lobe_albedo(roughness), largest, error) << roughness;
    }
}

TEST(AlbedoTable, KeepsTheRatioOfItsEndsOutsideItsRange) {
    EXPECT_NEAR(
        lobe_albedo(0.5, 0.01) / square(0.01), lobe_albedo(0.5, 0.02) / square(0.02), 1e-12);
    EXPECT_EQ(lobe_albedo(0, 0.1), 0);
    EXPECT_EQ(lobe_albedo(-0.5, 0.1), 0);
}

}  // namespace
}  // namespace patina
