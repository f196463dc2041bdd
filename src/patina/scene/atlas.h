// The texel atlas: which piece of surface each texel stands for.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/scene/mesh.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace patina {

using TexelId = std::uint32_t;
inline constexpr TexelId kNoTexel = std::numeric_limits<TexelId>::max();

// One texel whose centre lies on the surface.
struct Texel {
    int column = 0;
    int row = 0;
    SurfacePoint point;  // at the texel's centre
    double area = 0;     // of all surface that is looked up in this texel [length^2]
    double azimuth = 0;  // of its column [rad]; 0 unless the geometry is a cylindrical range image
    std::uint32_t chart = 0;
};

// Texels are numbered row by row. Cells that hold surface but whose centre lies off it belong to
// the nearest texel of the same chart, so every point of the surface has a texel and areas add up
// to the area of the mesh.
struct TexelAtlas {
    int width = 0;
    int height = 0;
    bool wraps_around = false;  // column 0 follows the last one (cylindrical scans)
    LargeVector<Texel> texels;
    std::vector<TexelId> cell_owner;  // width x height; kNoTexel where there is no surface
    std::vector<TexelId>
        cell_texel;  // width x height; kNoTexel unless the centre is on the surface
    std::vector<std::uint32_t> neighbor_begin;  // texels.size() + 1 offsets into neighbors
    std::vector<TexelId> neighbors;  // adjacent on the surface, also across chart seams, ascending

    // The texel that a point of the surface is looked up in.
    [[nodiscard]] TexelId lookup(const Mesh& mesh,
                                 std::uint32_t triangle,
                                 const Vec2f& barycentric) const;
};

// mesh: with uvs in [0,1]^2, charts not overlapping. Texel (i, j) has uv ((i+0.5)/W, 1-(j+0.5)/H).
[[nodiscard]] TexelAtlas build_atlas(const Mesh& mesh, int width, int height);

// Gives each texel of a cylindrical range image the azimuth of its column [rad].
struct RangeFrame;
void set_scanner_columns(TexelAtlas& atlas, const RangeFrame& frame);

}  // namespace patina
