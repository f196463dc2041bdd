// Maps against the truth of a capture.
#pragma once

#include "patina/capture/capture.h"
#include "patina/capture/result_folder.h"
#include "patina/pipeline/compare_result.h"

namespace patina {

// Texels that the truth's mask leaves out do not count.
[[nodiscard]] Comparison::Truth compare_with_truth(const ReflectanceMaps& maps,
                                                   const TruthMaps& truth);

// noise: of the fit. Nothing where no texel of status 1 has a bound.
[[nodiscard]] std::optional<BoundComparison> compare_with_bound(const Capture& capture,
                                                                const ReflectanceMaps& maps,
                                                                const TruthMaps& truth,
                                                                const FitNoise& noise,
                                                                Progress& progress);

}  // namespace patina
