// What light travels over: geometry, its acceleration structure, and the reflectance at every
// point; and the light that arrives there straight from the lamps, which is computed, never
// sampled.
//
// A surface reflects on the side that its geometric normal points to; its back is black and stops
// light. Cosines are taken from the smooth normal; where one is not positive, nothing is reflected.
#pragma once

#include "patina/raytrace/tracer.h"
#include "patina/reflectance/lobe.h"
#include "patina/scene/atlas.h"
#include "patina/scene/light.h"
#include "patina/scene/mesh.h"

#include <span>
#include <vector>

namespace patina {

// Reflectance over a surface: either per vertex, linear over each triangle (objects made by
// formula), or per texel (estimated maps; nearest texel). Does not own what it points to.
class ReflectanceField {
  public:
    // vertices: one per vertex of the mesh.
    [[nodiscard]] static ReflectanceField per_vertex(const Mesh& mesh,
                                                     std::span<const Reflectance> vertices);
    // texels: one per texel of the atlas, which was built from the mesh.
    [[nodiscard]] static ReflectanceField per_texel(const Mesh& mesh,
                                                    const TexelAtlas& atlas,
                                                    std::span<const Reflectance> texels);

    // Black where a per-texel field has no texel.
    [[nodiscard]] Reflectance at(std::uint32_t triangle, const Vec2f& barycentric) const;

  private:
    const Mesh* mesh_ = nullptr;
    const TexelAtlas* atlas_ = nullptr;  // null: per vertex
    std::span<const Reflectance> values_;
};

struct Surface {
    const Mesh* mesh = nullptr;
    const Tracer* tracer = nullptr;
};

// Whether the point has a front towards w (unit, away from the surface): both normals face it.
[[nodiscard]] inline bool faces(const SurfacePoint& point, const Vec3& w) {
    return point.geometric_normal.dot(w) > 0 && point.normal.dot(w) > 0;
}

// Whether nothing lies between the point and the light, and the point reflects on that side: both
// the geometric and the smooth normal face the light.
[[nodiscard]] bool is_lit(const Surface& surface,
                          const SurfacePoint& point,
                          const LightSample& light);

// Irradiance at the point straight from the lamps, shadows included [radiance x sr]. azimuth [rad]:
// of the scanner, for lights that turn with it.
[[nodiscard]] Rgb direct_irradiance(const Surface& surface,
                                    std::span<const Light> lights,
                                    double azimuth,
                                    const SurfacePoint& point);

// Radiance that the point sends towards w_o (unit, away from the surface) of the light straight
// from the lamps [radiance]. Zero on the surface's back.
[[nodiscard]] Rgb direct_radiance(const Surface& surface,
                                  const Reflectance& reflectance,
                                  std::span<const Light> lights,
                                  double azimuth,
                                  const SurfacePoint& point,
                                  const Vec3& w_o);

}  // namespace patina
