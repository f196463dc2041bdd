// A table with a row for every texel, whose entries lie side by side: a texel's fit reads all of
// them together.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <cstddef>
#include <span>

namespace patina {

template <typename Value>
class TexelTable {
  public:
    // All values as Value() afterwards. Keeps its memory.
    void reset(std::size_t texels, std::size_t columns) {
        columns_ = columns;
        values_.resize(texels * columns);
        parallel_for(texels, [&](std::size_t i) { std::ranges::fill(of(i), Value()); });
    }

    [[nodiscard]] bool empty() const { return values_.empty(); }
    [[nodiscard]] std::size_t columns() const { return columns_; }
    [[nodiscard]] std::span<Value> of(std::size_t texel) {
        return {values_.data() + texel * columns_, columns_};
    }
    [[nodiscard]] std::span<const Value> of(std::size_t texel) const {
        return {values_.data() + texel * columns_, columns_};
    }

  private:
    LargeVector<Value> values_;
    std::size_t columns_ = 0;
};

}  // namespace patina
