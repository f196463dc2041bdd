// What lobes send on of light that comes from other texels, over the second rays of the gather
// graph: the part of a sweep (gather_sweep.h) that follows the light one place further back.
#pragma once

#include "patina/math/lanes.h"
#include "patina/reflectance/lobe_lanes.h"
#include "patina/transport/gather_graph.h"
#include "patina/transport/radiant_texels.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace patina {

// All light that a texel sends out, spread evenly over directions [light_units()].
struct alignas(64) OnwardRow {
    std::array<CompactLanes, 3> radiance{};
};

struct GlossySources {
    const LargeVector<GlossyLobe>& lobes;  // per texel
    const LargeVector<OnwardRow>& onward;  // per texel; empty: none
};

namespace detail {

// Second rays further from the mirror direction than this Gaussian's value are left out: that takes
// as large a part of the lobe's light with it.
inline constexpr float kNegligibleGaussian = 1e-3f;

}  // namespace detail

// Asks for what add_glossy() will read of a glossy hit of a row whose hits begin at `hits`.
inline void expect_glossy(const GlossySources& sources,
                          const GatherHit* hits,
                          const GlossyHit& glossy) {
    __builtin_prefetch(&sources.lobes[hits[glossy.hit].to]);
    __builtin_prefetch(&sources.onward[glossy.to]);
}

// add(hit, gain, radiance) for glossy hits [first, last) of a row whose hits begin at `hits`: the
// first ray of number `hit` brings gain x radiance more. last - first <= kLanes.
template <typename Add>
inline void add_glossy(const GlossySources& sources,
                       const GatherHit* hits,
                       const GlossyHit* first,
                       const GlossyHit* last,
                       const Add& add) {
    Lanes exponent{}, gain{};
    const auto count = std::size_t(last - first);
    for (std::size_t l = 0; l < count; ++l) {
        const GlossyLobe& lobe = sources.lobes[hits[first[l].hit].to];
        exponent[l] = lobe.minus_half_precision * from_compact(first[l].theta_squared);
        gain[l] = lobe.specular * first[l].weight;
    }
    const Lanes gaussian = exp_of_negative(exponent);
    for (std::size_t l = 0; l < count; ++l) {
        if (gain[l] == 0 || gaussian[l] < detail::kNegligibleGaussian) continue;
        const OnwardRow& row = sources.onward[first[l].to];
        const std::array<Lanes, 3> radiance = {from_compact(row.radiance[0]),
                                               from_compact(row.radiance[1]),
                                               from_compact(row.radiance[2])};
        add(std::size_t(first[l].hit), gain[l] * gaussian[l], radiance);
    }
}

}  // namespace patina
