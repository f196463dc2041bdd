#include "patina/estimate/texel_table.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace patina {
namespace {

struct Pair {
    int first = 7;
    int second = 0;
};

TEST(TexelTable, HoldsARowForEveryTexel) {
    TexelTable<Pair> table;
    EXPECT_TRUE(table.empty());
    table.reset(5, 3);
    EXPECT_FALSE(table.empty());
    EXPECT_EQ(table.columns(), 3U);
    for (std::size_t texel = 0; texel < 5; ++texel) {
        ASSERT_EQ(table.of(texel).size(), 3U);
        for (std::size_t i = 0; i < 3; ++i) table.of(texel)[i].second = int(10 * texel + i);
    }
    for (std::size_t texel = 0; texel < 5; ++texel) {
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(table.of(texel)[i].second, int(10 * texel + i));
            EXPECT_EQ(table.of(texel)[i].first, 7);
        }
    }
}

TEST(TexelTable, ForgetsWhatItHeld) {
    TexelTable<Pair> table;
    table.reset(100, 4);
    for (std::size_t texel = 0; texel < 100; ++texel) {
        std::ranges::fill(table.of(texel), Pair{1, 1});
    }
    table.reset(50, 6);
    for (std::size_t texel = 0; texel < 50; ++texel) {
        for (const Pair& pair : table.of(texel)) {
            EXPECT_EQ(pair.first, 7);
            EXPECT_EQ(pair.second, 0);
        }
    }
    table.reset(50, 0);
    EXPECT_TRUE(table.empty());
}

}  // namespace
}  // namespace patina
