#include "patina/base/process_memory.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <sys/resource.h>
#include <vector>

namespace patina {
namespace {

constexpr std::size_t kPieces = 8;
constexpr std::size_t kPiece = std::size_t(6) << 20;     // [bytes]
constexpr std::size_t kHugePage = std::size_t(2) << 20;  // [bytes]

long page_faults_of_filling() {
    rusage before{};
    getrusage(RUSAGE_SELF, &before);
    std::vector<std::vector<char>> pieces;
    for (std::size_t i = 0; i < kPieces; ++i) pieces.emplace_back(kPiece, char(i));
    rusage after{};
    getrusage(RUSAGE_SELF, &after);
    EXPECT_GE(peak_memory_bytes(), std::int64_t(kPieces * kPiece));
    EXPECT_GE(resident_memory_bytes(), std::int64_t(kPieces * kPiece));
    return after.ru_minflt - before.ru_minflt;
}

TEST(KeepFreedMemory, HandsOutWhatWasGivenBackWithoutAskingTheSystem) {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the sanitizer has memory of its own";
#endif
    keep_freed_memory();
    static_cast<void>(page_faults_of_filling());
    // New memory would take a fault for each huge page at least.
    EXPECT_LT(page_faults_of_filling(), long(kPieces * kPiece / kHugePage));
}

}  // namespace
}  // namespace patina
