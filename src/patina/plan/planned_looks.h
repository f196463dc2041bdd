// All looks that a plan can count on: those that candidates would give, and those taken already.
#pragma once

#include "patina/plan/greedy_cover.h"
#include "patina/plan/look_table.h"

#include <cstdint>
#include <vector>

namespace patina {

struct PlannedLooksOptions {
    CoverOptions cover;
    // The used shots are looks taken, each through its own camera; cover.taken then holds their
    // lights. Else the lights of cover.taken are, through every camera.
    bool shots_are_taken = false;
    std::size_t max_texels = 0;  // see sample_texels()
    std::uint64_t seed = 1;
};

struct PlannedLooks {
    Measurability measurability;         // of every texel
    PlanTexels texels;                   // those that the looks are of
    std::vector<LookTable> candidates;   // one per candidate of measurability
    LookTable taken;                     // what was taken already
    std::vector<LookTable> new_cameras;  // of each under all lights taken
};

// new_cameras: candidates for one more camera. Throws Error as measure_candidates() does.
[[nodiscard]] PlannedLooks collect_planned_looks(const RigView& rig,
                                                 const std::vector<Camera>& new_cameras,
                                                 const PlannedLooksOptions& options,
                                                 Progress& progress);

}  // namespace patina
