// Texture coordinates for meshes that come without.
#pragma once

#include "patina/scene/mesh.h"

#include <optional>

namespace patina {

// Gives every triangle a chart of its own: right triangles of one size, two to a square of a grid
// over the width x height texels. No texel is touched by two charts, and every chart holds at least
// one texel centre. uvs lie inside [0,1]^2, v up. Vertices are stored once per triangle; positions
// and normals stay. Nothing where there are too few texels: 9 for every two triangles, and what the
// squares leave over at the borders.
[[nodiscard]] std::optional<Mesh> unwrap(const Mesh& mesh, int width, int height);

}  // namespace patina
