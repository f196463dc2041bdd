#include "patina/base/huge_pages.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace patina {
namespace {

constexpr std::size_t kMany = 64 * kHugePage;

std::byte* take(HugePages& pages, std::size_t count) {
    const HugePages::Range range = pages.take(count * kHugePage);
    EXPECT_NE(range.memory, nullptr);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(range.memory) % kHugePage, 0u);
    return range.memory;
}

TEST(HugePages, HandsOutAgainWhatWasGivenBack) {
    HugePages pages(kMany);
    std::byte* const memory = take(pages, 3);
    memory[0] = memory[3 * kHugePage - 1] = std::byte(7);
    pages.give_back(memory, 3 * kHugePage);
    EXPECT_EQ(pages.kept_bytes(), 3 * kHugePage);
    const HugePages::Range again = pages.take(3 * kHugePage);
    EXPECT_EQ(again.memory, memory);
    EXPECT_FALSE(again.is_new);
    EXPECT_EQ(again.memory[0], std::byte(7));
    EXPECT_EQ(pages.kept_bytes(), 0u);
    pages.give_back(memory, 3 * kHugePage);
}

// In whatever order the parts come back, they make one range again.
TEST(HugePages, JoinsNeighbors) {
    for (const bool middle_last : {false, true}) {
        HugePages pages(kMany);
        std::byte* const memory = take(pages, 6);
        pages.give_back(memory, 2 * kHugePage);
        if (!middle_last) pages.give_back(memory + 2 * kHugePage, 2 * kHugePage);
        pages.give_back(memory + 4 * kHugePage, 2 * kHugePage);
        if (middle_last) {
            EXPECT_TRUE(pages.take(6 * kHugePage).is_new);
            pages.give_back(memory + 2 * kHugePage, 2 * kHugePage);
        }
        const HugePages::Range whole = pages.take(6 * kHugePage);
        EXPECT_EQ(whole.memory, memory);
        EXPECT_FALSE(whole.is_new);
    }
}

// Pieces of one range that are in use at a time are different ones, and large ranges stay whole as
// long as smaller ones do.
TEST(HugePages, TakesFromTheSmallestRangeThatHoldsIt) {
    HugePages pages(kMany);
    std::byte* const memory = take(pages, 9);
    pages.give_back(memory, 6 * kHugePage);
    pages.give_back(memory + 7 * kHugePage, 2 * kHugePage);
    std::byte* const a = take(pages, 1);
    std::byte* const b = take(pages, 1);
    EXPECT_NE(a, b);
    EXPECT_GE(a, memory + 7 * kHugePage);
    EXPECT_GE(b, memory + 7 * kHugePage);
    EXPECT_EQ(take(pages, 6), memory);
}

TEST(HugePages, KeepsNoMoreThanItMay) {
    HugePages pages(4 * kHugePage);
    std::byte* const memory = take(pages, 3);
    std::byte* const other = take(pages, 2);
    pages.give_back(memory, 3 * kHugePage);
    pages.give_back(other, 2 * kHugePage);
    EXPECT_EQ(pages.kept_bytes(), 3 * kHugePage);
    EXPECT_FALSE(pages.take(3 * kHugePage).is_new);
}

TEST(HugePages, SaysThatThereIsNoMore) {
    HugePages pages(kMany);
    pages.give_back(take(pages, 1), kHugePage);
    constexpr std::size_t kTooMuch = std::size_t(1) << 62;
    EXPECT_EQ(pages.take(kTooMuch).memory, nullptr);
    EXPECT_EQ(pages.take(std::size_t(-1) / kHugePage * kHugePage).memory, nullptr);
    EXPECT_EQ(pages.kept_bytes(), 0u);
}

}  // namespace
}  // namespace patina
