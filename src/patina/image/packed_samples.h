// Samples as files pack them into bytes, made floats.
#pragma once

#include <cstdint>
#include <span>

namespace patina {

struct SampleType {
    // 1 to 14 or 16 of an unsigned integer; 16, 32 or 64 of a float.
    unsigned bits = 8;
    bool is_floating = false;

    // The integer that stands for 1, once integers of few bits are stretched to 8 or 16.
    [[nodiscard]] float white() const { return bits <= 8 ? 255.0f : 65535.0f; }
};

// Fills row with samples that lie side by side in bytes: those of whole bytes in the machine's byte
// order, others with the first in the highest bits. Integers come out from 0 to white().
void unpack_samples(const std::uint8_t* bytes, SampleType type, std::span<float> row);

// Likewise of integers of 1 to 16 bits, which are left as they are.
void unpack_indices(const std::uint8_t* bytes, unsigned bits, std::span<float> row);

}  // namespace patina
