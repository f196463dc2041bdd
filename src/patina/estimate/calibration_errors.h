// What the errors of calibration that a capture states would change in the looks at a texel: lamps
// that stand elsewhere or shine brighter, a normal that is tilted, images that are shifted against
// the geometry.
#pragma once

#include "patina/capture/capture.h"
#include "patina/estimate/observations.h"
#include "patina/estimate/texel_fit.h"

#include <functional>
#include <span>

namespace patina {

class CalibrationErrors {
  public:
    CalibrationErrors(const Capture& capture,
                      const SceneView& scene,
                      const Observations& observations)
        : capture_(capture), scene_(scene), observations_(observations) {}

    // Calls `visit` once per independent error with the change of the predicted radiance of every
    // row of the texel when that error is one standard deviation. rows: those of the texel's looks.
    // Errors that the capture does not state are left out, but for the normals' own: those that lie
    // between samples are not exact. Indirect light follows a lamp's
    // intensity and nothing else.
    void visit(std::size_t texel,
               std::span<const FitRow> rows,
               const Reflectance& fitted,
               const std::function<void(std::span<const Rgb>)>& visit) const;

  private:
    const Capture& capture_;
    const SceneView& scene_;
    const Observations& observations_;
};

}  // namespace patina
