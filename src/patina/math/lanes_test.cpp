#include "patina/math/lanes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace patina {
namespace {

TEST(CompactFloat, RoundsToElevenBits) {
    constexpr int kSteps = 1 << 16;
    for (int i = 0; i < kSteps; ++i) {
        const auto x = float(std::exp2(-41.0 + 62.9 * i / kSteps));
        EXPECT_NEAR(double(from_compact(to_compact(x))), double(x), kCompactRounding * double(x));
    }
}

TEST(CompactFloat, GivesBackEveryNumberThatItHolds) {
    // Cuts below 2^10 have the exponent of 0, which stands for 0 alone.
    for (std::uint32_t cut = 1u << 10; cut <= 0xffffu; ++cut) {
        EXPECT_EQ(to_compact(from_compact(std::uint16_t(cut))), cut);
    }
    EXPECT_EQ(from_compact(0), 0.0f);
}

TEST(CompactFloat, HoldsWhatIsOutOfRangeAtItsEnds) {
    EXPECT_EQ(to_compact(0), 0);
    EXPECT_EQ(to_compact(0.99f * kSmallestCompact), 0);
    EXPECT_EQ(from_compact(to_compact(kSmallestCompact)), kSmallestCompact);
    EXPECT_EQ(from_compact(to_compact(kLargestCompact)), kLargestCompact);
    EXPECT_EQ(from_compact(to_compact(1e30f)), kLargestCompact);
}

TEST(CompactFloat, IsTheSameInLanes) {
    const Lanes x = {0.0f, 1e-30f, 1e-6f, 0.1f, 1.0f, 3.14159f, 1e6f, 1e30f};
    const CompactLanes compact = to_compact(x);
    const Lanes back = from_compact(compact);
    for (std::size_t l = 0; l < kLanes; ++l) {
        EXPECT_EQ(compact[l], to_compact(x[l]));
        EXPECT_EQ(back[l], from_compact(compact[l]));
    }
}

TEST(Lanes, AreAddedUpInDoublePrecision) {
    const Lanes x = {0x1p24f, 1.0f, 0x1p-20f, -3.0f, 5.0f, -0x1p23f, 0.25f, 7.0f};
    EXPECT_EQ(sum_of_lanes(x), 0x1p23 + 10.25 + 0x1p-20);
}

TEST(Lanes, HaveTheRootsOfTheirNumbers) {
    const Lanes x = {0.0f, 1.0f, 2.0f, 1e-30f, 1e30f, 0.3f, 49.0f, 12345.0f};
    const Lanes roots = square_root(x);
    for (std::size_t l = 0; l < kLanes; ++l) EXPECT_EQ(roots[l], std::sqrt(x[l])) << l;
}

TEST(LoadTransposed, PutsTheNumbersOfEightRecordsSideBySide) {
    // Records of 40 bytes in some order, read from their third number on, so that none is aligned.
    constexpr std::size_t kFirst = 2;
    std::array<std::array<float, kFirst + kLanes>, kLanes> table;
    for (std::size_t r = 0; r < kLanes; ++r) {
        for (std::size_t f = 0; f < table[r].size(); ++f) table[r][f] = float(100 * r + f);
    }
    const std::array<std::size_t, kLanes> order = {3, 0, 7, 7, 1, 2, 6, 4};
    std::array<const void*, kLanes> records;
    for (std::size_t k = 0; k < kLanes; ++k) records[k] = &table[order[k]];
    const std::array<Lanes, kLanes> fields = load_transposed(records, kFirst * sizeof(float));
    for (std::size_t f = 0; f < kLanes; ++f) {
        std::array<float, kLanes + 1> stored{};
        store_lanes(fields[f], &stored[1]);
        for (std::size_t k = 0; k < kLanes; ++k) {
            EXPECT_EQ(stored[k + 1], table[order[k]][kFirst + f]) << f << ' ' << k;
        }
    }
}

}  // namespace
}  // namespace patina
