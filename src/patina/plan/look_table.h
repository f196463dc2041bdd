// The geometry of looks at texels: all that a plan needs to know of them.
#pragma once

#include "patina/plan/rig_view.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// One lamp's part of a look at one texel.
struct LookTerm {
    float irradiance = 0;       // mean of the channels, cosine included [radiance x sr]
    float theta_r_squared = 0;  // [rad^2]
    float lobe_cosines = 0;     // lobe_cosines() [-]
    bool is_joined = false;     // one exposure with the term before
};

// Looks at some texels, compressed rows.
struct LookTable {
    std::vector<std::uint32_t> begin;  // texels + 1 offsets into terms
    std::vector<LookTerm> terms;

    [[nodiscard]] std::span<const LookTerm> of(std::size_t texel) const {
        return std::span(terms).subspan(begin[texel], begin[texel + 1] - begin[texel]);
    }
};

// The texels that a plan looks at, a sample of those that some camera sees, and how the rig's
// cameras see them.
struct PlanTexels {
    std::vector<TexelId> ids;                   // ascending
    std::vector<std::vector<TexelView>> views;  // per camera, per id
};

// At most `max_count` of the seen texels (0: all), one at random from each of as many runs of equal
// length. The same for the same seed.
[[nodiscard]] PlanTexels sample_texels(const RigView& rig,
                                       std::size_t max_count,
                                       std::uint64_t seed);

// values: per texel of the atlas. The values of some texels.
template <typename Values>
[[nodiscard]] auto values_at(std::span<const TexelId> texels, const Values& values) {
    std::vector<typename Values::value_type> picked;
    picked.reserve(texels.size());
    for (const TexelId texel : texels) picked.push_back(values[texel]);
    return picked;
}

// The light of lamps that are lit together, one entry per texel in each.
using LampLight = std::span<const std::vector<DirectLight>* const>;

// Usable looks at `texels` through one camera. lamps, views: one entry per entry of texels. A look
// counts when one of the lamps lights it within the limits and none has its shadow's edge there.
[[nodiscard]] LookTable collect_looks(const TexelAtlas& atlas,
                                      std::span<const TexelId> texels,
                                      LampLight lamps,
                                      std::span<const TexelView> views,
                                      const LookLimits& limits);

// The rows of the tables one behind the other. All of num_texels texels.
[[nodiscard]] LookTable join_tables(std::span<const LookTable> tables, std::size_t num_texels);

}  // namespace patina
