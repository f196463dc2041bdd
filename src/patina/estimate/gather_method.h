// Method gather as a whole: its memory, the looks, the graph, where need be the strength of the
// lamps, and the iteration.
#pragma once

#include "patina/estimate/estimate.h"
#include "patina/transport/surface.h"

namespace patina {

// Throws Error where options.memory is too little, before anything large is begun.
[[nodiscard]] Estimate estimate_by_gathering(const Capture& capture,
                                             const Surface& surface,
                                             const EstimateOptions& options,
                                             Progress& progress);

}  // namespace patina
