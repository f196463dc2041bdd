#include "patina/base/process_memory.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <sys/resource.h>
#include <vector>

namespace patina {
namespace {

constexpr std::size_t kPieces = 8;
constexpr std::size_t kPiece = std::size_t(6) << 20;  // [bytes]

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
    const long first = page_faults_of_filling();
    // One page at least for every huge one.
    ASSERT_GE(first, long(kPieces * kPiece >> 21));
    EXPECT_LE(page_faults_of_filling(), first / 10);
}

}  // namespace
}  // namespace patina
