#include "patina/base/large_vector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

namespace patina {
namespace {

struct alignas(64) Line {
    double value[8];
};

TEST(LargeVector, HoldsAndAlignsSmallAndHugeOnes) {
    for (const std::size_t count : {1u, 1000u, 100'000u, 300'000u}) {
        LargeVector<Line> lines(count, Line{});
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(lines.data()) % 64, 0u);
        for (std::size_t i = 0; i < count; ++i) lines[i].value[7] = double(i);
        const LargeVector<Line> copy = lines;
        lines.clear();
        lines.shrink_to_fit();
        EXPECT_EQ(copy.size(), count);
        EXPECT_EQ(copy.back().value[7], double(count - 1));
        EXPECT_EQ(copy.back().value[0], 0);
    }
}

// Aligned by chance, one of many would not be.
TEST(LargeVector, AlignsElementsThatAskForMore) {
    struct alignas(256) Wide {
        char value[256];
    };
    std::vector<LargeVector<Wide>> all(20);
    std::vector<LargeVector<char>> between(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i].resize(i + 1);
        between[i].resize(64);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(all[i].data()) % 256, 0u);
    }
}

TEST(LargeVector, GrowsAndMoves) {
    LargeVector<int> numbers;
    for (int i = 0; i < 1'000'000; ++i) numbers.push_back(i);
    const LargeVector<int> moved = std::move(numbers);
    EXPECT_EQ(std::accumulate(moved.begin(), moved.end(), std::int64_t(0)), 499'999'500'000);
    EXPECT_THAT(LargeVector<int>(), testing::IsEmpty());
}

TEST(LargeVector, RefusesWhatNoMemoryHolds) {
    EXPECT_THROW((void)LargeAllocator<Line>().allocate(std::size_t(-1) / 8), std::bad_alloc);
    EXPECT_THROW((void)allocate_large(std::size_t(-1) - 1, 64), std::bad_alloc);
}

}  // namespace
}  // namespace patina
