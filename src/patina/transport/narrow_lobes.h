// What narrow lobes send on of the lamps' light, by photons.
//
// The gather graph finds the image of a lamp in the lobe of a place that a ray meets. Where the
// lobe is narrow few rays of a texel meet the place where it points back at the texel, and what
// they bring is noise. So the paths lamp -> lobe of y -> x are split into two disjoint classes:
// photons carry the share photon_share(sigma(y)) of them, and sweeps the rest
// (RadiantTexels' left_out).
//
// Photons start at texels with narrow lobes, are reflected once, by the lobe, and count where
// they arrive. They are traced once, weighted again as the maps change, and traced anew when too
// few of them still count. Those of lamps that turn with the scanner count for the column where
// they arrive (photon_columns.h). docs/theory.md, "Narrow lobes", says why.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/math/lanes.h"
#include "patina/transport/gather_light.h"
#include "patina/transport/photon_paths.h"
#include "patina/transport/ratio_kernel.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patina {

struct NarrowLobeOptions {
    // For each lamp and texel whose lobe is all theirs, of others in proportion to their share; >
    // 0. Of those of a lamp that turns fewer count.
    double photons_per_texel = 4;
    double photons_per_turning_texel = 8;
    std::uint64_t max_photons = 2'000'000;  // for each lamp; >= 2
    std::uint64_t seed = 1;                 // any
    double kernel_radius = 4;               // largest, see RatioKernelOptions [texels]; > 0
};

// Share of the images of lamps in a lobe that photons carry [-]: 1 for narrow lobes, 0 for wide
// ones, and smooth in between, so that texels whose sigma moves from turn to turn do not flicker.
[[nodiscard]] double photon_share(double roughness);

class NarrowLobes {
  public:
    // Irradiance by photons of two halves, of a block's lamps of unit strength in white: each half
    // stands for all of the light [1/length^2; 1 for directional lamps].
    using Irradiance = LargeVector<std::array<Lanes, 2>>;

    // Keeps references to the atlas, to what the surface and the blocks point to.
    NarrowLobes(const Surface& surface,
                const TexelAtlas& atlas,
                std::vector<LampBlock> blocks,
                const NarrowLobeOptions& options);

    // Weighs the photons for these maps, or traces them where there are none yet and narrow lobes
    // send on enough of the light to matter, and where the effective number of photons has halved
    // since they were traced, or twice as many are called for. Returns whether they were traced.
    bool follow(std::span<const Reflectance> maps);
    // Lets all photons go.
    void forget();

    // Per texel, the share of its images that photons carry under the maps of follow(), in [0, 1];
    // empty where there are no photons.
    [[nodiscard]] std::span<const float> shares() const { return shares_; }

    // One entry per texel. Only where there are photons.
    [[nodiscard]] Irradiance irradiance(std::size_t block) const;
    // The same light of one lamp, in its own color, seen through lobes: see add_indirect_lobe().
    void add_lobe(std::size_t block,
                  std::size_t lane,
                  std::span<const Vec3f> w_v,
                  std::span<const Reflectance> maps,
                  std::span<const std::uint8_t> wanted,
                  LobeColumn sum) const;

    // Bytes that the photons of one lamp take at most, were all lobes narrow, where this share of
    // the directions from a texel meets the surface.
    [[nodiscard]] static double expect_bytes(std::size_t num_texels,
                                             double hit_share,
                                             bool turning,
                                             const NarrowLobeOptions& options);

  private:
    // Holds the directions of all arrivals that count for a texel.
    struct ArrivalCone {
        Vec3f axis = Vec3f::UnitZ();  // unit
        float chord = -1;             // the longest from the axis [-]; < 0: nothing arrives
    };
    // Photons of one lamp under the maps of follow().
    struct LampPhotons {
        PhotonPaths paths;
        std::vector<ArrivalCone> cones;  // per texel
        std::vector<Rgbf> power;         // of every arrival [radiance x sr x length^2]
    };

    // Whether photons carry images of this lobe of a texel.
    [[nodiscard]] bool is_guided(std::size_t texel, const Reflectance& map) const;
    void trace(std::span<const Reflectance> maps);
    [[nodiscard]] ArrivalCone cone_at(std::size_t texel, const PhotonPaths& paths) const;
    // Returns the effective number of photons.
    double weigh(std::span<const Reflectance> maps);

    Surface surface_;
    const TexelAtlas& atlas_;
    std::vector<LampBlock> blocks_;
    NarrowLobeOptions options_;
    std::vector<std::vector<LampPhotons>> photons_;  // per block, per lane; empty: not traced
    RatioKernel kernel_;
    std::vector<float> guide_roughness_;  // per texel, as traced; 0 where no photons start [rad]
    std::vector<float> shares_;
    double effective_when_traced_ = 0;
    double shares_when_traced_ = 0;  // of images, of all texels [texels]
};

}  // namespace patina
