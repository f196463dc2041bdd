// What an estimate says of a texel at the end: its standard errors, its status, its indirect light.
// docs/uncertainty.md says what the errors consist of.
#pragma once

#include "patina/capture/capture.h"
#include "patina/estimate/estimate.h"
#include "patina/estimate/fit_rows.h"
#include "patina/estimate/texel_turn.h"

#include <span>

namespace patina {

// Errors are those of the last turn's light and the final maps. Fills errors, status,
// measurability and indirect_over_direct. robust: a factor on the weight of every row of the
// observations; empty: 1.
void finish_estimate(const Capture& capture,
                     const SceneView& scene,
                     const Observations& observations,
                     const IndirectLight& light,
                     std::span<const TexelFit> fits,
                     std::span<const float> robust,
                     Estimate& estimate);

}  // namespace patina
