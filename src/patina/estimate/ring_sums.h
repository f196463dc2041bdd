// Sums over the texels round each texel.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/base/parallel.h"
#include "patina/scene/atlas.h"

namespace patina {

// Each element becomes the sum of itself and of its neighbours on the surface, `rings` times over.
// Value: a type with +=.
template <typename Value>
void sum_over_rings(const TexelAtlas& atlas, int rings, LargeVector<Value>& values) {
    for (int ring = 0; ring < rings; ++ring) {
        const LargeVector<Value> before = values;
        parallel_for(values.size(), [&](std::size_t i) {
            for (std::uint32_t k = atlas.neighbor_begin[i]; k < atlas.neighbor_begin[i + 1]; ++k) {
                values[i] += before[atlas.neighbors[k]];
            }
        });
    }
}

}  // namespace patina
