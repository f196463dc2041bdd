// Which camera sees which texel, where in its image, and from which side.
#pragma once

#include "patina/raytrace/tracer.h"
#include "patina/scene/atlas.h"
#include "patina/scene/camera.h"

#include <vector>

namespace patina {

enum class ViewState : std::uint8_t {
    hidden,  // behind another surface, facing away, or outside the image
    edge,    // seen, but the pixels it is read from also show another part of the surface
    clear
};

// How one camera sees one texel.
struct TexelView {
    Vec2f pixel = Vec2f::Zero();  // position in the image [pixels]
    Vec3f w_v = Vec3f::UnitZ();   // unit, towards the camera
    float cos_v = 0;              // to the smooth normal [-]
    ViewState state = ViewState::hidden;
};

// One entry per texel of the atlas. A texel counts as seen when its centre is.
[[nodiscard]] std::vector<TexelView> view_texels(const Mesh& mesh,
                                                 const Tracer& tracer,
                                                 const TexelAtlas& atlas,
                                                 const Camera& camera);

// Size of a pixel over size of a texel, median over the seen texels; 1 for registered cameras.
[[nodiscard]] double pixel_over_texel(const TexelAtlas& atlas,
                                      const Camera& camera,
                                      const std::vector<TexelView>& views);

}  // namespace patina
