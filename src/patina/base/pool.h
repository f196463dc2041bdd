// Objects that are dear to make, lent to the blocks of a parallel loop one after the other.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace patina {

// Makes no more objects than are lent at a time. What a loop computes must not depend on which of
// them a block is lent.
template <typename T>
class Pool {
  public:
    explicit Pool(std::function<std::unique_ptr<T>()> make) : make_(std::move(make)) {}

    // Calls work(object) with one that nobody else uses meanwhile. Of any thread. Where the work
    // throws, its object is gone.
    template <typename Work>
    void lend(const Work& work) {
        std::unique_ptr<T> object = take();
        work(*object);
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(object));
    }

  private:
    std::unique_ptr<T> take() {
        {
            const std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
                std::unique_ptr<T> object = std::move(idle_.back());
                idle_.pop_back();
                return object;
            }
        }
        return make_();
    }

    std::function<std::unique_ptr<T>()> make_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<T>> idle_;
};

}  // namespace patina
