// Finds the point of a mesh at a position in its texture.
#pragma once

#include "patina/scene/mesh.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace patina {

// A grid over [0, 1]^2 that lists the triangles near each cell. The mesh must outlive it, and have
// uvs whose charts do not overlap.
class UvLocator {
  public:
    // columns, rows: of the grid; about the texel domain's.
    UvLocator(const Mesh& mesh, int columns, int rows);

    // Nothing where the texture shows no surface. Where two triangles meet, the one of the lower
    // index.
    [[nodiscard]] std::optional<SurfacePoint> find(const Vec2& uv) const;

  private:
    [[nodiscard]] int column_of(double u) const;
    [[nodiscard]] int row_of(double v) const;

    const Mesh& mesh_;
    int columns_;
    int rows_;
    std::vector<std::uint32_t> begin_;  // cells + 1 offsets into triangles_
    std::vector<std::uint32_t> triangles_;
};

}  // namespace patina
