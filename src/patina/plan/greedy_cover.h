// Which lamp positions to take: a greedy cover of the texels that become measurable. Needs the
// geometry, the cameras and the candidate lamps; no images.
//
// Based on: Machida, Takemura, Yokoya. Dense Estimation of Surface Reflectance Properties for
// Merging Virtualized Objects into Real Images. ACCV 2002 (the selection that the 2004 paper uses
// in section 2.1). docs/planning.md says how we read it.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/capture.h"
#include "patina/math/types.h"
#include "patina/plan/rig_view.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace patina {

struct CoverOptions {
    double max_light_angle = radians(80.0);  // theta_i, from the normal [rad]; in (0, pi/2]
    double max_view_angle = radians(75.0);   // theta_v, from the normal [rad]; in (0, pi/2]
    double roughness = 0.15;                 // sigma0, the width expected of the lobe [rad]; > 0
    double specular_reach = 2.0;  // theta_r below this many sigma0 shows the highlight [-]; > 0
    double diffuse_reach = 3.5;  // theta_r above this many sigma0 shows none [-]; >= specular_reach
    int specular_need = 2;       // lamps that must show a texel's highlight; in [1, 255]
    int diffuse_need = 1;        // lamps that must show it without; in [1, 255]
    double min_gain = 0.005;     // stop when a lamp adds less, share of the seen texels [-]; >= 0
    double enough = 0.95;  // stop at this share of what all candidates can measure [-]; in (0, 1]
    std::size_t max_lamps = 0;       // choose no more; 0: no limit
    std::vector<std::size_t> taken;  // lights already shot: they count, and are not chosen again

    [[nodiscard]] LookLimits limits() const {
        return {std::cos(max_light_angle), std::cos(max_view_angle)};
    }
};

// Throws Error. Options are named as on the command line. num_lights: of the capture.
void validate(const CoverOptions& options, std::size_t num_lights);

// What one lamp shows of one texel; bits.
inline constexpr std::uint8_t kShowsDiffuse = 1;
inline constexpr std::uint8_t kShowsSpecular = 2;

// What each candidate lamp shows of each texel through any of the cameras.
struct Measurability {
    std::vector<std::size_t> candidates;           // indices into the lights, ascending
    std::vector<std::vector<std::uint8_t>> shows;  // per light: bits per texel; empty: no candidate
    std::size_t num_seen = 0;                      // texels that some camera sees
};

// Share of the seen texels [-].
struct MeasurableShare {
    double diffuse = 0;
    double specular = 0;
};

enum class CoverStop { enough, small_gain, max_lamps, no_candidates };

// The next best lamp after the last one chosen, and what it would bring.
struct NextLamp {
    std::size_t light = 0;
    MeasurableShare share;  // with it
};

struct LightPlan {
    std::vector<std::size_t> candidates;  // indices into the lights, ascending
    std::vector<std::size_t> chosen;      // indices into the lights, in the order of choice
    // Those of the chosen that suffice for the diffuse component by the same rules, in the order of
    // choice: their number is the one in brackets of the paper's Fig. 4(d).
    std::vector<std::size_t> chosen_for_diffuse;
    MeasurableShare share_before;         // of the lights taken already
    std::vector<MeasurableShare> shares;  // after each choice; as many as chosen
    MeasurableShare share_with_all;       // with every candidate
    std::optional<NextLamp> next;         // nothing when every candidate was chosen
    std::size_t num_seen = 0;             // texels that some camera sees: what shares refer to
    CoverStop stop = CoverStop::no_candidates;

    // What the plan reaches in the end.
    [[nodiscard]] MeasurableShare share() const {
        return shares.empty() ? share_before : shares.back();
    }
};

// Every camera with every light that may go with it (lights that turn with a scanner need a camera
// that does). A lamp shows a texel where it is lit, clear of shadow edges and silhouettes, and
// within the angle limits. Lights that only held-out shots use are no candidates. Throws Error when
// there is no candidate, or no camera sees the surface.
// visit: called with every lamp that counts, in ascending order, and its light at every texel, so
// that whoever else needs that light need not trace it again.
using LampVisit = std::function<void(std::size_t light, const LargeVector<DirectLight>& direct)>;
[[nodiscard]] Measurability measure_candidates(const RigView& rig,
                                               const CoverOptions& options,
                                               Progress& progress,
                                               const LampVisit& visit = {});
[[nodiscard]] Measurability measure_candidates(const Capture& capture,
                                               const CoverOptions& options,
                                               Progress& progress);

// F(S): the sum over texels and both components of min(lamps of S that show it, lamps needed). A
// monotone submodular function, so the greedy choice of n lamps reaches at least 1 - 1/e of the
// best n. lights: indices, each once.
[[nodiscard]] std::uint64_t coverage(const Measurability& measurability,
                                     std::span<const std::size_t> lights,
                                     const CoverOptions& options);

// Takes the lamp with the largest gain of F, ties to the lower index, until both components reach
// `enough` or the gain falls below `min_gain`.
[[nodiscard]] LightPlan choose_lights(const Measurability& measurability,
                                      const CoverOptions& options);

// What a choice that was made otherwise makes measurable: all but next and stop. chosen:
// candidates, in the order of choice.
[[nodiscard]] LightPlan describe_choice(const Measurability& measurability,
                                        const CoverOptions& options,
                                        std::vector<std::size_t> chosen);

// What the lights make measurable: entry n with the first n of them, besides those taken already.
[[nodiscard]] std::vector<MeasurableShare> shares_of(const Measurability& measurability,
                                                     const CoverOptions& options,
                                                     std::span<const std::size_t> lights);

// Both steps. capture: of a rig or of a capture; only its geometry, cameras and lights are used.
[[nodiscard]] LightPlan plan_lights(const Capture& capture,
                                    const CoverOptions& options,
                                    Progress& progress);

}  // namespace patina
