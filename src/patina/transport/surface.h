// What light travels over: geometry, its acceleration structure, and the reflectance at every point.
#pragma once

#include "patina/raytrace/tracer.h"
#include "patina/reflectance/lobe.h"
#include "patina/scene/atlas.h"
#include "patina/scene/light.h"
#include "patina/scene/mesh.h"

#include <span>
#include <vector>

namespace patina {

// Reflectance over a surface: either per vertex, linear over each triangle (objects made by formula), or
// per texel (estimated maps; nearest texel). Does not own what it points to.
class ReflectanceField {
  public:
    [[nodiscard]] static ReflectanceField per_vertex(const Mesh& mesh,
                                                     std::span<const Reflectance> vertices);
    [[nodiscard]] static ReflectanceField per_texel(const Mesh& mesh,
                                                    const TexelAtlas& atlas,
                                                    std::span<const Reflectance> texels);

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

// Whether nothing lies between the point and the light, and the point reflects on that side: both the
// geometric and the smooth normal face the light.
[[nodiscard]] bool is_lit(const Surface& surface, const SurfacePoint& point, const LightSample& light);

}  // namespace patina
