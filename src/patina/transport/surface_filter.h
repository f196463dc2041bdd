// A linear filter over the surface for light that varies slowly on it.
//
// Based on: Fan. Local Linear Regression Smoothers and Their Minimax Efficiencies. 1993.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/scene/atlas.h"

#include <cstddef>
#include <vector>

namespace patina {

// Compressed rows: value(x) <- sum weight value(texel) over [begin[x], begin[x + 1]).
struct SurfaceFilter {
    std::vector<std::size_t> begin;
    LargeVector<TexelId> texel;
    LargeVector<float> weight;
};

// Local linear regression over the texels within `radius` texel sizes about each one (> 0; with the
// predicates of the ratio kernel): values that form a plane over the tangent plane pass unchanged,
// also beside an edge, where the neighbours lie on one side only. Texels with too few neighbours
// keep their own value. Weights add up to 1; some may be negative beside edges.
[[nodiscard]] SurfaceFilter build_surface_filter(const TexelAtlas& atlas, double radius);

}  // namespace patina
