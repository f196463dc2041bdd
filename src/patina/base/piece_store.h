// Memory for what is written once, in parts whose sizes are not known beforehand, and read when all
// of it is there.
#pragma once

#include "patina/base/large_vector.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace patina {

// In pieces that never move, so that growing copies nothing and asks the system for memory rarely.
template <typename Value>
class PieceStore {
  public:
    // `count` values side by side, not cleared; they live as long as the store.
    [[nodiscard]] std::span<Value> take(std::size_t count) {
        if (count == 0) return {};  // or what stays empty would have a piece
        if (pieces_.empty() || pieces_.back().capacity() - pieces_.back().size() < count) {
            pieces_.emplace_back().reserve(std::max(count, kPieceBytes / sizeof(Value)));
        }
        UnclearedVector<Value>& piece = pieces_.back();
        piece.resize(piece.size() + count);
        return std::span(piece).last(count);
    }

  private:
    static constexpr std::size_t kPieceBytes = std::size_t(4) << 20;

    std::vector<UnclearedVector<Value>> pieces_;
};

}  // namespace patina
