#include "patina/base/piece_store.h"

#include <gtest/gtest.h>

#include <numeric>
#include <span>
#include <vector>

namespace patina {
namespace {

// Through several pieces, one of them larger than pieces are.
TEST(PieceStore, WhatWasTakenStaysWhereItIs) {
    PieceStore<int> store;
    std::vector<std::span<int>> taken;
    int next = 0;
    for (const std::size_t count : {1000u, 0u, 700'000u, 600'000u, 3'000'000u, 5u}) {
        taken.push_back(store.take(count));
        ASSERT_EQ(taken.back().size(), count);
        std::iota(taken.back().begin(), taken.back().end(), next);
        next += int(count);
    }
    int expected = 0;
    for (const std::span<int> values : taken) {
        for (const int value : values) ASSERT_EQ(value, expected++);
    }
    EXPECT_EQ(expected, next);
}

}  // namespace
}  // namespace patina
