#include "patina/base/large_vector.h"

#include "patina/base/huge_pages.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <cstdlib>

namespace patina {
namespace {

constexpr std::size_t kLine = 64;
constexpr std::size_t kPage = std::size_t(4) << 10;
// Clearing one page takes longer than waking threads; less than two leave nothing to share.
constexpr std::size_t kWorthThreads = 2 * kHugePage;

// Never destroyed: vectors may outlive what a program destroys at its end.
HugePages& huge_pages() {
    static auto* const pages = new HugePages(kKeptBytes);
    return *pages;
}

bool is_huge(std::size_t size) { return size >= kHugePage; }

// size rounded up to whole units.
std::size_t whole_units(std::size_t size, std::size_t unit) {
    if (size > std::size_t(-1) - unit) throw std::bad_alloc();
    return (size + unit - 1) / unit * unit;
}

// The system clears every page when it is first written, which takes longer than the writing: here
// all threads have it done, as std::vector fills its elements with one.
void touch(std::byte* memory, std::size_t size) {
    parallel_blocks(size / kHugePage, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t at = begin * kHugePage; at < end * kHugePage; at += kPage) {
            *static_cast<volatile std::byte*>(memory + at) = std::byte(0);
        }
    });
}

void* allocate_huge(std::size_t size) {
    const auto [memory, is_new] = huge_pages().take(size);
    if (memory == nullptr) throw std::bad_alloc();
    try {
        if (is_new && size >= kWorthThreads) touch(memory, size);
    } catch (...) {
        huge_pages().give_back(memory, size);
        throw;
    }
    return memory;
}

}  // namespace

void* allocate_large(std::size_t size, std::size_t alignment) {
    if (is_huge(size)) return allocate_huge(whole_units(size, kHugePage));
    const std::size_t unit = std::max(kLine, alignment);
    void* const memory = std::aligned_alloc(unit, whole_units(size, unit));
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

void free_large(void* memory, std::size_t size) noexcept {
    if (is_huge(size)) {
        huge_pages().give_back(static_cast<std::byte*>(memory),
                               (size + kHugePage - 1) / kHugePage * kHugePage);
    } else {
        std::free(memory);
    }
}

}  // namespace patina
