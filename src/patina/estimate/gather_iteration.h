// Method gather: sweeps of light over the gather graph and joint fits of every texel, interleaved.
//
// docs/theory.md, "The iteration": one sweep for each fit has the fixed points of the paper's loop
// and contracts by lambda wherever lambda < 1.
#pragma once

#include "patina/estimate/estimate.h"
#include "patina/estimate/observations.h"
#include "patina/transport/surface.h"

namespace patina {

[[nodiscard]] Estimate estimate_by_gathering(const Capture& capture,
                                             const Surface& surface,
                                             const SceneView& scene,
                                             const Observations& observations,
                                             const EstimateOptions& options,
                                             Progress& progress);

}  // namespace patina
