// Flat rectangles under one another in one texture: object A, and the grooves that test
// convergence.
#pragma once

#include "patina/scene/mesh.h"

#include <vector>

namespace patina {

// A rectangle that reflects on the side of right x up, where up = -down.
struct Panel {
    Vec3 corner = Vec3::Zero();  // of the texture's top-left end [length]
    Vec3 right = Vec3::UnitX();  // the whole edge along a row of texels [length]
    Vec3 down = -Vec3::UnitY();  // the whole edge along a column of texels [length]
    int parts = 1;               // its share of the texture's rows, relative to the other panels'
};

// Sum of the panels' parts.
[[nodiscard]] int total_parts(const std::vector<Panel>& panels);

// A chart per panel, stacked from v = 1 down; each a grid of kPanelCells x kPanelCells squares cut
// in two, with the panel's own normals.
inline constexpr int kPanelCells = 32;
[[nodiscard]] Mesh mesh_of_panels(const std::vector<Panel>& panels);

// The point of that mesh at (u, 1 - v) in [0, 1)^2 of the texture.
[[nodiscard]] SurfacePoint point_on_panels(const Mesh& mesh,
                                           const std::vector<Panel>& panels,
                                           const Vec2& texture);

}  // namespace patina
