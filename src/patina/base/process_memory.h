// What this process takes of the machine's memory.
#pragma once

#include <cstdint>

namespace patina {

// Resident now, and at most until now [bytes].
[[nodiscard]] std::int64_t resident_memory_bytes();
[[nodiscard]] std::int64_t peak_memory_bytes();

// From now on memory that is given back is kept for what is asked for next, up to 256 MiB of it and
// in pieces below 32 MiB: the system clears what it hands out, and a virtual machine's host may
// have to find it first. For programs, at their start; where the C library has no such wish,
// nothing happens.
void keep_freed_memory();

}  // namespace patina
