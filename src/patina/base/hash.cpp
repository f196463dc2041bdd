#include "patina/base/hash.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace patina {
namespace {

constexpr std::size_t kWordBytes = 8;
constexpr std::uint64_t kKey[2] = {0x0706050403020100ULL, 0x0f0e0d0c0b0a0908ULL};
constexpr int kFinalMixes = 4;
// Tell the variant of 128 bits, and its two halves, from the one of 64 bits.
constexpr std::uint64_t kLongOutput = 0xee;
constexpr std::uint64_t kSecondHalf = 0xdd;

}  // namespace

Hasher::Hasher()
    : state_{0x736f6d6570736575ULL ^ kKey[0],
             0x646f72616e646f6dULL ^ kKey[1] ^ kLongOutput,
             0x6c7967656e657261ULL ^ kKey[0],
             0x7465646279746573ULL ^ kKey[1]} {}

void Hasher::mix(State& state) {
    auto& [a, b, c, d] = state;
    a += b;
    b = std::rotl(b, 13) ^ a;
    a = std::rotl(a, 32);
    c += d;
    d = std::rotl(d, 16) ^ c;
    a += d;
    d = std::rotl(d, 21) ^ a;
    c += b;
    b = std::rotl(b, 17) ^ c;
    c = std::rotl(c, 32);
}

void Hasher::absorb(State& state, std::uint64_t word) {
    state[3] ^= word;
    mix(state);
    mix(state);
    state[0] ^= word;
}

void Hasher::add(std::span<const std::byte> bytes) {
    const std::size_t in_tail = num_bytes_ % kWordBytes;
    num_bytes_ += bytes.size();
    std::size_t used = 0;
    if (in_tail > 0) {
        used = std::min(bytes.size(), kWordBytes - in_tail);
        std::copy_n(bytes.begin(), used, tail_.begin() + std::ptrdiff_t(in_tail));
        if (in_tail + used < kWordBytes) return;
        absorb(state_, std::bit_cast<std::uint64_t>(tail_));
    }
    State state = state_;
    for (; used + kWordBytes <= bytes.size(); used += kWordBytes) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes.data() + used, kWordBytes);
        absorb(state, word);
    }
    state_ = state;
    std::copy(bytes.begin() + std::ptrdiff_t(used), bytes.end(), tail_.begin());
}

Hash128 Hasher::hash() const {
    std::uint64_t last = num_bytes_ << 56;
    for (std::size_t i = 0; i < num_bytes_ % kWordBytes; ++i) {
        last |= std::uint64_t(tail_[i]) << (8 * i);
    }
    State state = state_;
    absorb(state, last);
    const auto half = [&](std::uint64_t& lane, std::uint64_t tag) {
        lane ^= tag;
        for (int k = 0; k < kFinalMixes; ++k) mix(state);
        return state[0] ^ state[1] ^ state[2] ^ state[3];
    };
    const std::uint64_t first = half(state[2], kLongOutput);
    return {first, half(state[1], kSecondHalf)};
}

}  // namespace patina
