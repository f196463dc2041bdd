// A plan and what it is worth: the lamps that a rule chooses, what each adds, other rules at equal
// number, and the single looks that would teach most.
//
// docs/planning.md says how the numbers are found.
#pragma once

#include "patina/plan/greedy_cover.h"
#include "patina/plan/information.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace patina {

// What makes lamps worth taking: information, or the paper's cover of measurable texels.
enum class PlanRule { d_optimal, paper };

struct StudyOptions {
    CoverOptions cover;  // its roughness is the middle one of the prior's too
    // The used shots of the capture are looks taken already, each through its own camera, and their
    // lights are no candidates. Else the lights of cover.taken are, through every camera.
    bool shots_are_taken = false;
    PlanRule rule = PlanRule::d_optimal;
    double prior_diffuse = SurfacePrior{}.diffuse;                  // [-]; > 0
    double prior_specular_albedo = SurfacePrior{}.specular_albedo;  // [-]; > 0
    std::vector<Reflectance> maps;  // per texel of the atlas, known beforehand; empty: the prior
    int max_lamps = 0;              // choose so many; 0: as many as the rule finds worth it; >= 0
    // d-optimal stops when a lamp lowers the standard errors by less than this share, as the
    // geometric mean over the parameters, texels and cases [-]; in [0, 1).
    double min_drop = 0.02;
    int max_texels = 1 << 14;  // texels that information is summed over; 0: all that are seen; >= 0
    int num_draws = 21;        // random choices to compare with; >= 1
    int num_next = 5;          // single looks to rank; >= 0
    std::uint64_t seed = 1;
};

// Throws Error. Options are named as on the command line. num_lights: of the capture.
void validate(const StudyOptions& options, std::size_t num_lights);

// What some lamps make of the seen texels.
struct PlanWorth {
    double known = 0;       // share of texels and cases with Ps known to kKnown [-]
    MeasurableShare share;  // by the rules of the cover
};

// worth[n]: with the first n lamps of an order, besides those taken already. Ends where the rule
// has no more lamp to offer.
struct RuleCurve {
    std::string rule;  // "d-optimal", "paper", "uniform", "random" (medians of its draws)
    std::vector<PlanWorth> worth;
};

// One lamp through all cameras, or one more camera under all lamps taken.
struct NextLook {
    bool is_camera = false;
    std::size_t index = 0;  // into the lights, or into the new cameras
    double gain = 0;        // [nat]
    ErrorSummary errors;    // with it
    double known = 0;       // as in PlanWorth, with it [-]
};

struct LampStudy {
    LightPlan plan;
    std::vector<double> drops;     // of the standard errors by each lamp chosen [-]; see min_drop
    std::vector<PlanWorth> worth;  // before, and after each lamp chosen
    PlanWorth worth_with_all;      // with every candidate
    ErrorSummary errors_before;
    ErrorSummary errors;  // in the end
    std::vector<RuleCurve> curves;
    std::vector<NextLook> next;  // best first, each alone after what was taken already
    std::size_t num_texels = 0;  // that information was summed over
    double read_stddev = 0;      // of the images, that was supposed [radiance]
};

// capture: of a rig or of a capture; no image of it is read. new_cameras: candidates for one more
// camera, besides those of the capture. Throws Error.
[[nodiscard]] LampStudy study_lamps(const Capture& capture,
                                    const std::vector<Camera>& new_cameras,
                                    const StudyOptions& options,
                                    Progress& progress);

}  // namespace patina
