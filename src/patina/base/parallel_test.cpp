#include "patina/base/parallel.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <stdexcept>

namespace patina {
namespace {

// Terms of very different size, so that the order of additions shows in the last bits.
double uneven_term(std::size_t i) { return 1.0 / (1.0 + static_cast<double>((i * 7919) % 100003)); }

TEST(ParallelFor, VisitsEveryIndexOnce) {
    constexpr std::size_t kCount = 10007;
    for (const std::size_t grain : {std::size_t{1}, std::size_t{256}, kCount, 2 * kCount}) {
        std::vector<int> visits(kCount, 0);
        parallel_for(
            kCount, [&](std::size_t i) { ++visits[i]; }, grain);
        EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), std::ptrdiff_t(kCount)) << grain;
    }
}

TEST(ParallelFor, DoesNothingForNoElements) {
    bool called = false;
    parallel_for(0, [&](std::size_t) { called = true; });
    EXPECT_FALSE(called);
}

TEST(ParallelFor, PassesExceptionsOn) {
    EXPECT_THROW(parallel_for(1000,
                              [](std::size_t i) {
                                  if (i == 777) throw std::runtime_error("of the body");
                              }),
                 std::runtime_error);
}

TEST(OrderedReduce, GivesTheSameBytesForAnyNumberOfThreads) {
    constexpr std::size_t kCount = 10 * kParallelBlock + 17;
    std::uint64_t bits_of_one = 0;
    {
        const ThreadLimit limit(1);
        bits_of_one = std::bit_cast<std::uint64_t>(ordered_reduce(kCount, 0.0, uneven_term));
    }
    for (const int threads : {2, 3, 8}) {
        const ThreadLimit limit(threads);
        EXPECT_EQ(std::bit_cast<std::uint64_t>(ordered_reduce(kCount, 0.0, uneven_term)),
                  bits_of_one)
            << threads;
    }
}

TEST(OrderedReduce, AddsBlocksInOrder) {
    constexpr std::size_t kCount = 3 * kParallelBlock + 5;
    double expected = 0;
    for (std::size_t begin = 0; begin < kCount; begin += kParallelBlock) {
        double block = 0;
        for (std::size_t i = begin; i < std::min(kCount, begin + kParallelBlock); ++i) {
            block += uneven_term(i);
        }
        expected += block;
    }
    EXPECT_EQ(ordered_reduce(kCount, 0.0, uneven_term), expected);
}

TEST(BesideWork, IsDoneWhenItWasWaitedFor) {
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        int result = 0;
        BesideWork work([&result] { result = 7; });
        if (threads == 1) {
            EXPECT_EQ(result, 7);
        }
        // The caller's own loops go on meanwhile.
        EXPECT_EQ(ordered_reduce(100000, 0.0, [](std::size_t) { return 1.0; }), 100000) << threads;
        work.wait();
        EXPECT_EQ(result, 7) << threads;
    }
}

TEST(BesideWork, IsDoneWhereNobodyWaits) {
    int result = 0;
    {
        const BesideWork work([&result] { result = 7; });
    }
    EXPECT_EQ(result, 7);
}

TEST(BesideWork, PassesItsExceptionToThoseWhoWait) {
    const auto fail = [] { throw std::runtime_error("of the work"); };
    BesideWork waited(fail);
    EXPECT_THROW(waited.wait(), std::runtime_error);
    EXPECT_NO_THROW(waited.wait());
    const BesideWork not_waited(fail);
}

TEST(ThreadLimit, HoldsWhileItLives) {
    const int before = thread_count();
    {
        const ThreadLimit limit(1);
        EXPECT_EQ(thread_count(), 1);
    }
    EXPECT_EQ(thread_count(), before);
}

}  // namespace
}  // namespace patina
