#include "patina/scene/polygon_soup.h"

#include "patina/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <span>
#include <tuple>

namespace patina {
namespace {

// Cutting up a polygon takes up to the cube of its corners in time.
constexpr std::size_t kMaxCorners = 1024;

void check_finite(const PolygonSoup& soup, const MeshPlace& place) {
    const auto check = [&](const auto& values, const char* what) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (values[i].allFinite()) continue;
            place.fail(fmt::format("{} {} is not finite", what, i), "finite numbers");
        }
    };
    check(soup.positions, "vertex");
    check(soup.uvs, "texture coordinate");
    check(soup.normals, "normal");
}

void check_indices(const PolygonSoup& soup, const MeshPlace& place) {
    const auto check = [&](std::uint32_t index, std::size_t count, const char* what) {
        if (index < count) return;
        place.fail(fmt::format("a face uses {} {}", what, index),
                   fmt::format("indices from 0 to below {}", count));
    };
    std::size_t num_with_uv = 0;
    for (const PolygonCorner& corner : soup.corners) {
        check(corner.position, soup.positions.size(), "vertex");
        if (corner.normal != kNoIndex) check(corner.normal, soup.normals.size(), "normal");
        if (corner.uv == kNoIndex) continue;
        check(corner.uv, soup.uvs.size(), "texture coordinate");
        ++num_with_uv;
    }
    if (num_with_uv != 0 && num_with_uv != soup.corners.size()) {
        place.fail("only some faces have texture coordinates", "all of them, or none");
    }
}

void check_corner_count(std::size_t count, const MeshPlace& place) {
    if (count >= 3 && count <= kMaxCorners) return;
    place.fail(fmt::format("a face has {} corners", count),
               fmt::format("from 3 to {}", kMaxCorners));
}

// Newell's normal, twice the area long; right for polygons that are not convex or not quite flat.
Vec3 newell_normal(std::span<const Vec3> ring) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < ring.size(); ++i) {
        sum += (ring[i] - ring[0]).cross(ring[(i + 1) % ring.size()] - ring[0]);
    }
    return sum;
}

bool contains(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal, const Vec3& p) {
    return (b - a).cross(p - a).dot(normal) >= 0 && (c - b).cross(p - b).dot(normal) >= 0 &&
           (a - c).cross(p - c).dot(normal) >= 0;
}

// Whether the corner at ring position i can be cut off: convex, and no other corner inside the cut.
bool is_ear(std::span<const Vec3> points,
            std::span<const std::size_t> ring,
            std::size_t i,
            const Vec3& normal) {
    const std::size_t count = ring.size();
    const Vec3& a = points[ring[(i + count - 1) % count]];
    const Vec3& b = points[ring[i]];
    const Vec3& c = points[ring[(i + 1) % count]];
    if ((b - a).cross(c - b).dot(normal) <= 0) return false;
    return std::none_of(ring.begin(), ring.end(), [&](std::size_t k) {
        const Vec3& p = points[k];
        return p != a && p != b && p != c && contains(a, b, c, normal, p);
    });
}

// Triangles as positions in the polygon. Where no ear is left (no area, or crossing itself) the
// first corner is cut off, so that there are always points.size() - 2 of them.
std::vector<std::array<std::size_t, 3>> clip_ears(std::span<const Vec3> points) {
    std::vector<std::array<std::size_t, 3>> triangles;
    std::vector<std::size_t> ring(points.size());
    std::iota(ring.begin(), ring.end(), std::size_t{0});
    const Vec3 normal = newell_normal(points);
    while (ring.size() > 3) {
        std::size_t ear = 1;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const std::size_t candidate = (i + 1) % ring.size();
            if (!is_ear(points, ring, candidate, normal)) continue;
            ear = candidate;
            break;
        }
        const std::size_t count = ring.size();
        triangles.push_back({ring[(ear + count - 1) % count], ring[ear], ring[(ear + 1) % count]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    triangles.push_back({ring[0], ring[1], ring[2]});
    return triangles;
}

// Gives equal corners the same vertex; uvs are compared by value, as some files repeat them.
class CornerWelder {
  public:
    explicit CornerWelder(const PolygonSoup& soup) : soup_(soup) {}

    std::uint32_t vertex(const PolygonCorner& corner, Mesh& mesh) {
        const bool has_uv = corner.uv != kNoIndex;
        const Vec2f uv = has_uv ? soup_.uvs[corner.uv] : Vec2f(0, 0);
        // Adding 0 makes -0 and 0 the same bits.
        const Key key{corner.position,
                      corner.normal,
                      std::bit_cast<std::uint32_t>(uv.x() + 0.0f),
                      std::bit_cast<std::uint32_t>(uv.y() + 0.0f)};
        const auto next = static_cast<std::uint32_t>(mesh.positions.size());
        const auto [entry, is_new] = vertices_.try_emplace(key, next);
        if (!is_new) return entry->second;
        mesh.positions.push_back(soup_.positions[corner.position]);
        mesh.normals.push_back(corner.normal == kNoIndex
                                   ? Vec3f(0, 0, 0)
                                   : soup_.normals[corner.normal].stableNormalized());
        if (has_uv) mesh.uvs.push_back(uv);
        return next;
    }

  private:
    using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;
    const PolygonSoup& soup_;
    std::map<Key, std::uint32_t> vertices_;
};

}  // namespace

void MeshPlace::fail(const std::string& problem, const std::string& expected) const {
    throw Error(path.string(), field, problem, expected);
}

Mesh mesh_from_soup(const PolygonSoup& soup, const MeshPlace& place) {
    check_finite(soup, place);
    check_indices(soup, place);
    Mesh mesh;
    CornerWelder welder(soup);
    std::size_t begin = 0;
    for (const std::size_t end : soup.polygon_ends) {
        const std::span<const PolygonCorner> corners(soup.corners.data() + begin, end - begin);
        begin = end;
        check_corner_count(corners.size(), place);
        std::vector<Vec3> points;
        for (const PolygonCorner& corner : corners) {
            points.push_back(soup.positions[corner.position].cast<double>());
        }
        for (const auto& t : clip_ears(points)) {
            // One statement each: vertices are numbered in this order.
            const std::uint32_t a = welder.vertex(corners[t[0]], mesh);
            const std::uint32_t b = welder.vertex(corners[t[1]], mesh);
            const std::uint32_t c = welder.vertex(corners[t[2]], mesh);
            mesh.triangles.push_back({a, b, c});
        }
    }
    if (mesh.triangles.empty()) place.fail("has no faces", "a surface of triangles or polygons");
    return mesh;
}

}  // namespace patina
