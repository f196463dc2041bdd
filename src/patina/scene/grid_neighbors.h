// Neighbours of a texel by their place in the texel domain.
#pragma once

#include "patina/scene/atlas.h"

#include <array>

namespace patina {

// The neighbours to the left, to the right, above and below in the texel domain, kNoTexel where the
// surface has none there.
using GridNeighbors = std::array<TexelId, 4>;
[[nodiscard]] GridNeighbors grid_neighbors(const TexelAtlas& atlas, std::size_t texel);

}  // namespace patina
