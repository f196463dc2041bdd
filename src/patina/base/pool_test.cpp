#include "patina/base/pool.h"

#include "patina/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

namespace patina {
namespace {

struct Counter {
    std::atomic<int> users = 0;
};

TEST(Pool, LendsAnObjectToOneBlockAtATime) {
    std::atomic<int> made = 0;
    std::atomic<int> uses = 0;
    Pool<Counter> pool([&] {
        ++made;
        return std::make_unique<Counter>();
    });
    constexpr int kBlocks = 1000;
    const ThreadLimit limit(4);
    parallel_for(
        std::size_t(kBlocks),
        [&](std::size_t) {
            pool.lend([&](Counter& counter) {
                EXPECT_EQ(counter.users++, 0);
                --counter.users;
                ++uses;
            });
        },
        1);
    EXPECT_EQ(uses, kBlocks);
    EXPECT_GE(made, 1);
    EXPECT_LE(made, 4);
}

TEST(Pool, MakesAnotherWhereWorkThrew) {
    int made = 0;
    Pool<Counter> pool([&] {
        ++made;
        return std::make_unique<Counter>();
    });
    EXPECT_THROW(pool.lend([](Counter&) { throw std::runtime_error("no"); }), std::runtime_error);
    pool.lend([](Counter& counter) { EXPECT_EQ(counter.users, 0); });
    pool.lend([](Counter&) {});
    EXPECT_EQ(made, 2);
}

}  // namespace
}  // namespace patina
