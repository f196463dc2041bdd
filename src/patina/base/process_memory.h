// What this process takes of the machine's memory.
#pragma once

#include <cstdint>

namespace patina {

// Resident now, and at most until now [bytes].
[[nodiscard]] std::int64_t resident_memory_bytes();
[[nodiscard]] std::int64_t peak_memory_bytes();

}  // namespace patina
