// Whether two vectors hold the same bytes.
#pragma once

#include <cstring>

namespace patina {

// Container: contiguous, of values without pointers.
template <typename Container>
[[nodiscard]] bool same_bytes(const Container& a, const Container& b) {
    return a.size() == b.size() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(*a.data())) == 0;
}

}  // namespace patina
