// A look shows the mean of a footprint, the maps speak of a texel's centre: how far the two differ,
// judged by how the maps themselves vary from texel to texel. docs/uncertainty.md.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/estimate/error_propagation.h"
#include "patina/scene/atlas.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// Variance of (mean over the footprint - value at the centre), per texel; zero where too few
// neighbours are observed to tell.
//
// Where the maps are smooth the difference is moment/2 times their Laplacian; at an edge that is
// narrower than a texel it is up to seven times that. How narrow the edges are is told by the
// second differences over one and over two texels: the factor follows their ratio as it does at
// edges of Gaussian profile (1/4 on smooth maps, 1/sqrt(3) at jumps). What lies beyond that ratio
// is noise.
//
// noise: variance of the maps' own errors, whose second differences are taken off. moment: second
// moment of a footprint along one axis [texel^2].
[[nodiscard]] LargeVector<Parameters> footprint_blur(const TexelAtlas& atlas,
                                                     std::span<const Parameters> maps,
                                                     std::span<const Parameters> noise,
                                                     std::span<const std::uint8_t> observed,
                                                     double moment);

}  // namespace patina
