// Eight single-precision numbers side by side in a register, and in 16 bits each in memory.
//
// Types of the compiler's own (vector extensions of GCC and Clang): arithmetic, comparison and
// `a < b ? c : d` go by lane, [] is a lane, and what the machine lacks is done in parts. The same
// bytes as lane by lane.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace patina {

inline constexpr std::size_t kLanes = 8;
using Lanes [[gnu::vector_size(kLanes * sizeof(float))]] = float;

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
