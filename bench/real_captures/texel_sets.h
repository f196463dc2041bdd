// Which texels are compared, and how their values spread.
#pragma once

#include "patina/scene/atlas.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace patina {

// Texels of the atlas, ascending.
using TexelSet = std::vector<TexelId>;

// Seen texels with nothing but seen texels within `margin` rows and columns of them. seen: one per
// texel of the atlas.
[[nodiscard]] TexelSet inner_texels(const TexelAtlas& atlas,
                                    std::span<const std::uint8_t> seen,
                                    int margin);

[[nodiscard]] TexelSet select(const TexelSet& texels, const std::function<bool(TexelId)>& holds);

// NaN throughout when there are no values.
struct Spread {
    std::size_t count = 0;
    double median = 0;
    double low = 0;                       // 16th percentile
    double high = 0;                      // 84th percentile
    double coefficient_of_variation = 0;  // standard deviation over mean [-]
    double p95_over_p50 = 0;              // [-]
};
[[nodiscard]] Spread spread_of(const TexelSet& texels, const std::function<double(TexelId)>& value);

}  // namespace patina
