// A capture's shots again, path traced from estimated maps.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/capture.h"
#include "patina/capture/result_folder.h"
#include "patina/pipeline/uv_locator.h"
#include "patina/transport/surface.h"

#include <cstdint>
#include <string>
#include <vector>

namespace patina {

struct ShotRenderOptions {
    int samples_per_pixel = 64;  // paths; >= 1; powers of two are best
    std::uint64_t seed = 1;
    bool with_lobe_errors = false;  // RenderedShot::lobe_variance too
    // So many paths in the mean, shared out by plan_paths() for an image as free of noise as they
    // allow, where they are worth a pilot.
    bool adaptive = false;
};

// Standard errors of a lobe, finite.
struct LobeError {
    double specular = 0;   // of Ps [-]
    double roughness = 0;  // of sigma [rad]
    bool filled = false;   // not fitted to looks of its own
};

struct RenderedShot {
    Image radiance;  // three channels [radiance]; 0 where there is no surface
    // Per pixel: the TexelStatus of what it shows; off_surface unless the pixel shows the surface
    // alone (registered cameras: for at least half of the pixel); the highest where it shows
    // several texels.
    std::vector<std::uint8_t> status;
    // What the standard errors of Ps and sigma do to each pixel beyond what residuals of used shots
    // show [radiance^2], three channels. Measured lobes: all of it, for the few looks in a lobe
    // decide it and leave no residual. Filled ones: by how much deeper this shot looks into the
    // lobe than any used one. Direct light alone; Ps and sigma err independently, all that one
    // pixel shows errs alike. Empty unless asked for.
    Image lobe_variance;
    // What the paths' noise does to each pixel, an unbiased estimate by noise_variance()
    // [radiance^2], three channels. Empty unless the image is adaptive.
    Image noise_variance;
};

// Keeps references to the capture.
class ShotRenderer {
  public:
    // result_place: the result's folder, for the error when its maps are of another size than the
    // capture's texel domain.
    ShotRenderer(const Capture& capture,
                 const ReflectanceMaps& maps,
                 const std::string& result_place);

    // A pixel is the mean over paths spread over its footprint (registered cameras: over its
    // texel). Adds the paths to the progress. The same bytes for any number of threads.
    [[nodiscard]] RenderedShot render(std::size_t shot,
                                      const ShotRenderOptions& options,
                                      Progress& progress) const;
    // Paths that render() traces at most, for the progress.
    [[nodiscard]] std::uint64_t num_paths(std::size_t shot, const ShotRenderOptions& options) const;

  private:
    const Capture& capture_;
    Tracer tracer_;
    UvLocator locator_;
    std::vector<Reflectance> reflectance_;  // per texel of the atlas
    std::vector<LobeError> errors_;         // per texel of the atlas
    std::vector<std::uint8_t> status_;      // per texel of the atlas
};

}  // namespace patina
