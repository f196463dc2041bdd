#include "patina/base/process_memory.h"

#include <fstream>
#if defined(__GLIBC__)
#include <malloc.h>
#endif
#include <sys/resource.h>
#include <unistd.h>

namespace patina {

std::int64_t resident_memory_bytes() {
    // Pages of the whole program, and those of them that are resident.
    std::ifstream stream("/proc/self/statm");
    std::int64_t pages = 0;
    std::int64_t resident = 0;
    if (!(stream >> pages >> resident)) return peak_memory_bytes();
    return resident * sysconf(_SC_PAGESIZE);
}

std::int64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    constexpr std::int64_t kBytesPerKibibyte = 1024;
    return std::int64_t(usage.ru_maxrss) * kBytesPerKibibyte;
}

void keep_freed_memory() {
#if defined(__GLIBC__)
    constexpr int kMebibyte = 1 << 20;
    mallopt(M_TRIM_THRESHOLD, 256 * kMebibyte);
    mallopt(M_MMAP_THRESHOLD, 32 * kMebibyte);
#endif
}

}  // namespace patina
