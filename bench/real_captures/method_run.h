// One capture estimated in one way, and how well that predicts the shots held out.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/capture.h"
#include "patina/capture/result_folder.h"
#include "patina/estimate/estimate.h"
#include "patina/pipeline/compare_result.h"

#include <cstdint>
#include <optional>
#include <string>

namespace patina {

struct RunSettings {
    std::uint64_t photons = 2'000'000;  // per set of lamps that shine together; >= 2
    std::uint64_t seed = 1;             // any
    int samples = 16;                   // paths for each pixel of a held-out shot; >= 1
};

struct MethodRun {
    std::string name;  // of the method, or "Lambertian"
    Estimate estimate;
    ReflectanceMaps maps;
    std::optional<ImageComparison> heldout;  // nothing where no shot is held out
    std::optional<Comparison::Truth> truth;
};

[[nodiscard]] bool has_status(const MethodRun& run, TexelId texel, TexelStatus status);
// Status 1 or 2.
[[nodiscard]] bool is_diffuse_measured(const MethodRun& run, TexelId texel);
// Mean of the three channels of Pd [-].
[[nodiscard]] double mean_diffuse(const MethodRun& run, TexelId texel);

// Throws Error, WorkFailed, Interrupted.
[[nodiscard]] MethodRun run_method(const Capture& capture,
                                   Method method,
                                   const RunSettings& settings,
                                   Progress& progress);

// Pd by weighted least squares over all looks under direct light, Ps = 0. Texels without looks stay
// black.
[[nodiscard]] MethodRun run_lambertian(const Capture& capture,
                                       const RunSettings& settings,
                                       Progress& progress);

}  // namespace patina
