// One sweep of light over the gather graph: from the light that every texel now sends out, the
// light that arrives at every texel after one more bounce.
//
//     H_ind(x) <- sum_k weight_k L(y_k, x),   L = [Pd (E + H_ind) + Ps A H_ind] / pi + f_s E
//
// f_s E is the lobe's image of the lamp, evaluated exactly; what the lobe sends on of indirect
// light is spread evenly (Ps A, A the lobe's directional albedo averaged over the hemisphere).
// Sweeps repeated under fixed maps converge to the full solution; docs/theory.md, "The gather
// graph". Under lamps that turn with the scanner, H_ind(y) is that of y's own azimuth: exact for
// the first bounce, and for later ones as far as H_ind changes little between columns that see each
// other.
#pragma once

#include "patina/transport/gather_light.h"
#include "patina/transport/surface_filter.h"

#include <span>
#include <vector>

namespace patina {

// Indirect light of one lamp block at every texel, per white lamp: irradiance, three channels.
using IndirectLanes = LargeVector<std::array<Lanes, 3>>;

// The maps as a sweep reads them.
class RadiantTexels {
  public:
    RadiantTexels(const TexelAtlas& atlas, std::span<const Reflectance> maps, bool with_specular);

    struct Material {
        Vec3f normal = Vec3f::UnitZ();
        Rgbf diffuse = Rgbf::Zero();     // Pd / pi [1/sr]
        float specular = 0;              // Ps / pi [1/sr]
        float minus_half_precision = 0;  // -1 / (2 sigma^2) [1/rad^2]
        Rgbf onward = Rgbf::Zero();      // (Pd + Ps A) / pi, for indirect light [1/sr]
    };
    [[nodiscard]] const Material& operator[](TexelId texel) const { return materials_[texel]; }

  private:
    std::vector<Material> materials_;
};

// Light on one lamp block, with what it needs from sweep to sweep.
class LampBlockLight {
  public:
    // turning: whether the lamps turn with the scanner. keeps_hits: whether their light at the hits
    // stays in memory, or is computed again for each sweep; the same light in either case. Keeps
    // references to the atlas and to what the surface points to.
    LampBlockLight(const Surface& surface,
                   const TexelAtlas& atlas,
                   const GatherGraph& graph,
                   LampBlock lamps,
                   bool turning,
                   bool keeps_hits = true);

    // One sweep. halves: from the two independent halves of the rays, filtered. Their mean is what
    // the next sweep starts from.
    void sweep(const GatherGraph& graph,
               const RadiantTexels& texels,
               const SurfaceFilter& filter,
               std::array<IndirectLanes, 2>& halves);

    // After a sweep and its lobes: lets the light at the hits go, unless it is kept.
    void end_sweep();

    // The next sweep is the first one again.
    void restart();

    // Indirect light seen through the lobe of `texel` from one camera view, for three widths of it
    // (IndirectLobe), of the light of the last sweep but for the bounce towards the texel. Not
    // between end_sweep() and the next sweep.
    struct LobeLanes {
        std::array<Lanes, 3> half{}, same{}, twice{};
    };
    [[nodiscard]] LobeLanes lobe(const GatherGraph& graph,
                                 std::size_t view,
                                 const RadiantTexels& texels,
                                 TexelId texel,
                                 const Vec3f& w_v,
                                 double roughness) const;

    [[nodiscard]] const LampBlock& lamps() const { return lamps_; }

  private:
    using Radiance = std::array<Lanes, 3>;
    // Asks for what radiance_of() will read of a hit to come.
    void expect(const RadiantTexels& texels, const GatherRows& rows, std::size_t hit_index) const;
    void light_hits(const GatherGraph& graph);
    void add_lobe_of_lamps(const RadiantTexels::Material& material,
                           const GatherHit& hit,
                           std::size_t hit_index,
                           const std::vector<CompactLanes>& compact,
                           Radiance& radiance) const;
    // Radiance of the place that was hit towards the gathering texel.
    [[nodiscard]] Radiance radiance_of(const RadiantTexels& texels,
                                       const GatherHit& hit,
                                       std::size_t hit_index,
                                       const std::vector<CompactLanes>& compact) const;

    Surface surface_;
    const TexelAtlas& atlas_;
    LampBlock lamps_;
    bool turning_;
    bool keeps_hits_;
    bool has_hits_ = false;
    LitTexels lit_;                                      // standing lamps
    std::vector<CompactLanes> irradiance_lanes_;         // turning lamps, per hit
    std::vector<std::vector<CompactLanes>> lobe_lanes_;  // the same, per camera view
    IndirectLanes indirect_;                             // of the last sweep
    IndirectLanes radiosity_;                            // over pi, what is sent evenly
};

}  // namespace patina
