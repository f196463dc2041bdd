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

// For which lamps the filter lowers the mean squared error of the light at a texel, summed over
// channels: bit l for lane l. Each lamp is judged by its own light, so that it sends what it would
// send alone.
using LampMask = std::uint8_t;

// One entry per texel. With d the difference of the two halves before the filter, e after it, and m
// what the filter changes their mean by, m^2 - (d^2 - d e) / 2 is in expectation by how much it
// raises the error: m holds bias and noise, d and e noise alone. It is averaged over the filter's
// texels, over theirs, and once more, before its sign is read.
[[nodiscard]] std::vector<LampMask> where_filter_gains(const SurfaceFilter& filter,
                                                       const LargeVector<LightHalves>& light);

// Light filtered for the lamps of the mask, and as it is for the others.
[[nodiscard]] LightHalves filtered_for(LampMask lamps,
                                       const SurfaceFilter& filter,
                                       const LargeVector<LightHalves>& light,
                                       std::size_t texel);

}  // namespace patina
