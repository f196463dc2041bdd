// The ratio estimator of irradiance: power over area, summed with the same weights and the same
// predicates, so that it is right at edges and in corners where disc estimators are not.
//
//     E(x) = sum_p kappa(x, p) dPhi_p / sum_y kappa(x, y) A_y
//
// Photons are located to their texel. docs/theory.md derives it and compares it with the disc.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/transport/photon_paths.h"

#include <array>
#include <span>
#include <vector>

namespace patina {

struct RatioKernelOptions {
    double arrivals = 150;    // per lamp set that a kernel should hold; > 0
    double min_radius = 1.0;  // in units of the texel's size [-]; > 0
    double max_radius = 7.0;  // in units of the texel's size [-]; >= min_radius
    int max_texels = 160;     // in one kernel; >= 1
};

// Weights kappa / sum(kappa A) [1/length^2] of the texels about each texel, compressed rows.
struct RatioKernel {
    std::vector<std::size_t> begin;  // texels + 1 offsets
    LargeVector<TexelId> texel;
    LargeVector<float> weight;
};

// arrivals: photons that arrived in each texel, averaged over the lamp sets; decides the radii.
// Kernels spread over the surface from neighbour to neighbour (also across seams), stop where the
// normal turns by more than 45 degrees or the surface leaves the tangent plane by a tenth of the
// radius, and are empty where no photon is in reach.
[[nodiscard]] RatioKernel build_ratio_kernel(const TexelAtlas& atlas,
                                             std::span<const double> arrivals,
                                             const RatioKernelOptions& options);

// Indirect irradiance of a texel from the two independent halves of the photons [radiance x sr].
struct IndirectIrradiance {
    std::array<Rgbf, 2> halves{Rgbf::Zero(), Rgbf::Zero()};

    [[nodiscard]] Rgb mean() const { return 0.5 * (halves[0] + halves[1]).cast<double>(); }
    // Half the difference of the halves: an error that mean() may as well have made.
    [[nodiscard]] Rgb half_difference() const {
        return 0.5 * (halves[0] - halves[1]).cast<double>();
    }
    // Of mean(), from the difference of the halves.
    [[nodiscard]] Rgb variance() const { return half_difference().square(); }
};
// One entry per texel.
[[nodiscard]] std::vector<IndirectIrradiance> indirect_irradiance(const RatioKernel& kernel,
                                                                  const PhotonPaths& paths,
                                                                  std::span<const Rgbf> power);

// Indirect light seen through the lobe, for three widths of it: pi times the radiance that a lobe
// of Ps = 1 reflects towards the camera [radiance x sr], over the square of the lobe's sigma
// [rad^2], which varies slowly with sigma.
struct IndirectLobe {
    Rgbf half = Rgbf::Zero();   // sigma half as large as the texel's
    Rgbf same = Rgbf::Zero();   // the texel's sigma
    Rgbf twice = Rgbf::Zero();  // twice as large

    IndirectLobe& operator+=(const IndirectLobe& other) {
        half += other.half;
        same += other.same;
        twice += other.twice;
        return *this;
    }
};

// An entry per texel, the next one `stride` entries behind.
struct LobeColumn {
    IndirectLobe* first = nullptr;
    std::size_t stride = 1;

    [[nodiscard]] IndirectLobe& operator[](std::size_t texel) const {
        return first[texel * stride];
    }
};

// Adds to the light that is there. w_v: per texel, unit, towards the camera. Adds nothing where
// wanted is 0.
void add_indirect_lobe(const RatioKernel& kernel,
                       const PhotonPaths& paths,
                       std::span<const Rgbf> power,
                       const TexelAtlas& atlas,
                       std::span<const Vec3f> w_v,
                       std::span<const Reflectance> maps,
                       std::span<const std::uint8_t> wanted,
                       LobeColumn sum);

}  // namespace patina
