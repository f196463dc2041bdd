// Maps against the truth of a capture.
#pragma once

#include "patina/capture/capture.h"
#include "patina/capture/result_folder.h"
#include "patina/pipeline/compare_result.h"

namespace patina {

// Texels that the truth's mask leaves out do not count.
[[nodiscard]] Comparison::Truth compare_with_truth(const ReflectanceMaps& maps,
                                                   const TruthMaps& truth);

}  // namespace patina
