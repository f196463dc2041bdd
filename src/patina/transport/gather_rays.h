// The rays of the gather graph: those of one texel are drawn side by side in SIMD lanes and sent in
// packets, and where they meet the surface second rays go on about the mirror direction.
#pragma once

#include "patina/base/random.h"
#include "patina/transport/gather_graph.h"
#include "patina/transport/photon_lanes.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patina {

// The hits of one texel's rays are added behind those of the texels before it.
struct TracedRow {
    std::vector<GatherHit>& hits;
    std::vector<GlossyHit>& glossy;
    std::size_t first;  // of the texel's hits
};

// One for each thread: it holds the rays while they are on their way.
class GatherRays {
  public:
    // Keeps references to the atlas, the options and what the surface points to.
    GatherRays(const Surface& surface, const TexelAtlas& atlas, const GatherOptions& options)
        : surface_(surface), atlas_(atlas), options_(options) {}

    // A first look: rays over the hemisphere of the texel.
    static constexpr int kProbeRays = 16;
    [[nodiscard]] bool probe_hits(std::size_t texel);
    // Returns how many rays hit a back.
    int trace_irradiance(std::size_t texel, TracedRow row);
    // w_v: unit, towards camera number `view`.
    void trace_lobe(std::size_t texel, std::size_t view, const Vec3f& w_v, TracedRow row);

  private:
    struct Rays {
        std::size_t size = 0;
        Lane3 axis;                 // what they are drawn about; unit
        Lane<float> concentration;  // of the von Mises-Fisher distribution; 0: density cos/pi
        Lane<float> u, v;           // random numbers
        Lane3 origin, w;            // off the surface [length]; unit
        Lane<float> cosine;         // to the normal where they start [-]
        Lane<std::int32_t> active;  // -1 or 0
        Lane<std::uint32_t> triangle;
        Lane<float> hit_u, hit_v;

        void draw();
    };
    struct FirstRays : Rays {
        Lane<float> weight;  // as in GatherHit
    };
    struct SecondRays : Rays {
        Lane3 normal, geometric_normal, mirror;  // where they start; unit
        Lane<float> cos_o;                       // of the first ray there [-]
        Lane<std::uint32_t> hit;                 // of the first ray: its number in the row
    };
    // Where a ray met a front.
    struct Front {
        SurfacePoint point;
        TexelId texel = kNoTexel;
    };
    enum class Met { nothing, front, back };

    void send(Rays& rays) const;
    [[nodiscard]] Met meet(const Rays& rays, std::size_t lane, Front& front) const;
    void start(std::size_t texel, std::uint64_t stream, int begin, int count);
    void draw_first(std::size_t texel);
    int follow(int begin, int num_rays, TracedRow row);
    void start_onward(const SurfacePoint& point, const Vec3f& w, int number, TracedRow row);
    void follow_onward(TracedRow row);

    Surface surface_;
    const TexelAtlas& atlas_;
    const GatherOptions& options_;
    SobolScramble onward_scramble_;  // of the rays that were started last
    FirstRays first_;
    SecondRays second_;
};

}  // namespace patina
