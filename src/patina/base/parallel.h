// Parallel loops whose results do not depend on the number of threads.
//
// The body writes slot i and nothing else. Sums over all elements go through ordered_reduce(),
// which adds fixed blocks in block order. Threads come from oneTBB, which only parallel.cpp
// includes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace patina {

// Elements per block of ordered_reduce() and of the default grain. Part of the result's bytes: the
// block borders decide the order of additions, so this never depends on the number of threads.
inline constexpr std::size_t kParallelBlock = 4096;

// Limits the threads of every loop while it lives. count <= 0: all that the machine has.
class ThreadLimit {
  public:
    explicit ThreadLimit(int count);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// How many threads loops use now.
[[nodiscard]] int thread_count();

// Calls body(begin, end) for consecutive blocks of at most `grain` elements that cover [0, count).
// Throws Interrupted when the user asked to stop; an exception of the body is passed on.
void parallel_blocks(std::size_t count,
                     std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body);

// Calls body(i) for every i in [0, count). grain: elements handed to a thread at once.
template <typename Body>
void parallel_for(std::size_t count, const Body& body, std::size_t grain = 256) {
    parallel_blocks(count, grain, [&body](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) body(i);
    });
}

// Sum of term(i) over [0, count): each fixed block by one thread, then the blocks in order.
template <typename Value, typename Term>
[[nodiscard]] Value ordered_reduce(std::size_t count, const Value& zero, const Term& term) {
    const std::size_t num_blocks = (count + kParallelBlock - 1) / kParallelBlock;
    std::vector<Value> blocks(num_blocks, zero);
    parallel_for(
        num_blocks,
        [&](std::size_t block) {
            Value sum = zero;
            const std::size_t end = std::min(count, (block + 1) * kParallelBlock);
            for (std::size_t i = block * kParallelBlock; i < end; ++i) sum += term(i);
            blocks[block] = sum;
        },
        1);
    Value total = zero;
    for (const Value& block : blocks) total += block;
    return total;
}

// Work that goes on beside the caller's, on a thread of the loops that has nothing else to do, or
// by whoever waits for it. Where loops have one thread only, it is done at once.
class BesideWork {
  public:
    explicit BesideWork(const std::function<void()>& work);
    // Waits. What the work throws is lost.
    ~BesideWork();
    BesideWork(const BesideWork&) = delete;
    BesideWork& operator=(const BesideWork&) = delete;

    // Passes on what the work threw.
    void wait();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace patina
