// The lamps' direct light where the gather graph meets the surface, lamps side by side in lanes.
//
// Lamps that stand still light a texel in the same way whoever looks at it: one row per texel.
// Lamps that turn with the scanner stand elsewhere for every column, so there every hit has a row
// of its own, with its own shadow rays, for the azimuth of the texel that gathers.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/transport/gather_graph.h"
#include "patina/transport/photon_paths.h"

#include <array>
#include <cstddef>
#include <vector>

namespace patina {

// Lamps are worked through in blocks of so many, side by side.
inline constexpr std::size_t kLampLanes = 16;
using Lanes = std::array<float, kLampLanes>;

// Up to kLampLanes lamps.
struct LampBlock {
    std::vector<const Light*> lights;
    std::vector<const std::vector<DirectLight>*> direct;  // per lamp, per texel of the atlas

    [[nodiscard]] std::size_t size() const { return lights.size(); }
};

// What the lamps of a block send to every texel. Per white lamp of unit strength: a lamp's colour
// and strength, which all of its light shares, are lamp_color(). Lanes without a lamp are dark.
struct LitTexels {
    // What the image of the lamps in a lobe needs, in 16 bits: a hit on a lobe reads it from
    // anywhere in memory. Errors: 0.2 % of the light, 3e-5 of the directions.
    struct alignas(32) Mirror {
        std::array<std::uint16_t, kLampLanes> over_cosine{};  // irradiance over max(cos_i, c0), as
                                                              // the upper halves of floats
        std::array<std::int16_t, kLampLanes> x{}, y{}, z{};   // towards the lamp [1 / kDirection]
    };
    static constexpr float kDirection = 32767;

    std::vector<Lanes> irradiance;  // cosine included; zero where dark [1/length^2; 1 for
                                    // directional lamps]
    LargeVector<Mirror> mirror;
};
// What they send to one hit, in 16 bits: the upper halves of the floats, rounded to nearest.
struct alignas(32) CompactLanes {
    using Halves = std::array<std::uint16_t, kLampLanes>;
    Halves irradiance{};
    Halves over_cosine{};
    Halves versine{};  // 1 - cosine of the mirror angle between the lamp and the gathering texel
};

[[nodiscard]] Rgb lamp_color(const Light& light);

// One entry per texel of the atlas.
[[nodiscard]] LitTexels lit_texels(const TexelAtlas& atlas, const LampBlock& lamps);

// One entry per hit of the rows, at the azimuth of the texel that the row belongs to.
[[nodiscard]] std::vector<CompactLanes> hit_lanes(const Surface& surface,
                                                  const TexelAtlas& atlas,
                                                  const LampBlock& lamps,
                                                  const GatherRows& rows);

}  // namespace patina
