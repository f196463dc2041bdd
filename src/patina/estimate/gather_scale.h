// Method gather under lamps of unknown common strength: the trials that tell it, each a gather
// iteration brought to rest under one factor of the lamps.
#pragma once

#include "patina/estimate/gather_engine.h"
#include "patina/estimate/gather_iteration.h"
#include "patina/estimate/scale_profile.h"

namespace patina {

// iteration: started, at factor 1. Leaves it and the engine as the last trial does.
[[nodiscard]] ScaleEstimate measure_scale(GatherIteration& iteration,
                                          GatherEngine& engine,
                                          const TexelAtlas& atlas,
                                          const SceneView& scene,
                                          const Observations& observations,
                                          Progress& progress);

}  // namespace patina
