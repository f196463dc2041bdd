// How much measured lobes differ at a distance: a variogram of ln(Ps sigma^2) and of ln sigma.
//
// Based on: Matheron. Principles of Geostatistics. Economic Geology 58(8), 1963.
#pragma once

#include "patina/reflectance/lobe.h"
#include "patina/scene/atlas.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// A pair of numbers for a lobe's logarithms [-]: of ln(Ps sigma^2) and of ln sigma.
struct LobeSpread {
    double specular_albedo;
    double roughness;

    LobeSpread& operator+=(const LobeSpread& other);
};

// Variances of a measured lobe's own errors. Errors of Ps and sigma go against each other, so that
// their product is known better than this.
[[nodiscard]] LobeSpread own_variance(const Reflectance& map, const Reflectance& error);

// Mean squared differences between measured texels of like Pd, one distance along rows and columns.
struct LobeDifferences {
    LobeSpread whole = {0, 0};  // as they are
    LobeSpread own = {0, 0};    // of them, what the texels' own errors make up
    double count = 0;           // pairs

    LobeDifferences& operator+=(const LobeDifferences& other);
};

class LobeVariogram {
  public:
    // One entry per texel. errors: standard errors of the measured lobes.
    LobeVariogram(const TexelAtlas& atlas,
                  std::span<const Reflectance> maps,
                  std::span<const Reflectance> errors,
                  std::span<const std::uint8_t> measured);

    // lag: distance [texels]. Sums instead of means where it tells() nothing.
    [[nodiscard]] LobeDifferences at(int lag) const;
    // Whether so many pairs say anything.
    [[nodiscard]] static bool tells(const LobeDifferences& differences);

  private:
    void add_pair(std::size_t i, int column, int row, LobeDifferences& sums) const;

    const TexelAtlas& atlas_;
    std::span<const Reflectance> maps_;
    std::span<const Reflectance> errors_;
    std::span<const std::uint8_t> measured_;
};

}  // namespace patina
