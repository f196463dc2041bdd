// Direct light at every texel: computed, never sampled.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/transport/surface.h"

namespace patina {

enum class ShadowState : std::uint8_t {
    dark,  // behind another surface, or facing away
    edge,  // lit, but a neighbouring texel is dark, or the reverse: the shadow's edge lies here
    lit
};

// What one lamp sends to one texel.
struct DirectLight {
    Rgbf irradiance =
        Rgbf::Zero();  // on the surface, smooth normal's cosine; zero where dark [radiance x sr]
    Vec3f w_i = Vec3f::UnitZ();  // unit, towards the lamp
    float cos_i = 0;             // to the smooth normal [-]
    ShadowState state = ShadowState::dark;
};

// One entry per texel of the atlas. Lamps that turn with a scanner stand at the azimuth of each
// texel's column. edge_rings: how many rings of neighbours about a shadow's edge count as edge;
// >= 1.
[[nodiscard]] LargeVector<DirectLight> direct_light(const Surface& surface,
                                                    const TexelAtlas& atlas,
                                                    const Light& light,
                                                    int edge_rings = 1);

}  // namespace patina
