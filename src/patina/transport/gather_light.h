// The lamps' direct light where the gather graph meets the surface, lamps side by side in lanes.
//
// Lamps that stand still light a texel in the same way whoever looks at it: one row per texel.
// Lamps that turn with the scanner stand elsewhere for every column, so there every hit has a row
// of its own, with its own shadow rays, for the azimuth of the texel that gathers.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/math/lanes.h"
#include "patina/transport/gather_graph.h"
#include "patina/transport/photon_paths.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patina {

// Lamps are worked through in blocks of so many, side by side: one register of single-precision
// lanes, and in 16 bits one line of memory for what a hit reads of a texel.
inline constexpr std::size_t kLampLanes = kLanes;

// Up to kLampLanes lamps.
struct LampBlock {
    std::vector<const Light*> lights;
    std::vector<const LargeVector<DirectLight>*> direct;  // per lamp, per texel of the atlas

    [[nodiscard]] std::size_t size() const { return lights.size(); }
};

[[nodiscard]] Rgb lamp_color(const Light& light);

// Light is held per white lamp of unit strength (a lamp's colour and strength, which all of its
// light shares, are lamp_color()), and in units near what the lamp sends to the surface: powers of
// two, so that 16 bits hold it whatever the unit of length [1/length^2; 1 for directional lamps].
[[nodiscard]] Lanes light_units(const TexelAtlas& atlas, const LampBlock& lamps);

// What standing lamps send to a texel. Lanes without a lamp are dark.
struct LitTexel {
    Lanes irradiance{};   // cosine included; zero where dark [light_units()]
    Lanes over_cosine{};  // the same over max(cos_i, c0)
};

// How a hit sees the image of standing lamps in the lobe of the place that it meets.
struct StandingHit {
    CompactLanes theta_squared{};   // of the mirror angle between lamp and gathering texel [rad^2]
    std::uint16_t over_cosine = 0;  // 1 / max(cos_o, c0) [-]
};

// What turning lamps send to one hit.
struct TurningHit {
    CompactLanes irradiance{};     // [light_units()]
    CompactLanes over_cosine{};    // the same over max(cos_i, c0) max(cos_o, c0)
    CompactLanes theta_squared{};  // see StandingHit
};

// What the lamps send to one texel when the scanner stands at its column.
[[nodiscard]] LitTexel lit_texel(const LampBlock& lamps, const Lanes& units, std::size_t texel);

// One entry per texel of the atlas.
[[nodiscard]] std::vector<LitTexel> lit_texels(const TexelAtlas& atlas,
                                               const LampBlock& lamps,
                                               const Lanes& units);

// One entry per hit of the rows.
[[nodiscard]] LargeVector<StandingHit> standing_hits(const TexelAtlas& atlas,
                                                     const LampBlock& lamps,
                                                     const GatherRows& rows);

// One entry per hit of the rows, at the azimuth of the texel that the row belongs to.
[[nodiscard]] LargeVector<TurningHit> turning_hits(const Surface& surface,
                                                   const TexelAtlas& atlas,
                                                   const LampBlock& lamps,
                                                   const Lanes& units,
                                                   const GatherRows& rows);

}  // namespace patina
