#include "patina/base/large_vector.h"

#include "patina/base/parallel.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <sys/mman.h>

namespace patina {
namespace {

constexpr std::size_t kLine = 64;
constexpr std::size_t kPage = std::size_t(4) << 10;
constexpr std::size_t kHugePage = std::size_t(2) << 20;
// Clearing one page takes longer than waking threads; less than two leave nothing to share.
constexpr std::size_t kWorthThreads = 2 * kHugePage;

// The system clears every page when it is first written, which takes longer than the writing: here
// all threads have it done, as std::vector fills its elements with one.
void touch(std::byte* memory, std::size_t size) {
    parallel_blocks(size / kHugePage, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t at = begin * kHugePage; at < end * kHugePage; at += kPage) {
            *static_cast<volatile std::byte*>(memory + at) = std::byte(0);
        }
    });
}

}  // namespace

void* allocate_large(std::size_t size, std::size_t alignment) {
    const std::size_t unit = size < kHugePage ? std::max(kLine, alignment) : kHugePage;
    if (size > std::size_t(-1) - unit) throw std::bad_alloc();
    const std::size_t whole = (size + unit - 1) / unit * unit;
    std::unique_ptr<void, decltype(&free_large)> memory(std::aligned_alloc(unit, whole),
                                                        free_large);
    if (memory == nullptr) throw std::bad_alloc();
    // A wish: systems without huge pages go on with small ones.
    if (unit == kHugePage) static_cast<void>(madvise(memory.get(), whole, MADV_HUGEPAGE));
    if (whole >= kWorthThreads) touch(static_cast<std::byte*>(memory.get()), whole);
    return memory.release();
}

void free_large(void* memory) noexcept { std::free(memory); }

}  // namespace patina
