#include "patina/base/huge_pages.h"

#include <algorithm>
#include <iterator>
#include <new>
#include <sys/mman.h>

namespace patina {
namespace {

std::byte* at(std::uintptr_t address) { return reinterpret_cast<std::byte*>(address); }
std::uintptr_t address_of(const std::byte* memory) {
    return reinterpret_cast<std::uintptr_t>(memory);
}

void unmap(std::uintptr_t begin, std::uintptr_t end) noexcept {
    if (begin < end) static_cast<void>(munmap(at(begin), end - begin));
}

// The system may place a mapping at any small page: the ends that are too much are given back.
std::byte* map_aligned(std::size_t size) {
    if (size > std::size_t(-1) - kHugePage) return nullptr;
    void* const mapped =
        mmap(nullptr, size + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) return nullptr;
    const std::uintptr_t first = address_of(static_cast<std::byte*>(mapped));
    const std::uintptr_t begin = (first + kHugePage - 1) / kHugePage * kHugePage;
    unmap(first, begin);
    unmap(begin + size, first + size + kHugePage);
    // A wish: systems without huge pages go on with small ones.
    static_cast<void>(madvise(at(begin), size, MADV_HUGEPAGE));
    return at(begin);
}

}  // namespace

HugePages::~HugePages() { give_all_to_system(); }

HugePages::Range HugePages::take(std::size_t size) {
    const std::lock_guard lock(mutex_);
    if (std::byte* kept = take_kept(size)) return {kept, false};
    std::byte* memory = map_aligned(size);
    if (memory == nullptr) {
        give_all_to_system();
        memory = map_aligned(size);
    }
    return {memory, true};
}

// Of the smallest range that holds it, so that large ones stay.
std::byte* HugePages::take_kept(std::size_t size) {
    auto best = free_.end();
    for (auto range = free_.begin(); range != free_.end(); ++range) {
        if (range->second < size) continue;
        if (best == free_.end() || range->second < best->second) best = range;
    }
    if (best == free_.end()) return nullptr;
    // Its end, so that what remains keeps its place.
    best->second -= size;
    kept_ -= size;
    std::byte* const memory = at(best->first + best->second);
    if (best->second == 0) free_.erase(best);
    return memory;
}

void HugePages::give_back(std::byte* memory, std::size_t size) noexcept {
    const std::uintptr_t address = address_of(memory);
    const std::lock_guard lock(mutex_);
    if (kept_ + size > max_kept_) {
        unmap(address, address + size);
        return;
    }
    try {
        auto range = free_.emplace(address, size).first;
        kept_ += size;
        const auto next = std::next(range);
        if (next != free_.end() && range->first + range->second == next->first) {
            range->second += next->second;
            free_.erase(next);
        }
        if (range == free_.begin()) return;
        const auto previous = std::prev(range);
        if (previous->first + previous->second != range->first) return;
        previous->second += range->second;
        free_.erase(range);
    } catch (const std::bad_alloc&) {
        unmap(address, address + size);
    }
}

std::size_t HugePages::kept_bytes() const {
    const std::lock_guard lock(mutex_);
    return kept_;
}

void HugePages::give_all_to_system() {
    for (const auto& [address, size] : free_) unmap(address, address + size);
    free_.clear();
    kept_ = 0;
}

}  // namespace patina
