// Finds triangles of a mesh that cover the same place of the texture.
#pragma once

#include "patina/scene/mesh.h"

#include <cstdint>
#include <optional>

namespace patina {

struct UvOverlap {
    std::uint32_t first = 0;  // triangles, first < second
    std::uint32_t second = 0;
};

// The pair of overlapping triangles with the lowest numbers, if there is any. Two triangles overlap
// when one would have to be shifted by more than `tolerance` (> 0, in uv) to leave the other:
// neighbours that share an edge or a corner do not, nor do charts that touch to within rounding.
// Exact but for rounding; n log n for meshes whose triangles are not all long and slanted.
[[nodiscard]] std::optional<UvOverlap> find_uv_overlap(const Mesh& mesh, double tolerance);

}  // namespace patina
