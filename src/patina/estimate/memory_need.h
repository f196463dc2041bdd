// The memory that method gather will need, reckoned before the work, and how to stay within less.
//
// With T texels, V cameras, S shots, M sets of lamps, N lamps, R looks with K lamp terms, H hits of
// the graph's rays and G of its second rays, in bytes (names of structs stand for their sizes):
//
//     held       what the process has when it is asked: the program, mesh, atlas, ray tracer
//     views      T (V TexelView + N DirectLight + 12 V)
//     looks      R (Observation + 16) + K LampTerm, and 24 R with an error of registration
//     images     T S (TexelSample, and 24 with an error of registration) + kImagesAtOnce images
//     graph      H GatherHit + G GlossyHit + 16 T (V + 1)
//     tracing    twice the hits of the largest rows, on top, before they are compact
//     lanes      H TurningHit for each block of 8 lamps that turn with the scanner,
//                H StandingHit + T LitTexel for each one that stands, 160 T for either
//     light      T (24 M + IndirectLobe S) + 448 T while a block is swept
//     photons    for each lamp, were all lobes narrow: NarrowLobes::expect_bytes()
//     texels     kTexelBytes T
//
//     peak = held + views + looks
//          + max(images, graph + tracing, graph + lanes + light + photons + texels)
//
// Lanes at the hits are by far the largest where lamps turn. They follow from the graph and can be
// computed again in each turn, a block at a time, at the price of its shadow rays where lamps turn.
#pragma once

#include "patina/estimate/estimate.h"
#include "patina/estimate/observations.h"

#include <cstddef>
#include <string>

namespace patina {

inline constexpr double kGibibyte = 1 << 30;  // [bytes]

struct MemoryCounts {
    double held = 0;  // [bytes]
    std::size_t texels = 0;
    std::size_t cameras = 0;
    std::size_t shots = 0;
    std::size_t lamps = 0;
    std::size_t lamp_sets = 0;
    std::size_t standing_blocks = 0;  // of kLampLanes lamps
    std::size_t turning_blocks = 0;
    std::size_t standing_lamps = 0;
    std::size_t image_pixels = 0;  // of the largest image
    bool has_gradients = false;    // the capture states an error of registration
    double filter_radius = 0;      // [texels]
    LookCount looks;
    GatherHitCount hits;
    double photons = 0;  // for narrow lobes [bytes]
};

// All in bytes.
struct MemoryNeed {
    double views = 0;
    double looks = 0;
    double images = 0;
    double graph = 0;
    double tracing = 0;
    double lanes = 0;
    double light = 0;
    double photons = 0;
    double texels = 0;
    double peak = 0;
};

// Of the used shots, before the scene is viewed: no looks and no hits.
[[nodiscard]] MemoryCounts count_memory(const Capture& capture);
// Adds the looks and the hits; traces the rays of some thousand texels.
[[nodiscard]] MemoryCounts count_work(const Capture& capture,
                                      const Surface& surface,
                                      const SceneView& scene,
                                      const EstimateOptions& options,
                                      MemoryCounts counts);

// kept_blocks: so many blocks keep their light at the hits, those that turn first.
[[nodiscard]] MemoryNeed memory_need(const MemoryCounts& counts, std::size_t kept_blocks);

struct MemoryPlan {
    double peak = 0;              // reckoned [bytes]
    std::size_t kept_blocks = 0;  // see memory_need()
};

// The most blocks that `limit` bytes allow to keep. Throws Error with what is needed, and which
// setting would lower it, where even none is too many.
[[nodiscard]] MemoryPlan plan_memory(const MemoryCounts& counts, double limit);

// "memory: about 3.20 GiB".
[[nodiscard]] std::string memory_words(const MemoryPlan& plan, const MemoryCounts& counts);

}  // namespace patina
