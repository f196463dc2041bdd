#include "patina/plan/lamp_orders.h"

#include "patina/base/parallel.h"
#include "patina/base/random.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/lit_scene.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace patina {
namespace {

using testing::ElementsAre;

constexpr std::size_t kTexels = 60;
constexpr std::size_t kLamps = 9;

const SupposedSurface& surface() {
    static const SupposedSurface surface{SurfacePrior{}};
    return surface;
}

// Lamps that each light some of the texels, from random directions.
std::vector<LookGradients> random_lamps(std::uint64_t seed, std::size_t count = kLamps) {
    std::vector<LookGradients> lamps;
    for (std::size_t lamp = 0; lamp < count; ++lamp) {
        LookTable looks;
        looks.begin.push_back(0);
        Rng rng(seed, Pass::tests, lamp);
        const double share = 0.1 + 0.5 * rng.uniform();
        for (std::size_t i = 0; i < kTexels; ++i) {
            if (rng.uniform() < share) {
                looks.terms.push_back({float(0.5 + rng.uniform()),
                                       float(square(0.8 * rng.uniform())),
                                       float(1 + rng.uniform()),
                                       false});
            }
            looks.begin.push_back(std::uint32_t(looks.terms.size()));
        }
        lamps.push_back(look_gradients(looks, surface(), {1e-5, 2e-5, 0.01}));
    }
    return lamps;
}

// The sum of the gains, in any order the rise of log det by all of them.
double information(const std::vector<LookGradients>& lamps,
                   const std::vector<std::size_t>& subset) {
    Knowledge known(surface(), kTexels);
    double sum = 0;
    for (const std::size_t lamp : subset) {
        sum += known.gain(lamps[lamp]);
        known.add(lamps[lamp]);
    }
    return sum;
}

std::vector<std::size_t> plain_greedy(const std::vector<LookGradients>& lamps) {
    Knowledge known(surface(), kTexels);
    std::vector<std::size_t> picks;
    while (picks.size() < lamps.size()) {
        std::vector<double> gains;
        for (std::size_t i = 0; i < lamps.size(); ++i) {
            const bool is_taken = std::find(picks.begin(), picks.end(), i) != picks.end();
            gains.push_back(is_taken ? -1 : known.gain(lamps[i]));
        }
        picks.push_back(std::size_t(std::max_element(gains.begin(), gains.end()) - gains.begin()));
        known.add(lamps[picks.back()]);
    }
    return picks;
}

TEST(ChooseByInformation, LazyIsPlainGreedy) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const std::vector<LookGradients> lamps = random_lamps(seed, 24);
        const GreedyPicks lazy = choose_by_information(Knowledge(surface(), kTexels), lamps, {});
        EXPECT_EQ(lazy.picks, plain_greedy(lamps)) << "seed " << seed;
        EXPECT_FALSE(lazy.next.has_value());
        EXPECT_LT(lazy.num_evaluations, 24U * 25U / 2);
    }
}

TEST(ChooseByInformation, ReachesTheGreedyBoundOfTheBestChoice) {
    for (std::uint64_t seed = 100; seed < 110; ++seed) {
        const std::vector<LookGradients> lamps = random_lamps(seed);
        const GreedyPicks greedy = choose_by_information(Knowledge(surface(), kTexels), lamps, {});
        std::array<double, kLamps + 1> best{};
        for (unsigned bits = 1; bits < (1U << kLamps); ++bits) {
            std::vector<std::size_t> subset;
            for (std::size_t i = 0; i < kLamps; ++i) {
                if ((bits >> i & 1U) != 0) subset.push_back(i);
            }
            best[subset.size()] = std::max(best[subset.size()], information(lamps, subset));
        }
        double value = 0;
        for (std::size_t size = 1; size <= kLamps; ++size) {
            value += greedy.gains[size - 1];
            EXPECT_GE(value, (1 - std::exp(-1.0)) * best[size]) << "seed " << seed;
            // Sums of rounded logarithms differ with the order.
            EXPECT_LE(value, best[size] * (1 + 1e-9)) << "seed " << seed;
        }
    }
}

TEST(ChooseByInformation, StopsAtSmallGainsAndSaysWhatComesNext) {
    const std::vector<LookGradients> lamps = random_lamps(3);
    const Knowledge nothing(surface(), kTexels);
    const GreedyPicks all = choose_by_information(nothing, lamps, {});
    GreedyOptions options;
    options.max_picks = 3;
    const GreedyPicks three = choose_by_information(nothing, lamps, options);
    EXPECT_EQ(three.picks, std::vector(all.picks.begin(), all.picks.begin() + 3));
    EXPECT_EQ(three.next, all.picks[3]);
    options = {};
    options.min_gain = 0.5 * (all.gains[4] + all.gains[5]);
    EXPECT_EQ(choose_by_information(nothing, lamps, options).picks.size(), 5U);
    options.min_picks = 7;
    EXPECT_EQ(choose_by_information(nothing, lamps, options).picks.size(), 7U);
}

TEST(ChooseByInformation, TakesTheFirstOfEqualLampsAndNoneThatShowsNothing) {
    std::vector<LookGradients> lamps = random_lamps(4, 1);
    lamps.insert(lamps.begin(), LookGradients{std::vector<std::uint32_t>(kTexels + 1, 0), {}});
    lamps.push_back(lamps[1]);
    const GreedyPicks picks = choose_by_information(Knowledge(surface(), kTexels), lamps, {});
    EXPECT_THAT(picks.picks, ElementsAre(1, 2));
    EXPECT_EQ(picks.next, 0U);
}

TEST(ChooseByInformation, IsTheSameForAnyNumberOfThreads) {
    const std::vector<LookGradients> lamps = random_lamps(5, 24);
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        return choose_by_information(Knowledge(surface(), kTexels), lamps, {}).gains;
    };
    EXPECT_EQ(run(1), run(4));
}

TEST(UniformOrder, TakesTheMiddleThenTheFurthest) {
    std::vector<Light> lamps;
    for (const double x : {0.0, 1.0, 2.0, 3.0, 4.0}) lamps.push_back(point_light({x, 0, 1}, 1));
    EXPECT_THAT(uniform_order(lamps, Vec3::Zero()), ElementsAre(2, 0, 4, 1, 3));
}

TEST(RandomOrder, IsAPermutationOfItsOwnForEachDraw) {
    const std::vector<std::size_t> first = random_order(60, 1, 0);
    EXPECT_NE(first, random_order(60, 1, 1));
    EXPECT_NE(first, random_order(60, 2, 0));
    EXPECT_EQ(first, random_order(60, 1, 0));
    std::vector<std::size_t> expected(60);
    std::iota(expected.begin(), expected.end(), std::size_t(0));
    EXPECT_TRUE(std::is_permutation(first.begin(), first.end(), expected.begin()));
}

}  // namespace
}  // namespace patina
