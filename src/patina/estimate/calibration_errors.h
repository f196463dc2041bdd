// What the errors of calibration that a capture states would change in the looks at a texel: lamps
// that stand elsewhere or shine brighter, a normal that is tilted, images that are shifted against
// the geometry.
#pragma once

#include "patina/capture/capture.h"
#include "patina/estimate/observations.h"
#include "patina/estimate/texel_fit.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace patina {

enum class SharedErrorKind { lamp_position, lamp_direction, lamp_intensity, image_shift };

// One error that all texels share.
struct SharedError {
    SharedErrorKind kind = SharedErrorKind::lamp_position;
    std::size_t index =
        0;  // of the lamp among the capture's; of the camera among the scene's views
    // Position: x, y or z of the world (or of the scanner, for lamps that turn with it). Direction:
    // one of two across it. Shift: x or y of the image.
    int axis = 0;
};

// What one shared error changes in the looks at one texel.
struct SharedChange {
    std::size_t error = 0;      // its number among CalibrationErrors::shared()
    std::vector<Rgb> radiance;  // of every row, per standard deviation [radiance]
};

// What residuals tell of one [length, rad, relative, pixels].
struct FoundError {
    SharedErrorKind kind = SharedErrorKind::lamp_position;
    std::string id;     // of the lamp or camera
    int axis = 0;       // as in SharedError
    double stated = 0;  // standard deviation in the capture; > 0
    // Lamp: what to add to what the capture states. Shift: how far along x or y the image has to be
    // moved to lie on the geometry.
    double value = 0;
    double standard_error = 0;
};

class CalibrationErrors {
  public:
    CalibrationErrors(const Capture& capture,
                      const SceneView& scene,
                      const Observations& observations);

    // All that the capture states of lamps and cameras that are used.
    [[nodiscard]] const std::vector<SharedError>& shared() const { return shared_; }
    // error: one of shared(). In standard deviations: its value and what of it is unknown.
    [[nodiscard]] FoundError found(const SharedError& error,
                                   double value,
                                   double standard_error) const;

    // change: of the predicted radiance of every row of the texel when one error is one standard
    // deviation. shared_error: which of shared() it is; nothing for the texel's own (its normal).
    using Visit =
        std::function<void(std::span<const Rgb> change, std::optional<std::size_t> shared_error)>;
    // Calls `visit` once per independent error that touches the texel. rows: those of the texel's
    // looks. Errors that the capture does not state are left out, but for the normals' own: those
    // that lie between samples are not exact. Indirect light follows a lamp's intensity and nothing
    // else.
    void visit(std::size_t texel,
               std::span<const FitRow> rows,
               const Reflectance& fitted,
               const Visit& visit) const;

    // What shifts of the images change in the looks while the maps stay on the surface: the direct
    // light's own change from texel to texel. The maps' texture, which moves along, only looks like
    // other maps; and taken from the images, as visit() does, it would be mostly noise here.
    [[nodiscard]] std::vector<SharedChange> light_shifts(std::size_t texel,
                                                         std::span<const FitRow> rows,
                                                         const Reflectance& fitted) const;

  private:
    void add_shared(SharedErrorKind kind, std::size_t index, int num_axes);

    const Capture& capture_;
    const SceneView& scene_;
    const Observations& observations_;
    std::vector<SharedError> shared_;
};

}  // namespace patina
