// The surface filter on the gathered light of a lamp block, and where it lowers the error of that
// light.
//
// Based on: Rousselle, Knaus, Zwicker. Adaptive Rendering with Non-Local Means Filtering. 2012
// (two independent halves tell what a filter leaves of noise and what it adds of bias).
#pragma once

#include "patina/base/large_vector.h"
#include "patina/math/lanes.h"
#include "patina/transport/surface_filter.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace patina {

// Light of eight lamps at one texel, three channels, by two independent halves of its rays.
using LightHalves = std::array<std::array<Lanes, 3>, 2>;

// What the filter makes of one texel; not below 0, as its weights may be.
[[nodiscard]] LightHalves filtered(const SurfaceFilter& filter,
                                   const LargeVector<LightHalves>& light,
                                   std::size_t texel);

// One entry per texel: 1 where the filter lowers the mean squared error of the light, summed over
// lamps and channels, else 0. With d the difference of the two halves before the filter, e after
// it, and m what the filter changes their mean by, m^2 - (d^2 - d e) / 2 is in expectation by how
// much it raises that error: m holds bias and noise, d and e noise alone. It is averaged over the
// filter's texels, and over theirs, before its sign is read.
[[nodiscard]] std::vector<std::uint8_t> where_filter_gains(const SurfaceFilter& filter,
                                                           const LargeVector<LightHalves>& light);

}  // namespace patina
