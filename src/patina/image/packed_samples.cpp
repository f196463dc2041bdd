#include "patina/image/packed_samples.h"

#include <bit>
#include <cstddef>
#include <cstring>

namespace patina {
namespace {

// IEEE 754 binary16.
float float_of_half(std::uint16_t half) {
    const std::uint32_t sign = (half & 0x8000u) << 16;
    const std::uint32_t exponent = half >> 10 & 0x1fu;
    const std::uint32_t fraction = half & 0x3ffu;
    if (exponent == 0) {
        constexpr float kSmallest = 1.0f / (1 << 24);  // of what has no leading 1
        return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(kSmallest * fraction));
    }
    const std::uint32_t wide = exponent == 0x1f ? 0xff : exponent - 15 + 127;
    return std::bit_cast<float>(sign | wide << 23 | fraction << 13);
}

// Samples of whole bytes, in the machine's byte order.
template <typename Stored, typename Convert>
void unpack_bytes(const std::uint8_t* bytes, std::span<float> row, Convert convert) {
    for (std::size_t i = 0; i < row.size(); ++i) {
        Stored stored{};
        std::memcpy(&stored, bytes + i * sizeof(Stored), sizeof(Stored));
        row[i] = convert(stored);
    }
}

// Samples of any number of bits, the first in the highest bits.
template <typename Convert>
void unpack_bits(const std::uint8_t* bytes, unsigned bits, std::span<float> row, Convert convert) {
    std::uint32_t window = 0;
    unsigned num_left = 0;
    for (float& value : row) {
        for (; num_left < bits; num_left += 8) window = window << 8 | *bytes++;
        num_left -= bits;
        value = convert(window >> num_left & ((1u << bits) - 1));
    }
}

}  // namespace

void unpack_samples(const std::uint8_t* bytes, SampleType type, std::span<float> row) {
    if (type.is_floating && type.bits == 64) {
        unpack_bytes<double>(bytes, row, [](double stored) { return static_cast<float>(stored); });
    } else if (type.is_floating && type.bits == 32) {
        unpack_bytes<float>(bytes, row, [](float stored) { return stored; });
    } else if (type.is_floating) {
        unpack_bytes<std::uint16_t>(bytes, row, float_of_half);
    } else if (type.bits == 8 || type.bits == 16) {
        unpack_indices(bytes, type.bits, row);
    } else {
        const auto white = static_cast<std::uint32_t>(type.white());
        const std::uint32_t highest = (1u << type.bits) - 1;
        unpack_bits(bytes, type.bits, row, [&](std::uint32_t stored) {
            return static_cast<float>(stored * white / highest);
        });
    }
}

void unpack_indices(const std::uint8_t* bytes, unsigned bits, std::span<float> row) {
    const auto as_float = [](auto stored) { return static_cast<float>(stored); };
    if (bits == 16) {
        unpack_bytes<std::uint16_t>(bytes, row, as_float);
    } else if (bits == 8) {
        unpack_bytes<std::uint8_t>(bytes, row, as_float);
    } else {
        unpack_bits(bytes, bits, row, as_float);
    }
}

}  // namespace patina
