#include "patina/base/random.h"

#include <gmock/gmock.h>

#include <cmath>
#include <set>
#include <vector>

namespace patina {
namespace {

using testing::ElementsAre;

// |z| of a standard normal variable goes beyond this with a probability of 1e-6.
constexpr double kMaxZ = 4.892;

// Known answers of the Random123 distribution (kat_vectors, philox4x32 with 10 rounds).
TEST(Philox, GivesTheKnownAnswers) {
    EXPECT_THAT(philox({0, 0, 0, 0}, {0, 0}),
                ElementsAre(0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u));
    constexpr std::uint32_t kOnes = 0xffffffffu;
    EXPECT_THAT(philox({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
                ElementsAre(0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu));
    EXPECT_THAT(
        philox({0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u}, {0xa4093822u, 0x299f31d0u}),
        ElementsAre(0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u));
}

TEST(Rng, RepeatsItselfForTheSameElement) {
    Rng a(7, Pass::photons, 42);
    Rng b(7, Pass::photons, 42);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(a.next_u32(), b.next_u32());
}

TEST(Rng, DiffersBySeedPassAndElement) {
    std::set<std::uint32_t> first;
    first.insert(Rng(1, Pass::photons, 1).next_u32());
    first.insert(Rng(2, Pass::photons, 1).next_u32());
    first.insert(Rng(std::uint64_t{1} << 32 | 1, Pass::photons, 1).next_u32());
    first.insert(Rng(1, Pass::tests, 1).next_u32());
    first.insert(Rng(1, Pass::photons, 2).next_u32());
    first.insert(Rng(1, Pass::photons, std::uint64_t{1} << 32 | 1).next_u32());
    EXPECT_EQ(first.size(), 6u);
}

TEST(Rng, UniformHasTheMomentsOfTheUnitInterval) {
    constexpr int kCount = 100000;
    Rng rng(1, Pass::tests, 0);
    double sum = 0;
    for (int i = 0; i < kCount; ++i) {
        const double x = rng.uniform();
        ASSERT_GE(x, 0);
        ASSERT_LT(x, 1);
        sum += x;
    }
    EXPECT_LT(std::abs(sum / kCount - 0.5) / std::sqrt(1.0 / 12 / kCount), kMaxZ);
}

TEST(Rng, NormalHasMeanZeroAndVarianceOne) {
    constexpr int kCount = 100000;
    Rng rng(1, Pass::tests, 1);
    double sum = 0;
    double sum_of_squares = 0;
    for (int i = 0; i < kCount; ++i) {
        const double x = rng.normal();
        sum += x;
        sum_of_squares += x * x;
    }
    EXPECT_LT(std::abs(sum / kCount) * std::sqrt(kCount), kMaxZ);
    // The square of a standard normal variable has variance 2.
    EXPECT_LT(std::abs(sum_of_squares / kCount - 1) / std::sqrt(2.0 / kCount), kMaxZ);
}

// A (0,2)-sequence in base 2: the first 2^n points put one into every elementary interval of size
// 2^-a x 2^-b with a + b = n.
TEST(SobolSampler, PutsOneSampleIntoEveryElementaryInterval) {
    for (std::uint32_t n = 0; n <= 8; ++n) {
        for (std::uint64_t element = 0; element < 3; ++element) {
            for (std::uint32_t a = 0; a <= n; ++a) {
                const double columns = 1u << a;
                const double rows = 1u << (n - a);
                // One set for each pair of dimensions.
                std::vector<std::set<std::pair<int, int>>> cells(4);
                for (std::uint32_t sample = 0; sample < 1u << n; ++sample) {
                    SobolSampler sampler(5, Pass::tests, element, sample);
                    for (auto& cell : cells) {
                        const auto [x, y] = sampler.next_pair();
                        cell.emplace(int(x * columns), int(y * rows));
                    }
                }
                for (const auto& cell : cells) EXPECT_EQ(cell.size(), std::size_t{1} << n);
            }
        }
    }
}

TEST(SobolSampler, IsUnbiasedOverItsScramblings) {
    constexpr int kCount = 100000;
    double sum_x = 0;
    double sum_xy = 0;
    for (std::uint64_t element = 0; element < kCount; ++element) {
        const auto [x, y] = SobolSampler(3, Pass::tests, element, 0).next_pair();
        sum_x += x;
        sum_xy += (x - 0.5) * (y - 0.5);
    }
    EXPECT_LT(std::abs(sum_x / kCount - 0.5) / std::sqrt(1.0 / 12 / kCount), kMaxZ);
    EXPECT_LT(std::abs(sum_xy / kCount) / std::sqrt(1.0 / 144 / kCount), kMaxZ);
}

TEST(SobolSampler, PairsOfDimensionsAreIndependent) {
    constexpr int kCount = 100000;
    double sum = 0;
    for (std::uint32_t sample = 0; sample < kCount; ++sample) {
        SobolSampler sampler(3, Pass::tests, sample / 16, sample % 16);
        const double first = sampler.next_pair()[0];
        const double second = sampler.next_pair()[0];
        sum += (first - 0.5) * (second - 0.5);
    }
    EXPECT_LT(std::abs(sum / kCount) / std::sqrt(1.0 / 144 / kCount), kMaxZ);
}

}  // namespace
}  // namespace patina
