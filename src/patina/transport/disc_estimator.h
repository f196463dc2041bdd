// The classical photon-map irradiance: the power of the k nearest photons over the disc that their
// ball cuts out of a plane.
//
// Based on: Jensen. Realistic Image Synthesis Using Photon Mapping. 2001, section 7.
// Kept for comparison with the ratio estimator only: the disc is not the surface inside the ball at
// edges, in corners and at silhouettes (docs/theory.md, "Density estimation").
#pragma once

#include "patina/transport/ratio_kernel.h"

#include <span>
#include <vector>

namespace patina {

struct DiscOptions {
    int neighbors = 100;         // k, photons in the disc; >= 2
    bool correct_count = true;   // k - 1 of k photons, which is unbiased on a plane
    bool normal_filter = false;  // only photons on a surface that faces as the query does count
};

// Spans of one length. normals (unit): may be empty unless DiscOptions::normal_filter is set.
struct DiscPhotons {
    std::span<const Vec3f> positions;  // [length]
    std::span<const Rgbf> powers;      // [radiance x sr x length^2]
    std::span<const Vec3f> normals;
};
struct DiscQueries {
    std::span<const Vec3f> positions;  // [length]
    std::span<const Vec3f> normals;
};

// Irradiance at every query [radiance x sr]. Where there are fewer than k photons all of them
// count; zero where there are fewer than two.
[[nodiscard]] std::vector<Rgbf> disc_irradiance(const DiscPhotons& photons,
                                                const DiscQueries& queries,
                                                const DiscOptions& options);

// The same at every texel, of the two halves of traced photons; each half takes half of
// options.neighbors. paths: traced with PhotonOptions::keep_positions, and their power. Without
// options.normal_filter, for the photons' normals are not stored.
[[nodiscard]] std::vector<IndirectIrradiance> disc_indirect_irradiance(const PhotonPaths& paths,
                                                                       std::span<const Rgbf> power,
                                                                       const TexelAtlas& atlas,
                                                                       const DiscOptions& options);

}  // namespace patina
