// Method gather as a whole: the graph, where need be the strength of the lamps, and the iteration.
#pragma once

#include "patina/estimate/estimate.h"
#include "patina/estimate/observations.h"
#include "patina/transport/surface.h"

namespace patina {

// Where the capture does not know the strength of its lamps, leaves the observations divided by it.
[[nodiscard]] Estimate estimate_by_gathering(const Capture& capture,
                                             const Surface& surface,
                                             const SceneView& scene,
                                             Observations& observations,
                                             const EstimateOptions& options,
                                             Progress& progress);

}  // namespace patina
