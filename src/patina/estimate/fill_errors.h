// How far a filled lobe may be from the truth: as far as measured lobes differ from each other at
// the distance from which it was filled. docs/uncertainty.md.
#pragma once

#include "patina/estimate/lobe_variogram.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// Standard errors, one entry per texel; zero for measured ones, +infinity where no lobe was
// measured to judge by. errors: standard errors of the measured lobes.
//
// A variogram: the mean squared difference of ln sigma and of ln(Ps sigma^2) between measured
// texels of like Pd, so many texels apart along rows and columns, less their own errors; read at
// the distance over the surface to the nearest measured texel, whose own error comes on top: what
// it errs, all that it fills errs with it.
[[nodiscard]] std::vector<LobeSpread> fill_errors(const TexelAtlas& atlas,
                                                  std::span<const Reflectance> maps,
                                                  std::span<const Reflectance> errors,
                                                  std::span<const std::uint8_t> measured);

}  // namespace patina
