#include "patina/math/lane_math.h"

#include <gtest/gtest.h>

#include <limits>

namespace patina {
namespace {

constexpr int kSteps = 1 << 16;
constexpr double kEpsilon = std::numeric_limits<float>::epsilon();

TEST(UnitFromBits, CoversTheHalfOpenUnitInterval) {
    EXPECT_EQ(unit_from_bits(0), 0.0f);
    EXPECT_EQ(unit_from_bits(0x80000000u), 0.5f);
    EXPECT_EQ(unit_from_bits(0xffffffffu), 1 - float(kEpsilon) / 2);
}

// Six roundings, each half a unit in the last place of a term no larger than the sum.
TEST(LaneLog, IsTheLogarithmToAFewRoundings) {
    for (int i = 0; i < kSteps; ++i) {
        const auto x = float(std::exp2(-40.0 + 60.0 * i / kSteps));
        const double expected = std::log(double(x));
        EXPECT_NEAR(double(lane_log(x)), expected, 3 * kEpsilon * std::abs(expected)) << x;
    }
}

TEST(LaneSinCos, AreSineAndCosineOfTheWholeTurn) {
    for (int i = 0; i <= kSteps; ++i) {
        const float turn = float(i) / kSteps;
        const SinCos result = lane_sin_cos(turn);
        const double angle = 2 * std::numbers::pi * double(turn);
        EXPECT_NEAR(double(result.sin), std::sin(angle), 3e-7) << turn;
        EXPECT_NEAR(double(result.cos), std::cos(angle), 3e-7) << turn;
    }
}

TEST(AngleOfChordSquared, IsTwiceTheArcSineOfHalfTheChord) {
    for (int i = 1; i <= kSteps; ++i) {
        const float chord_squared = 2 * float(i) / kSteps;
        const double expected = 2 * std::asin(0.5 * std::sqrt(double(chord_squared)));
        EXPECT_NEAR(double(angle_of_chord_squared(chord_squared)), expected, 4e-7 * expected);
    }
}

TEST(AngleOfChordSquared, ReachesToPi) {
    for (int i = 0; i <= kSteps; ++i) {
        const float chord_squared = 2 + 2 * float(i) / kSteps;
        const double expected = 2 * std::asin(0.5 * std::sqrt(double(chord_squared)));
        EXPECT_NEAR(double(angle_of_chord_squared(chord_squared)), expected, 1e-3);
    }
    // Rounding may leave the chord of opposite vectors a little longer than 2.
    EXPECT_EQ(angle_of_chord_squared(4.000001f), std::numbers::pi_v<float>);
}

}  // namespace
}  // namespace patina
