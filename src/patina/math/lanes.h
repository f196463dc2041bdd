// Eight single-precision numbers side by side in a register, and in 16 bits each in memory.
//
// Types of the compiler's own (vector extensions of GCC and Clang): arithmetic, comparison and
// `a < b ? c : d` go by lane, [] is a lane, and what the machine lacks is done in parts. The same
// bytes as lane by lane.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace patina {

inline constexpr std::size_t kLanes = 8;
using Lanes [[gnu::vector_size(kLanes * sizeof(float))]] = float;

// From and to anywhere in memory.
using UnalignedLanes [[gnu::vector_size(sizeof(Lanes)), gnu::aligned(1), gnu::may_alias]] = float;
[[nodiscard]] inline Lanes load_lanes(const void* from) {
    return *static_cast<const UnalignedLanes*>(from);
}
inline void store_lanes(Lanes value, float* to) { *reinterpret_cast<UnalignedLanes*>(to) = value; }

// In double precision.
[[nodiscard]] inline double sum_of_lanes(Lanes x) {
    using Floats [[gnu::vector_size(kLanes / 2 * sizeof(float))]] = float;
    using Doubles [[gnu::vector_size(kLanes / 2 * sizeof(double))]] = double;
    const Floats low = __builtin_shufflevector(x, x, 0, 1, 2, 3);
    const Floats high = __builtin_shufflevector(x, x, 4, 5, 6, 7);
    const Doubles sum =
        __builtin_convertvector(low, Doubles) + __builtin_convertvector(high, Doubles);
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

[[nodiscard]] inline Lanes square_root(Lanes x) {
    for (std::size_t l = 0; l < kLanes; ++l) x[l] = std::sqrt(x[l]);
    return x;
}

// Eight numbers of eight records, number by number: result[f][k] is number f of those that lie
// `offset` bytes into what records[k] points to.
[[nodiscard]] inline std::array<Lanes, kLanes> load_transposed(
    const std::array<const void*, kLanes>& records, std::size_t offset) {
    const auto row = [&](std::size_t k) {
        return load_lanes(static_cast<const std::byte*>(records[k]) + offset);
    };
    // Of two records, of four, of all: numbers f and f + 4 come to lie side by side.
    const auto low_two = [](Lanes a, Lanes b) {
        return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
    };
    const auto high_two = [](Lanes a, Lanes b) {
        return __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
    };
    const auto low_four = [](Lanes a, Lanes b) {
        return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
    };
    const auto high_four = [](Lanes a, Lanes b) {
        return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    };
    const auto low_half = [](Lanes a, Lanes b) {
        return __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
    };
    const auto high_half = [](Lanes a, Lanes b) {
        return __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
    };
    const Lanes r0 = row(0), r1 = row(1);
    const Lanes r2 = row(2), r3 = row(3);
    const Lanes r4 = row(4), r5 = row(5);
    const Lanes r6 = row(6), r7 = row(7);
    const Lanes a0 = low_two(r0, r1), a2 = high_two(r0, r1);
    const Lanes b0 = low_two(r2, r3), b2 = high_two(r2, r3);
    const Lanes c0 = low_two(r4, r5), c2 = high_two(r4, r5);
    const Lanes d0 = low_two(r6, r7), d2 = high_two(r6, r7);
    const Lanes p0 = low_four(a0, b0), p1 = high_four(a0, b0);
    const Lanes p2 = low_four(a2, b2), p3 = high_four(a2, b2);
    const Lanes q0 = low_four(c0, d0), q1 = high_four(c0, d0);
    const Lanes q2 = low_four(c2, d2), q3 = high_four(c2, d2);
    return {low_half(p0, q0),
            low_half(p1, q1),
            low_half(p2, q2),
            low_half(p3, q3),
            high_half(p0, q0),
            high_half(p1, q1),
            high_half(p2, q2),
            high_half(p3, q3)};
}

// --- Compact numbers ---------------------------------------------------------------------------
// Six bits of exponent, ten of mantissa, no sign, for rows that are read from all over memory:
// relative error at most 2^-11, of either sign, from 2^-41 to 2^22; what is smaller becomes 0, what
// is larger the largest.

using CompactLanes = std::array<std::uint16_t, kLanes>;

inline constexpr float kSmallestCompact = 0x1p-41f;
inline constexpr float kLargestCompact = 0x1.ffcp21f;
inline constexpr double kCompactRounding = 1.0 / 2048;

namespace detail {

// The smallest compact number becomes the smallest normal float, whose upper bits are kept.
inline constexpr float kToCut = 0x1p-85f;
inline constexpr float kFromCut = 0x1p85f;
inline constexpr int kCutBits = 13;

using WordLanes [[gnu::vector_size(kLanes * sizeof(std::uint32_t))]] = std::uint32_t;
using ShortLanes [[gnu::vector_size(kLanes * sizeof(std::uint16_t))]] = std::uint16_t;

template <typename Word, typename Float>
[[nodiscard]] inline Word cut(Float x) {
    const Float none{};
    const Float largest = none + kLargestCompact;
    const Float held = x < kSmallestCompact ? none : (x < largest ? x : largest);
    const auto bits = std::bit_cast<Word>(held * kToCut);
    return (bits + ((1u << (kCutBits - 1)) - 1) + ((bits >> kCutBits) & 1u)) >> kCutBits;
}

}  // namespace detail

// x >= 0; rounded to nearest, ties to even.
[[nodiscard]] inline std::uint16_t to_compact(float x) {
    return std::uint16_t(detail::cut<std::uint32_t>(x));
}
[[nodiscard]] inline CompactLanes to_compact(Lanes x) {
    const auto words = detail::cut<detail::WordLanes>(x);
    return std::bit_cast<CompactLanes>(__builtin_convertvector(words, detail::ShortLanes));
}

[[nodiscard]] inline float from_compact(std::uint16_t compact) {
    return std::bit_cast<float>(std::uint32_t(compact) << detail::kCutBits) * detail::kFromCut;
}
[[nodiscard]] inline Lanes from_compact(const CompactLanes& compact) {
    const auto words =
        __builtin_convertvector(std::bit_cast<detail::ShortLanes>(compact), detail::WordLanes);
    return std::bit_cast<Lanes>(words << detail::kCutBits) * detail::kFromCut;
}

}  // namespace patina
