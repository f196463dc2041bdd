#include "patina/base/large_vector.h"

#include <cstdlib>
#include <sys/mman.h>

namespace patina {
namespace {

constexpr std::size_t kLine = 64;
constexpr std::size_t kHugePage = std::size_t(2) << 20;

}  // namespace

void* allocate_large(std::size_t size) {
    const std::size_t alignment = size < kHugePage ? kLine : kHugePage;
    if (size > std::size_t(-1) - alignment) throw std::bad_alloc();
    const std::size_t whole = (size + alignment - 1) / alignment * alignment;
    void* const memory = std::aligned_alloc(alignment, whole);
    if (memory == nullptr) throw std::bad_alloc();
    // A wish: systems without huge pages go on with small ones.
    if (alignment == kHugePage) static_cast<void>(madvise(memory, whole, MADV_HUGEPAGE));
    return memory;
}

void free_large(void* memory) noexcept { std::free(memory); }

}  // namespace patina
