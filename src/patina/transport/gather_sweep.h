// One sweep of light over the gather graph: from the light that every texel now sends out, the
// light that arrives at every texel after one more bounce.
//
//     H_ind(x) <- sum_k weight_k L(y_k, x),   L = Pd (E + H_ind) / pi + f_s E + f_s * L_z
//
// f_s E is the lobe's image of the lamp, evaluated exactly; f_s * L_z is what the lobe sends on of
// the light of other texels z, over the second rays of the graph (glossy_sweep.h), for which z's
// own light is spread evenly: L_z = (Pd + Ps A) (E + H_ind) / pi, A the directional albedo of z's
// lobe averaged over the hemisphere. Sweeps repeated under fixed maps converge to the full
// solution; docs/theory.md, "The gather graph". Under lamps that turn with the scanner, H_ind(y)
// and L_z are those of y's and z's own azimuth: exact for the first bounce, and for later ones as
// far as they change little between columns that see each other.
#pragma once

#include "patina/transport/filtered_light.h"
#include "patina/transport/gather_light.h"
#include "patina/transport/glossy_sweep.h"
#include "patina/transport/radiant_texels.h"

#include <span>
#include <vector>

namespace patina {

// Indirect light of one lamp block at every texel, per white lamp: irradiance, three channels.
using IndirectLanes = LargeVector<std::array<Lanes, 3>>;

// What a sweep leaves. Its memory serves the next sweep, of any block.
struct SweptLight {
    // Of the two independent halves of the rays, filtered where that lowers their error.
    std::array<IndirectLanes, 2> halves;
    LargeVector<LightHalves> unfiltered;  // the same before the filter
    LargeVector<OnwardRow> onward;        // what second rays met; empty for the first sweep
};

// What a hit reads of the texel that it meets, in one line of memory: the radiance that the texel
// sends evenly, over light_units(), and of its lobe what one lamp block needs.
struct alignas(64) StandingRow {
    std::array<CompactLanes, 3> radiance{};
    CompactLanes image{};  // Ps / pi times LitTexel::over_cosine
};
struct alignas(64) TurningRow {
    std::array<CompactLanes, 3> radiance{};  // of indirect light
    Rgbf diffuse = Rgbf::Zero();             // Pd / pi, of the hit's own direct light
    float specular = 0;                      // Ps / pi
};

// What one lamp block's light is gathered from.
template <typename Row, typename Hit>
struct LightSources {
    LargeVector<Row> texels;
    LargeVector<Hit> irradiance;          // per hit of GatherGraph::irradiance
    std::vector<LargeVector<Hit>> lobes;  // per camera view, per hit of GatherGraph::lobes
};

// Light on one lamp block, with what it needs from sweep to sweep.
class LampBlockLight {
  public:
    // turning: whether the lamps turn with the scanner. keeps_hits: whether what is known of them
    // at the hits stays in memory, or is computed again for each sweep; the same light in either
    // case. Keeps references to the atlas and to what the surface points to.
    LampBlockLight(const Surface& surface,
                   const TexelAtlas& atlas,
                   const GatherGraph& graph,
                   LampBlock lamps,
                   bool turning,
                   bool keeps_hits = true);

    // One sweep. The mean of the filtered halves is what the next one starts from. Where the filter
    // lowers the error of the light is decided in the very first one. step: so many times as far
    // from the light of the last sweep as the rays tell.
    void sweep(const GatherGraph& graph,
               const RadiantTexels& texels,
               const SurfaceFilter& filter,
               SweptLight& swept,
               float step = 1);

    // Adds what reaches the texels of the lamps in another way to the light of the last sweep, so
    // that the next one carries it on: irradiance of two halves, the same in all channels, per
    // white lamp [1/length^2; 1 for directional lamps]. One entry per texel.
    void add(std::span<const std::array<Lanes, 2>> irradiance, SweptLight& swept);

    // After a sweep and its lobes: lets the light at the hits go, unless it is kept.
    void end_sweep();

    // The next sweep is the first one again.
    void restart();

    // Indirect light seen through the lobe of `texel` from one camera view, for three widths of it
    // (IndirectLobe), of the light of the last sweep but for the bounce towards the texel. swept:
    // as that sweep left it. Not between end_sweep() and the next sweep.
    struct LobeLanes {
        std::array<Lanes, 3> half{}, same{}, twice{};
    };
    [[nodiscard]] LobeLanes lobe(const GatherGraph& graph,
                                 std::size_t view,
                                 const RadiantTexels& texels,
                                 const SweptLight& swept,
                                 TexelId texel,
                                 const Vec3f& w_v,
                                 double roughness) const;

    [[nodiscard]] const LampBlock& lamps() const { return lamps_; }

  private:
    void light_hits(const GatherGraph& graph);
    void light_texels(const RadiantTexels& texels, LargeVector<OnwardRow>& onward);

    Surface surface_;
    const TexelAtlas& atlas_;
    LampBlock lamps_;
    Lanes units_;
    bool turning_;
    bool keeps_hits_;
    bool has_hits_ = false;
    bool has_bounced_ = false;                              // a sweep has been made
    std::vector<LitTexel> lit_;                             // standing lamps
    LightSources<StandingRow, StandingHit> standing_;       // empty if they turn
    LightSources<TurningRow, TurningHit> turning_sources_;  // empty if they stand
    IndirectLanes indirect_;                                // of the last sweep [light_units()]
    std::vector<LampMask> filters_;  // where the filter lowers the error, per texel
};

}  // namespace patina
