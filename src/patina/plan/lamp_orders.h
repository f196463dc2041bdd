// Orders in which lamps may be taken: by information, and the two that a planner has to beat.
//
// Based on: Nemhauser, Wolsey, Fisher. An Analysis of Approximations for Maximizing Submodular Set
// Functions. 1978 (the bound 1 - 1/e). Minoux. Accelerated Greedy Algorithms for Maximizing
// Submodular Set Functions. 1978 (lazy evaluation).
#pragma once

#include "patina/plan/information.h"
#include "patina/scene/light.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace patina {

struct GreedyOptions {
    std::size_t max_picks = std::numeric_limits<std::size_t>::max();
    double min_gain = 0;        // stops when the best pick gains less [nat]; >= 0
    std::size_t min_picks = 0;  // but not before there are so many that gain anything
};

struct GreedyPicks {
    std::vector<std::size_t> picks;   // positions in the list of candidates, in order of choice
    std::vector<double> gains;        // of each when it was taken [nat]
    std::optional<std::size_t> next;  // the best one left; nothing when all were taken
    std::size_t num_evaluations = 0;  // of Knowledge::gain()
};

// Takes the candidate with the largest gain, ties to the lower position, again and again. Lazy: a
// gain never grows as others are taken, so a candidate whose last gain is below the best one found
// needs no second look. known: before the first pick. candidates: the looks of each.
[[nodiscard]] GreedyPicks choose_by_information(Knowledge known,
                                                std::span<const LookGradients> candidates,
                                                const GreedyOptions& options);

// Evenly spread: the lamp nearest to the middle first, then always the one that is furthest from
// all before it; ties to the lower position. Point lamps by position, and when one of the lamps is
// directional all by direction from the centre.
[[nodiscard]] std::vector<std::size_t> uniform_order(std::span<const Light> lamps,
                                                     const Vec3& center);

// A permutation of [0, count) at random, keyed by seed and draw.
[[nodiscard]] std::vector<std::size_t> random_order(std::size_t count,
                                                    std::uint64_t seed,
                                                    std::uint64_t draw);

}  // namespace patina
