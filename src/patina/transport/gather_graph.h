// The gather graph: from every texel a fixed set of rays, traced once, of which those that hit the
// surface are kept with the texel they hit. It depends on the geometry and the cameras alone, so
// that every lamp, every shot and every iteration reuses it.
//
// docs/theory.md, "The gather graph"; the directions are Owen-scrambled Sobol points (Burley 2020).
#pragma once

#include "patina/base/large_vector.h"
#include "patina/base/progress.h"
#include "patina/transport/surface.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// Hits of a texel are numbered in 16 bits.
inline constexpr int kMaxGatherRays = 65'536;

struct GatherOptions {
    // Per texel over the cosine-weighted hemisphere: a multiple of 4, up to kMaxGatherRays.
    int rays = 64;
    // Per texel and camera that sees it, towards its lobe: a multiple of 8, as many at most.
    int lobe_rays = 32;
    double lobe_spread = 0.2;  // sigma of the lobe that these rays are drawn from [rad]; > 0
    std::uint64_t seed = 1;    // any
};

// A ray that hit the front of the surface.
struct GatherHit {
    TexelId to = kNoTexel;
    Vec3f w = Vec3f::UnitZ();  // unit, from the texel towards the hit
    // Irradiance rays: pi / rays, so that E = sum weight L. Lobe rays: cosine over (density x
    // rays), so that the integral of L g cos over directions is sum weight L g [sr].
    float weight = 0;
    std::uint32_t half = 0;  // which of two independent halves of the rays, 0 or 1
};

// A second ray, from the place y that a first one met, about the mirror direction there, which met
// a front again: of the light from there the lobe of y sends a part back along the first ray. For
// Ps = pi that part is weight exp(-theta^2 / (2 sigma^2)) L, L the radiance from `to` towards y.
struct GlossyHit {
    TexelId to = kNoTexel;
    std::uint16_t hit = 0;            // of the first ray: its number in the texel's row of hits
    std::uint16_t theta_squared = 0;  // from the mirror direction, to_compact() [rad^2]
    // Cosine of arrival at y over (max(cos_i, c0) max(cos_o, c0) density) [sr].
    float weight = 0;
};

// Rays of one purpose, compressed rows: texels + 1 offsets into hits, and into glossy hits, which
// are in the order of the hits that they belong to.
struct GatherRows {
    std::vector<std::size_t> begin;
    LargeVector<GatherHit> hits;
    std::vector<std::size_t> glossy_begin;
    LargeVector<GlossyHit> glossy;

    [[nodiscard]] std::span<const GatherHit> of(std::size_t texel) const {
        return std::span(hits).subspan(begin[texel], begin[texel + 1] - begin[texel]);
    }
};

// One camera's view of every texel; a zero vector where it does not see the texel.
using ViewDirections = std::vector<Vec3f>;

struct GatherGraph {
    GatherRows irradiance;
    std::vector<GatherRows> lobes;  // per camera view
    // Per texel: how many irradiance rays hit the back of a surface, over those that hit a front
    // (at least 1). Rays that meet a back have passed through a gap: where a scan saw nothing.
    std::vector<float> backs_over_fronts;
    std::uint64_t num_rays = 0;  // first ones that were traced
};

// Raised with every change of the rays or of what is kept of them: saved graphs of other versions
// are not used.
inline constexpr std::uint64_t kGatherGraphVersion = 4;

// Texels around which a first handful of rays meets nothing count as convex and get no more rays.
// views: per camera, one direction per texel (unit, towards the camera).
[[nodiscard]] GatherGraph trace_gather_graph(const Surface& surface,
                                             const TexelAtlas& atlas,
                                             std::span<const ViewDirections> views,
                                             const GatherOptions& options,
                                             Progress& progress);

// How many hits a graph will hold.
struct GatherHitCount {
    struct Rows {
        double hits = 0;
        double glossy = 0;
    };
    Rows irradiance;
    std::vector<Rows> lobes;  // per camera view
};

// Judged by some thousand texels, evenly spread; texels that count as convex are taken for others,
// so that it is rather too many.
[[nodiscard]] GatherHitCount expect_gather_hits(const Surface& surface,
                                                const TexelAtlas& atlas,
                                                std::span<const ViewDirections> views,
                                                const GatherOptions& options);

}  // namespace patina
