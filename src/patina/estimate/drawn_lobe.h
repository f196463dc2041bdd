// Measured lobes drawn towards those of their neighbours: each as far as its own errors are large
// beside what neighbours differ by. docs/theory.md, "Measured lobes and their neighbours".
//
// Based on: Robinson. That BLUP is a Good Thing: The Estimation of Random Effects. Statistical
// Science 6(1), 1991.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/estimate/informed_lobe.h"
#include "patina/estimate/texel_turn.h"
#include "patina/scene/atlas.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace patina {

// What the neighbours of a texel say of its lobe; of no precision where none is measured.
struct LobePrior {
    Eigen::Matrix2d precision = Eigen::Matrix2d::Zero();  // of a LogLobe
    LogLobe pull = LogLobe::Zero();                       // precision x the lobe expected
};

// How much the lobes of neighbours of like Pd differ, their errors aside: a variogram of the
// measured ones at one texel, read so that what changes from texel to texel without any trend to
// the second one counts as error. Infinite where too few are measured to say.
[[nodiscard]] LobeSpread neighbor_spread(const TexelAtlas& atlas, std::span<const TexelFit> fits);

// One entry per texel. Of every measured texel of two rings its own lobe with the errors of its own
// looks, and with `between` times the distance, longer over weak links; less of those that differ
// by more than that, which lie across a border. links: one per entry of atlas.neighbors, in (0, 1].
[[nodiscard]] LargeVector<LobePrior> neighbor_priors(const TexelAtlas& atlas,
                                                     std::span<const float> links,
                                                     std::span<const TexelFit> fits,
                                                     const LobeSpread& between);

// The most probable lobe. own: of the texel's own looks, which tell `information` of it.
[[nodiscard]] LogLobe drawn_lobe(const LogLobe& own,
                                 const Eigen::Matrix2d& information,
                                 const LobePrior& prior);

}  // namespace patina
