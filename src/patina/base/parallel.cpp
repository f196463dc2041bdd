#include "patina/base/parallel.h"

#include "patina/base/error.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <exception>
#include <utility>

namespace patina {

struct ThreadLimit::State {
    explicit State(std::size_t count)
        : control(oneapi::tbb::global_control::max_allowed_parallelism, count) {}
    oneapi::tbb::global_control control;
};

ThreadLimit::ThreadLimit(int count)
    : state_(std::make_unique<State>(
          static_cast<std::size_t>(count > 0 ? count : oneapi::tbb::info::default_concurrency()))) {
}

ThreadLimit::~ThreadLimit() = default;

int thread_count() {
    return static_cast<int>(oneapi::tbb::global_control::active_value(
        oneapi::tbb::global_control::max_allowed_parallelism));
}

void parallel_blocks(std::size_t count,
                     std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
    throw_if_interrupted();
    if (count == 0) return;
    const std::size_t step = std::max<std::size_t>(grain, 1);
    const std::size_t num_blocks = (count + step - 1) / step;
    const auto run = [&](const oneapi::tbb::blocked_range<std::size_t>& range) {
        for (std::size_t block = range.begin(); block != range.end(); ++block) {
            throw_if_interrupted();
            body(block * step, std::min(count, (block + 1) * step));
        }
    };
    // A thread that waits for the end of this loop helps with nothing else: of an outer loop it
    // might take up what waits for what this loop computes.
    oneapi::tbb::this_task_arena::isolate([&] {
        oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, num_blocks, 1), run);
    });
}

struct BesideWork::State {
    oneapi::tbb::task_group group;
    std::exception_ptr exception;
};

BesideWork::BesideWork(const std::function<void()>& work) : state_(std::make_unique<State>()) {
    const auto run = [work, state = state_.get()] {
        try {
            work();
        } catch (...) {
            state->exception = std::current_exception();
        }
    };
    // A limit of two threads makes no second processor.
    if (std::min(thread_count(), oneapi::tbb::this_task_arena::max_concurrency()) == 1) {
        run();
    } else {
        state_->group.run(run);
    }
}

BesideWork::~BesideWork() { state_->group.wait(); }

void BesideWork::wait() {
    state_->group.wait();
    if (state_->exception) std::rethrow_exception(std::exchange(state_->exception, nullptr));
}

}  // namespace patina
