// Narrow lobes under lamps that turn with the scanner.
#include <gtest/gtest.h>

#include "support/narrow_channel.h"
#include "support/same_bytes.h"
#include <algorithm>
#include <cmath>
#include <vector>

namespace patina {
namespace {

constexpr std::size_t kNumRuns = 64;  // independent graphs and sets of photons

class NarrowLobesUnderTurningLamps : public testing::Test {
  protected:
    // Strips of the floor, each with its own place of the lamps, and the walls.
    [[nodiscard]] std::vector<std::vector<TexelId>> patches() const {
        std::vector<std::vector<TexelId>> patches(kNumStrips);
        for (const TexelId texel : channel_.plates[0]) {
            const int column = channel_.atlas.texels[texel].column;
            patches[std::size_t(column) * kNumStrips / (kFine * Channel::kSide)].push_back(texel);
        }
        patches.push_back(channel_.plates[1]);
        patches.push_back(channel_.plates[2]);
        return patches;
    }
    static constexpr std::size_t kNumStrips = 4;
    static constexpr double kWidest = 0.17;  // lamps that reach all of the walls [rad]
    const NarrowChannel channel_{kWidest};
};

TEST_F(NarrowLobesUnderTurningLamps, AreNeitherCountedTwiceNorLostForAnyColumn) {
    const std::vector<std::vector<TexelId>> patches = this->patches();
    std::vector<std::vector<double>> photons(patches.size());
    std::vector<std::vector<double>> rest(patches.size());
    std::vector<std::vector<double>> both(patches.size());
    for (std::size_t run = 0; run < kNumRuns; ++run) {
        NarrowLobes narrow = channel_.narrow_lobes(run);
        ASSERT_TRUE(narrow.follow(channel_.maps));
        const SweptLight swept = channel_.swept(channel_.graph(run), narrow.shares());
        const NarrowLobes::Irradiance light = narrow.irradiance(0);
        for (std::size_t k = 0; k < patches.size(); ++k) {
            photons[k].push_back(channel_.photon_mean(patches[k], light));
            rest[k].push_back(channel_.swept_mean(patches[k], swept));
            both[k].push_back(photons[k].back() + rest[k].back());
        }
    }
    const NarrowChannel standing;
    const double bias = NarrowChannel::bias(kRoughness[1]);
    // Over what passes in a strip: either class, and what lamps in the wrong place would change.
    double largest_photons = 0;
    double largest_rest = 0;
    double largest_turn = 0;
    for (std::size_t k = 0; k < patches.size(); ++k) {
        const SampleMean exact = traced_irradiance(channel_, patches[k], channel_.maps, 1, 4096, k);
        const SampleMean error = difference(estimate_of(both[k]), exact);
        EXPECT_TRUE(agrees(error, 0, bias * exact.mean))
            << "patch " << k << ": " << estimate_of(both[k]).mean << ", " << exact.mean << " +- "
            << error.standard_error;
        if (k >= kNumStrips) continue;
        const double tolerance = bias * exact.mean + 3 * error.standard_error;
        largest_photons = std::max(largest_photons, estimate_of(photons[k]).mean / tolerance);
        largest_rest = std::max(largest_rest, estimate_of(rest[k]).mean / tolerance);
        const SampleMean unturned =
            traced_irradiance(standing, patches[k], channel_.maps, 1, 2048, k);
        largest_turn = std::max(largest_turn, std::abs(unturned.mean - exact.mean) / tolerance);
    }
    EXPECT_GT(largest_photons, 2) << "the test would see nothing";
    EXPECT_GT(largest_rest, 2) << "the test would see nothing";
    EXPECT_GT(largest_turn, 2) << "the test would see nothing";
}

TEST_F(NarrowLobesUnderTurningLamps, AreTheSameForAnyNumberOfThreads) {
    const auto light = [&](int threads) {
        const ThreadLimit limit(threads);
        NarrowLobes narrow = channel_.narrow_lobes(3);
        (void)narrow.follow(channel_.maps);
        return narrow.irradiance(0);
    };
    EXPECT_TRUE(same_bytes(light(1), light(2)));
}

}  // namespace
}  // namespace patina
