// What the triangles of a mesh leave in each cell of the texel domain: the first step of the atlas
// (atlas.h).
#pragma once

#include "patina/base/large_vector.h"
#include "patina/scene/mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patina {

// A triangle in cell coordinates: x = u W to the right, y = (1 - v) H down.
using CellTriangle = std::array<Vec2, 3>;

[[nodiscard]] CellTriangle cell_triangle(const Mesh& mesh,
                                         std::uint32_t triangle,
                                         int width,
                                         int height);

// What one cell of the texel domain holds.
struct Cell {
    double area = 0;             // of all surface in it [length^2]
    double largest_overlap = 0;  // of one triangle [cells]
    std::uint32_t largest_triangle = 0;
    bool has_center = false;
    std::uint32_t center_triangle = 0;
    Vec2f center_barycentric = Vec2f::Zero();
};

// Row by row from the top, width x height cells.
[[nodiscard]] LargeVector<Cell> rasterize_cells(const Mesh& mesh, int width, int height);

}  // namespace patina
