#include "patina/scene/grid_neighbors.h"

#include <cstdlib>

namespace patina {

GridNeighbors grid_neighbors(const TexelAtlas& atlas, std::size_t texel) {
    const Texel& self = atlas.texels[texel];
    const std::array<std::array<int, 2>, 4> steps = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
    GridNeighbors result;
    result.fill(kNoTexel);
    for (std::uint32_t k = atlas.neighbor_begin[texel]; k < atlas.neighbor_begin[texel + 1]; ++k) {
        const Texel& other = atlas.texels[atlas.neighbors[k]];
        if (other.chart != self.chart) continue;
        int across = other.column - self.column;
        if (atlas.wraps_around && std::abs(across) == atlas.width - 1) across = across > 0 ? -1 : 1;
        for (std::size_t s = 0; s < steps.size(); ++s) {
            if (steps[s] == std::array<int, 2>{across, other.row - self.row}) {
                result[s] = atlas.neighbors[k];
            }
        }
    }
    return result;
}

}  // namespace patina
