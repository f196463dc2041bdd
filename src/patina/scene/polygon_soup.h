// What mesh files have in common: polygons whose corners point into lists of positions, uvs and
// normals.
#pragma once

#include "patina/scene/mesh.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace patina {

inline constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();

struct PolygonCorner {
    std::uint32_t position = 0;
    std::uint32_t uv = kNoIndex;
    std::uint32_t normal = kNoIndex;
};

struct PolygonSoup {
    std::vector<Vec3f> positions;
    std::vector<Vec2f> uvs;      // v up
    std::vector<Vec3f> normals;  // of any length
    std::vector<PolygonCorner> corners;
    std::vector<std::size_t> polygon_ends;  // into corners, one per polygon
};

// Throws errors about one mesh file.
struct MeshPlace {
    std::filesystem::path path;
    std::string field;

    [[noreturn]] void fail(const std::string& problem, const std::string& expected) const;
};

// Readers of one format each; contents: the whole file.
[[nodiscard]] PolygonSoup parse_obj(const std::string& contents, const MeshPlace& place);
[[nodiscard]] PolygonSoup parse_ply(const std::string& contents, const MeshPlace& place);
[[nodiscard]] PolygonSoup parse_gltf(const std::string& contents, const MeshPlace& place);

// Triangulates (ears are clipped, so polygons need not be convex) and gives every combination of
// position, uv and normal its vertex. Throws where an index is out of range, a number is not
// finite, only some corners have uvs, or no triangle is left.
[[nodiscard]] Mesh mesh_from_soup(const PolygonSoup& soup, const MeshPlace& place);

}  // namespace patina
