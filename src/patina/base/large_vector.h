// Vectors for what fills much memory: in huge pages where the system has them, which saves a search
// of the page tables for most reads all over it, and with all threads taking part when the system
// clears new pages.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace patina {

// At least size bytes, aligned to at least 64 and `alignment`, a power of two of at most 2 MiB.
// Throws std::bad_alloc, and Interrupted when the user asked to stop.
[[nodiscard]] void* allocate_large(std::size_t size, std::size_t alignment);
void free_large(void* memory) noexcept;

template <typename T>
struct LargeAllocator {
    using value_type = T;

    LargeAllocator() = default;
    template <typename U>
    LargeAllocator(const LargeAllocator<U>& /*other*/) noexcept {}

    [[nodiscard]] T* allocate(std::size_t count) {
        if (count > std::size_t(-1) / sizeof(T)) throw std::bad_array_new_length();
        return static_cast<T*>(allocate_large(count * sizeof(T), alignof(T)));
    }
    void deallocate(T* memory, std::size_t /*count*/) noexcept { free_large(memory); }

    friend bool operator==(const LargeAllocator& /*a*/, const LargeAllocator& /*b*/) {
        return true;
    }
};

template <typename T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace patina
