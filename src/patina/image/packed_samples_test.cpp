#include "patina/image/packed_samples.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace patina {
namespace {

using testing::ElementsAre;

float float_of(std::uint16_t half) {
    std::vector<std::uint8_t> bytes(sizeof(half));
    std::memcpy(bytes.data(), &half, sizeof(half));
    float value = 0;
    unpack_samples(bytes.data(), {16, true}, {&value, 1});
    return value;
}

// By the definition of the format: sign, five bits of exponent, ten of fraction.
TEST(PackedSamples, EveryHalfIsTheFloatOfItsValue) {
    for (std::uint32_t bits = 0; bits <= std::numeric_limits<std::uint16_t>::max(); ++bits) {
        const int exponent = static_cast<int>(bits >> 10 & 31);
        const int fraction = static_cast<int>(bits & 1023);
        const float value = float_of(static_cast<std::uint16_t>(bits));
        ASSERT_EQ(std::signbit(value), (bits & 0x8000) != 0) << bits;
        if (exponent == 31) {
            ASSERT_TRUE(fraction == 0 ? std::isinf(value) : std::isnan(value)) << bits;
        } else {
            const float expected = exponent == 0
                                       ? std::ldexp(float(fraction), -24)
                                       : std::ldexp(float(1024 + fraction), exponent - 25);
            ASSERT_EQ(std::abs(value), expected) << bits;
        }
    }
}

TEST(PackedSamples, IntegersOfFewBitsAreStretchedToWhite) {
    std::vector<float> row(3);
    const std::vector<std::uint8_t> bytes = {0b11'01'00'00};
    unpack_samples(bytes.data(), {2, false}, row);
    EXPECT_THAT(row, ElementsAre(255, 85, 0));
    const std::vector<std::uint8_t> wide = {0b11111111, 0b11'000000, 0b0000'0000, 0b000001'00};
    unpack_samples(wide.data(), {10, false}, row);
    EXPECT_THAT(row, ElementsAre(65535, 0, 64));
}

TEST(PackedSamples, IndicesAreLeftAsTheyAre) {
    std::vector<float> row(4);
    const std::vector<std::uint8_t> bytes = {0b11'01'00'10};
    unpack_indices(bytes.data(), 2, row);
    EXPECT_THAT(row, ElementsAre(3, 1, 0, 2));
}

}  // namespace
}  // namespace patina
