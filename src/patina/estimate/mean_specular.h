// Ps of a texel about that of its neighbours, for the errors that are a share of Ps.
#pragma once

#include "patina/estimate/texel_turn.h"
#include "patina/scene/atlas.h"

#include <span>
#include <vector>

namespace patina {

// Mean of the measured Ps over four rings round every texel that measured one, over its own Ps [-];
// 1 elsewhere. Errors of Ps are a share of Ps: reckoned from one that came out too low by chance
// they are too small, and too large from one that came out too high.
[[nodiscard]] std::vector<double> mean_over_own_specular(const TexelAtlas& atlas,
                                                         std::span<const Reflectance> maps,
                                                         std::span<const TexelFit> fits);

}  // namespace patina
