// Photons: traced once from a lamp through the scene, stored, and weighted again whenever the maps
// change.
//
// Based on: Jensen. Realistic Image Synthesis Using Photon Mapping. 2001.
// Based on: Machida, Takemura, Yokoya. 2004, section 2.2.1.
// Direct light is known exactly at every texel, so a photon begins at the texel where the lamp's
// light first arrives (chosen in proportion to that light), and what is stored are its later
// arrivals: the indirect light. Directions and survival are drawn from fixed guide maps; the weight
// of an arrival under other maps follows from the stored angles, so that one set of photons serves
// every iteration and the iteration is a deterministic map (docs/theory.md, "Photons").
#pragma once

#include "patina/base/large_vector.h"
#include "patina/base/progress.h"
#include "patina/transport/direct.h"
#include "patina/transport/photon_scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

struct PhotonOptions {
    std::uint64_t photons = 2'000'000;  // per set of lamps that shine together; >= 2
    std::uint64_t seed = 1;             // any
    int max_bounces = 64;               // arrivals after which a photon is cut; >= 1
    bool keep_positions = false;        // fill PhotonPaths::arrival_position
    // Photons start as if the guide reflected this much everywhere at least; 0: only where it
    // reflects [-]; >= 0
    float min_guide_albedo = 0.02f;
    double azimuth_window = radians(
        12.0);  // half width of the columns that a photon of a turning lamp counts for [rad]; > 0
    // One turning lamp, a guide without a diffuse part and max_bounces = 1: photons count for the
    // column where they arrive alone, and as the lamp stands for it (photon_columns.h).
    bool exact_columns = false;
};

// One reflection and the arrival after it. Without initialisers, see UnclearedVector.
struct PhotonBounce {
    TexelId from;           // where it was reflected
    TexelId to;             // where it arrived
    float theta_r_squared;  // mirror angle of the reflection, squared [rad^2]
    float lobe_cosines;     // lobe_cosines() of the reflection [-]
    // Cosine / (pdf x survival), and shading normal over geometric one on arrival [sr].
    float geometry;
    float window;  // share that counts for the arrival's column (turning lamps) [1 or 1/rad]
};

// Marks a bounce that counts for no column.
inline constexpr std::uint32_t kNoArrival = 0xffffffffu;

// Everything that the photons of one set of lamps did. Bounces of a path are consecutive; arrivals
// are the bounces that count, sorted by the texel of arrival.
struct PhotonPaths {
    struct Path {
        Rgbf power;  // that falls on the first texel [radiance x sr x length^2]
        std::uint32_t first_bounce;
        std::uint8_t half;  // which of two independent halves of the photons
    };
    UnclearedVector<Path> paths;  // those with at least one bounce, in order of photon index
    UnclearedVector<PhotonBounce> bounces;
    UnclearedVector<std::uint32_t> arrival_of_bounce;  // kNoArrival where the bounce does not count
    UnclearedVector<std::uint32_t> arrivals_begin;     // texels + 1 offsets into the arrivals
    UnclearedVector<std::uint8_t> arrival_half;
    UnclearedVector<Vec3f> arrival_direction;  // unit, from the surface back along the photon's way
    UnclearedVector<Vec3f>
        arrival_position;  // [length]; empty unless PhotonOptions::keep_positions
    std::uint64_t rays = 0;
};

// The lamps that shine together in a shot, with their direct light on every texel of the atlas.
struct LampSet {
    std::vector<const Light*> lights;
    std::vector<const LargeVector<DirectLight>*> direct;
    std::vector<std::size_t> indices;  // of the lights among those of the capture
    bool turns_with_scanner = false;
};

// stream: tells the lamp sets apart.
[[nodiscard]] PhotonPaths trace_photons(const PhotonScene& scene,
                                        const LampSet& lamps,
                                        const PhotonOptions& options,
                                        std::uint32_t stream,
                                        Progress& progress);

// The photons under given maps.
struct PhotonPower {
    std::vector<Rgbf> arrivals;     // power of every arrival [radiance x sr x length^2]
    std::vector<double> by_bounce;  // power that arrives after 1, 2, ... reflections, all channels
};
[[nodiscard]] PhotonPower photon_power(const PhotonPaths& paths, std::span<const Reflectance> maps);

// How many photons of equal power would tell as much: (sum w)^2 / sum w^2 over the arrivals, w the
// mean of a power's channels; 0 without power.
[[nodiscard]] double effective_number(std::span<const Rgbf> arrivals);

}  // namespace patina
