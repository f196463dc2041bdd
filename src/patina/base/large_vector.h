// Vectors for what fills much memory: in huge pages where the system has them, which saves a search
// of the page tables for most reads all over it, and with all threads taking part when the system
// clears new pages.
//
// What is given back is kept for the next: the system clears what it hands out, and a virtual
// machine's host may have to find it first.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace patina {

// At most so much is kept of what was given back [bytes].
inline constexpr std::size_t kKeptBytes = std::size_t(64) << 20;

// At least size bytes, aligned to at least 64 and `alignment`, a power of two of at most 2 MiB.
// Throws std::bad_alloc, and Interrupted when the user asked to stop.
[[nodiscard]] void* allocate_large(std::size_t size, std::size_t alignment);
// size: as it was allocated with.
void free_large(void* memory, std::size_t size) noexcept;

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
    void deallocate(T* memory, std::size_t count) noexcept {
        free_large(memory, count * sizeof(T));
    }

    friend bool operator==(const LargeAllocator& /*a*/, const LargeAllocator& /*b*/) {
        return true;
    }
};

template <typename T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

template <typename T>
struct UnclearedAllocator : LargeAllocator<T> {
    template <typename U>
    struct rebind {
        using other = UnclearedAllocator<U>;
    };

    UnclearedAllocator() = default;
    template <typename U>
    UnclearedAllocator(const UnclearedAllocator<U>& /*other*/) noexcept {}

    // An element that is given no value: of a type without initialisers nothing is written.
    template <typename U>
    void construct(U* element) noexcept(std::is_nothrow_default_constructible_v<U>) {
        ::new (static_cast<void*>(element)) U;
    }
    template <typename U, typename... Values>
    void construct(U* element, Values&&... values) {
        ::new (static_cast<void*>(element)) U(std::forward<Values>(values)...);
    }
};

// For what is written before it is read: clearing it first would take as long, and would fetch it
// into the cache of a thread that does not need it.
template <typename T>
using UnclearedVector = std::vector<T, UnclearedAllocator<T>>;

}  // namespace patina
