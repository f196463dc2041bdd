// The paper's objects B (a cat) and C (a pig) as solids and materials given by formula.
//
// Upright axis y, standing on y = 0, facing +z. The figurines are nearly star-shaped about the y
// axis at every height, because a rotating range finder sees the outermost surface only.
// docs/objects.md.
#pragma once

#include "patina/reflectance/lobe.h"
#include "patina/scan/implicit.h"
#include "patina/scene/mesh.h"

#include <functional>

namespace patina {

struct Figurine {
    SignedDistance distance;  // [m]
    Bounds bounds;            // the solid lies inside with a margin [m]
    // Reflectance at a point of the surface with its outward unit normal.
    std::function<Reflectance(const Vec3& p, const Vec3& n)> reflectance;
};

[[nodiscard]] Figurine make_cat();
[[nodiscard]] Figurine make_pig();

// Radius of what counts as a crease where the figurines' glaze is brighter [m].
inline constexpr double kCreaseRadius = 0.008;

// How much the solid fills the ball that touches the surface at p from outside: 0 on flat and
// convex surface, towards 1 in narrow creases. radius: of what counts as narrow [length].
[[nodiscard]] double crease_depth(const SignedDistance& distance,
                                  const Vec3& p,
                                  const Vec3& n,
                                  double radius);

}  // namespace patina
