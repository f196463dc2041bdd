#include "patina/transport/direct.h"

#include "patina/base/parallel.h"

namespace patina {
namespace {

// Marks texels within one ring of a texel in another state. was: the states before.
void grow_edges(const TexelAtlas& atlas,
                const std::vector<ShadowState>& was,
                LargeVector<DirectLight>& result) {
    parallel_for(atlas.texels.size(), [&](std::size_t i) {
        for (std::uint32_t k = atlas.neighbor_begin[i]; k < atlas.neighbor_begin[i + 1]; ++k) {
            if (was[atlas.neighbors[k]] != was[i]) result[i].state = ShadowState::edge;
        }
    });
}

}  // namespace

LargeVector<DirectLight> direct_light(const Surface& surface,
                                      const TexelAtlas& atlas,
                                      const Light& light,
                                      int edge_rings) {
    LargeVector<DirectLight> result(atlas.texels.size());
    parallel_for(atlas.texels.size(), [&](std::size_t i) {
        const Texel& texel = atlas.texels[i];
        const LightSample sample = sample_light(light, texel.point.position, texel.azimuth);
        DirectLight& direct = result[i];
        direct.w_i = sample.w_i.cast<float>();
        const double cos_i = texel.point.normal.dot(sample.w_i);
        direct.cos_i = float(cos_i);
        if (!is_lit(surface, texel.point, sample)) return;
        direct.irradiance = (sample.irradiance * cos_i).cast<float>();
        direct.state = ShadowState::lit;
    });
    for (int ring = 0; ring < edge_rings; ++ring) {
        std::vector<ShadowState> was(result.size());
        for (std::size_t i = 0; i < was.size(); ++i) was[i] = result[i].state;
        grow_edges(atlas, was, result);
    }
    return result;
}

}  // namespace patina
