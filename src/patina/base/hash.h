// A hash of 128 bits, to tell whether data are those of another run. Not for secrets: the key is
// public.
//
// Based on: Aumasson, Bernstein. SipHash: a Fast Short-Input PRF. INDOCRYPT 2012 (SipHash-2-4 with
// 128 bits of output, key 00 01 .. 0f).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace patina {

using Hash128 = std::array<std::uint64_t, 2>;

// The hash of all bytes that were added, however they were split.
class Hasher {
  public:
    Hasher();

    void add(std::span<const std::byte> bytes);
    template <typename Number>
    requires std::is_arithmetic_v<Number>
    void add(Number number) { add(std::as_bytes(std::span(&number, 1))); }

    [[nodiscard]] Hash128 hash() const;

  private:
    using State = std::array<std::uint64_t, 4>;
    static void mix(State& state);
    static void absorb(State& state, std::uint64_t word);

    State state_;
    std::array<std::byte, 8> tail_{};  // bytes that do not fill a word yet
    std::uint64_t num_bytes_ = 0;
};

}  // namespace patina
