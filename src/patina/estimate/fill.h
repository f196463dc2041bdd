// The paper's filling of what was not measured: linear interpolation along the texture.
//
// Based on: Machida, Takemura, Yokoya. 2004, section 3 (along what is not said; here along the
// texel's row and its column).
#pragma once

#include "patina/scene/atlas.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// values: one per texel; measured: 1 where the value holds. Every other value becomes the mean,
// weighted by 1/distance, of the nearest measured values to the left, right, above and below in its
// own chart and surface (which is linear interpolation between two); the median of all measured
// values where there is none in its row and column. Rows go around where the atlas does. fallback:
// when nothing is measured.
void interpolate_linearly(const TexelAtlas& atlas,
                          std::span<const std::uint8_t> measured,
                          double fallback,
                          std::span<double> values);

}  // namespace patina
