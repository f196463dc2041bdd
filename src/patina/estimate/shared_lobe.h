// The lobe of a surface whose highlights no look shows: its albedo, from what the lobe does to the
// light that bounces. docs/theory.md, "Lobes that nobody sees".
#pragma once

#include "patina/estimate/gather_engine.h"
#include "patina/estimate/gather_iteration.h"

namespace patina {

// iteration: brought to rest without any lobe. Leaves it and the engine as the last trial does.
[[nodiscard]] SharedLobe measure_shared_lobe(GatherIteration& iteration,
                                             GatherEngine& engine,
                                             const TexelAtlas& atlas,
                                             const SceneView& scene,
                                             const Observations& observations,
                                             Progress& progress);

}  // namespace patina
