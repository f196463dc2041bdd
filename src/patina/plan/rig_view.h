// What the cameras of a rig see, and which of its lamps may be chosen: what every rule of choice
// starts from. Needs the geometry, the cameras and the lamps; no images.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/capture.h"
#include "patina/observe/camera_view.h"
#include "patina/transport/direct.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// The surface as the cameras see it. capture must outlive it.
class RigView {
  public:
    // Throws Error when no camera sees the surface.
    RigView(const Capture& capture, Progress& progress);

    [[nodiscard]] const Capture& capture() const { return *capture_; }
    // One entry per texel, of camera `camera` of the description.
    [[nodiscard]] const std::vector<TexelView>& views(std::size_t camera) const {
        return views_[camera];
    }
    // The same for a camera that is not in the description.
    [[nodiscard]] std::vector<TexelView> views_of(const Camera& camera) const;
    [[nodiscard]] LargeVector<DirectLight> direct(const Light& light) const;
    // Texels that some camera sees at all, ascending.
    [[nodiscard]] const std::vector<TexelId>& seen() const { return seen_; }

  private:
    const Capture* capture_;
    Tracer tracer_;
    std::vector<std::vector<TexelView>> views_;
    std::vector<TexelId> seen_;
};

// Cosines to the normal that a look must exceed to count [-].
struct LookLimits {
    double min_cos_i = 0;
    double min_cos_v = 0;
};

// Whether a look is clear of shadow edges and silhouettes and within the limits.
[[nodiscard]] bool is_usable(const DirectLight& direct,
                             const TexelView& view,
                             const LookLimits& limits);

// Lights that turn with a scanner need a camera that does.
[[nodiscard]] bool may_go_together(const Camera& camera, const Light& light);

// Lights that may be chosen, ascending: all but those taken already and those that only held-out
// shots use. Throws Error when there is none.
[[nodiscard]] std::vector<std::size_t> candidate_lights(const CaptureDescription& description,
                                                        std::span<const std::size_t> taken);

}  // namespace patina
