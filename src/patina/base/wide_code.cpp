#include "patina/base/wide_code.h"

#include <atomic>

namespace patina {
namespace {

bool machine_has_avx512() {
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
           __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
#else
    return false;
#endif
}

std::atomic<int>& num_limits() {
    static std::atomic<int> count = 0;
    return count;
}

}  // namespace

bool takes_avx512() {
    static const bool has_avx512 = machine_has_avx512();
    return has_avx512 && num_limits().load(std::memory_order_relaxed) == 0;
}

NarrowCode::NarrowCode() { ++num_limits(); }
NarrowCode::~NarrowCode() { --num_limits(); }

}  // namespace patina
