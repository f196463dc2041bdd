// A triangle mesh with optional smooth normals and texture coordinates, in memory.
#pragma once

#include "patina/math/types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patina {

using Triangle = std::array<std::uint32_t, 3>;

// Vertices carry everything: a vertex with two texture coordinates or two normals is stored twice.
// A surface reflects on the side that its geometric normal (right-hand rule) points to.
struct Mesh {
    std::vector<Vec3f> positions;     // [length]
    std::vector<Vec3f> normals;       // unit, one per vertex; zero vector where the file gave none
    std::vector<Vec2f> uvs;           // one per vertex, or empty; v up, as in OBJ
    std::vector<Triangle> triangles;  // counter-clockwise seen from outside
};

// A point on a mesh. Barycentric: p = (1-u-v) p0 + u p1 + v p2.
struct SurfacePoint {
    Vec3 position = Vec3::Zero();
    Vec3 geometric_normal = Vec3::UnitZ();
    Vec3 normal = Vec3::UnitZ();  // smooth where the mesh has smooth normals
    std::uint32_t triangle = 0;
    Vec2f barycentric = Vec2f::Zero();
};

[[nodiscard]] SurfacePoint surface_point(const Mesh& mesh,
                                         std::uint32_t triangle,
                                         const Vec2f& barycentric);

// Texture coordinates at a point; the mesh must have them.
[[nodiscard]] Vec2 surface_uv(const Mesh& mesh, std::uint32_t triangle, const Vec2f& barycentric);

struct Bounds {
    Vec3 low = Vec3::Zero();
    Vec3 high = Vec3::Zero();
    [[nodiscard]] Vec3 center() const { return 0.5 * (low + high); }
    [[nodiscard]] double diagonal() const { return (high - low).norm(); }
};
[[nodiscard]] Bounds bounds_of(const Mesh& mesh);

// Area of a triangle [length^2].
[[nodiscard]] double triangle_area(const Mesh& mesh, std::uint32_t triangle);

}  // namespace patina
