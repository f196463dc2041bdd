// A pixel shows a patch of surface, not a point: over it the mirror direction turns, and the
// highlight that it shows is wider and lower than the lobe. docs/theory.md, "The footprint".
#pragma once

#include "patina/capture/capture.h"
#include "patina/estimate/observations.h"

namespace patina {

// Fills LampTerm::spread_along and spread_across of every term from the differences between a texel
// and its neighbours of the texel domain. rows, terms: as collect_observations() made them.
void spread_over_footprints(const Capture& capture,
                            const SceneView& scene,
                            Observations& observations);

// Second moment of each view's footprints along one axis, in squared texels: a pixel's own 1/12,
// and 1/6 more where radiance is interpolated between pixels.
[[nodiscard]] std::vector<double> footprint_moments(const Capture& capture, const SceneView& scene);

}  // namespace patina
