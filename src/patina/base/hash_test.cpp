#include "patina/base/hash.h"

#include <gtest/gtest.h>

#include <vector>

namespace patina {
namespace {

std::vector<std::byte> counting_bytes(std::size_t count) {
    std::vector<std::byte> bytes(count);
    for (std::size_t i = 0; i < count; ++i) bytes[i] = std::byte(i);
    return bytes;
}

Hash128 hash_of(std::span<const std::byte> bytes) {
    Hasher hasher;
    hasher.add(bytes);
    return hasher.hash();
}

// The authors' vectors: 0, 1, .. n - 1 under the key 00 .. 0f.
TEST(Hasher, GivesThePublishedHashes) {
    const auto expect = [](std::size_t count, std::uint64_t first, std::uint64_t second) {
        EXPECT_EQ(hash_of(counting_bytes(count)), (Hash128{first, second})) << count;
    };
    expect(0, 0xe6a825ba047f81a3ULL, 0x930255c71472f66dULL);
    expect(1, 0x44af996bd8c187daULL, 0x45fc229b11597634ULL);
    expect(15, 0x11a8b03399e99354ULL, 0xd9c3cf970fec087eULL);
}

TEST(Hasher, DoesNotDependOnHowTheBytesAreSplit) {
    const std::vector<std::byte> bytes = counting_bytes(64);
    const Hash128 whole = hash_of(bytes);
    for (std::size_t first = 0; first <= bytes.size(); ++first) {
        for (const std::size_t second : {first, (first + bytes.size()) / 2}) {
            Hasher hasher;
            hasher.add(std::span(bytes).first(first));
            hasher.add(std::span(bytes).subspan(first, second - first));
            hasher.add(std::span(bytes).subspan(second));
            EXPECT_EQ(hasher.hash(), whole) << first << " " << second;
        }
    }
}

TEST(Hasher, ChangesWithEveryBit) {
    std::vector<std::byte> bytes = counting_bytes(19);
    const Hash128 whole = hash_of(bytes);
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        bytes[bit / 8] ^= std::byte(1U << (bit % 8));
        const Hash128 other = hash_of(bytes);
        EXPECT_NE(other[0], whole[0]) << bit;
        EXPECT_NE(other[1], whole[1]) << bit;
        bytes[bit / 8] ^= std::byte(1U << (bit % 8));
    }
}

}  // namespace
}  // namespace patina
