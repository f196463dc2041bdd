// Memory in huge pages, which is kept when it is given back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

namespace patina {

inline constexpr std::size_t kHugePage = std::size_t(2) << 20;

// Ranges of whole huge pages. Of any thread.
//
// malloc() would take them for chunks between others: of what is given back with this alignment it
// can give next to nothing out again, so that a program's memory grows and all of it is new.
class HugePages {
  public:
    // max_kept: at most so much is kept of what was given back [bytes].
    explicit HugePages(std::size_t max_kept) : max_kept_(max_kept) {}
    ~HugePages();
    HugePages(const HugePages&) = delete;
    HugePages& operator=(const HugePages&) = delete;

    struct Range {
        std::byte* memory = nullptr;  // null: the system has none
        bool is_new = false;          // or it was used before, and its pages are there
    };
    // size: a multiple of kHugePage, at least one.
    [[nodiscard]] Range take(std::size_t size);
    // A range that was taken, or whole huge pages of it.
    void give_back(std::byte* memory, std::size_t size) noexcept;

    [[nodiscard]] std::size_t kept_bytes() const;

  private:
    [[nodiscard]] std::byte* take_kept(std::size_t size);
    void give_all_to_system();

    std::size_t max_kept_;
    mutable std::mutex mutex_;
    std::map<std::uintptr_t, std::size_t> free_;  // sizes by address; no two of them touch
    std::size_t kept_ = 0;                        // in all of them [bytes]
};

}  // namespace patina
