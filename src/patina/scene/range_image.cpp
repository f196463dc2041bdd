#include "patina/scene/range_image.h"

#include "patina/base/check.h"
#include "patina/base/large_vector.h"
#include "patina/base/parallel.h"
#include "patina/math/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

namespace patina {
namespace {

constexpr double kFullTurnTolerance = 1e-9;  // [rad]; rounding of degrees to radians is below 1e-14
constexpr double kMaxStepOfMedian = 4;       // the capture format's default
constexpr int kMinColumnsOfTurn = 3;         // fewer have no inside
constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

bool is_measured(const RangeFrame& frame, float value) {
    const bool any_sign = frame.projection == RangeProjection::camera &&
                          frame.camera.model == CameraModel::orthographic;
    return std::isfinite(value) && (any_sign || value > 0);
}

Vec3 point_at(const RangeFrame& frame, const Image& range, int i, int j) {
    const double value = double(range.at(i, j));
    if (frame.projection == RangeProjection::cylindrical) {
        const double share = (j + 0.5) / range.height;
        const double y = frame.height_end - share * (frame.height_end - frame.height_begin);
        return rotate_about_y(column_azimuth(frame, range.width, i), Vec3(0, y, value));
    }
    const Ray ray = frame.camera.ray(Vec2(i + 0.5, j + 0.5));
    const Vec3 forward = frame.camera.world_from_camera.direction(Vec3::UnitZ());
    return ray.origin + ray.direction * (value / ray.direction.dot(forward));
}

template <typename Body>
void for_each_row(int num_rows, const Body& body) {
    parallel_for(
        std::size_t(std::max(num_rows, 0)), [&body](std::size_t j) { body(int(j)); }, 1);
}

// What collect(j, list) puts on the list of every row, one row behind the other.
template <typename List, typename Collect>
List by_rows(int num_rows, const Collect& collect) {
    std::vector<std::vector<typename List::value_type>> rows(std::size_t(std::max(num_rows, 0)));
    for_each_row(num_rows, [&](int j) { collect(j, rows[std::size_t(j)]); });
    std::size_t total = 0;
    for (const auto& row : rows) total += row.size();
    List all;
    all.reserve(total);
    for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
    return all;
}

// The measured points on their grid; columns beyond the last one continue at the first in a full
// turn.
class Grid {
  public:
    Grid(const RangeFrame& frame, const Image& range)
        : width_(range.width),
          height_(range.height),
          wraps_(frame.wraps_around() && range.width >= kMinColumnsOfTurn),
          points_(range.data.size(), Vec3::Zero()),
          measured_(range.data.size(), 0) {
        for_each_row(height_, [&](int j) {
            for (int i = 0; i < width_; ++i) {
                if (!is_measured(frame, range.at(i, j))) continue;
                measured_[range.index(i, j)] = 1;
                points_[range.index(i, j)] = point_at(frame, range, i, j);
            }
        });
        max_step_ = frame.max_step ? *frame.max_step : kMaxStepOfMedian * median_step();
    }

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] std::size_t size() const { return points_.size(); }
    // Quads between columns, counting the one across the seam.
    [[nodiscard]] int num_quad_columns() const { return wraps_ ? width_ : width_ - 1; }
    [[nodiscard]] const Vec3& point(std::size_t index) const { return points_[index]; }

    // Index of a measured pixel; nothing off the grid or where nothing was measured.
    [[nodiscard]] std::optional<std::size_t> find(int i, int j) const {
        if (wraps_) i = (i + width_) % width_;
        if (i < 0 || i >= width_ || j < 0 || j >= height_) return std::nullopt;
        const std::size_t index = std::size_t(j) * std::size_t(width_) + std::size_t(i);
        if (measured_[index] == 0) return std::nullopt;
        return index;
    }
    [[nodiscard]] double distance(std::size_t a, std::size_t b) const {
        return (points_[a] - points_[b]).norm();
    }
    [[nodiscard]] bool joined(std::size_t a, std::size_t b) const {
        return distance(a, b) <= max_step_;
    }

  private:
    [[nodiscard]] double median_step() const {
        std::vector<double> steps = by_rows<std::vector<double>>(height_, [&](int j, auto& row) {
            for (int i = 0; i < width_; ++i) {
                const auto here = find(i, j);
                if (!here) continue;
                if (const auto right = find(i + 1, j)) row.push_back(distance(*here, *right));
                if (const auto below = find(i, j + 1)) row.push_back(distance(*here, *below));
            }
        });
        return steps.empty() ? 0 : median(std::move(steps));
    }

    int width_;
    int height_;
    bool wraps_;
    LargeVector<Vec3> points_;
    std::vector<char> measured_;
    double max_step_ = 0;  // [length]
};

// Corners as pixel indices, counter-clockwise in an image whose y runs down.
using PixelTriangle = std::array<std::size_t, 3>;

void add_if_joined(const Grid& grid,
                   const PixelTriangle& t,
                   std::vector<PixelTriangle>& triangles) {
    if (grid.joined(t[0], t[1]) && grid.joined(t[1], t[2]) && grid.joined(t[2], t[0])) {
        triangles.push_back(t);
    }
}

// The triangles of the quad whose top left corner is pixel (i, j).
void add_quad(const Grid& grid, int i, int j, std::vector<PixelTriangle>& triangles) {
    const std::array<std::optional<std::size_t>, 4> corners = {
        grid.find(i, j), grid.find(i, j + 1), grid.find(i + 1, j + 1), grid.find(i + 1, j)};
    std::array<std::size_t, 4> ring{};
    std::size_t num_found = 0;
    for (const auto& corner : corners) {
        if (corner) ring[num_found++] = *corner;
    }
    if (num_found == 3) add_if_joined(grid, {ring[0], ring[1], ring[2]}, triangles);
    if (num_found < 4) return;
    // Cut along the shorter diagonal.
    if (grid.distance(ring[0], ring[2]) > grid.distance(ring[1], ring[3])) {
        std::rotate(ring.begin(), ring.begin() + 1, ring.end());
    }
    add_if_joined(grid, {ring[0], ring[1], ring[2]}, triangles);
    add_if_joined(grid, {ring[0], ring[2], ring[3]}, triangles);
}

LargeVector<PixelTriangle> triangulate(const Grid& grid) {
    return by_rows<LargeVector<PixelTriangle>>(grid.height() - 1, [&](int j, auto& triangles) {
        for (int i = 0; i < grid.num_quad_columns(); ++i) add_quad(grid, i, j, triangles);
    });
}

// Sum over the quadrants about a pixel of the cross product of their two edges, each edge to a
// neighbour on the grid. With all four it equals the cross product of the central differences.
Vec3 quadrant_normal(const Grid& grid, int i, int j, std::size_t here) {
    constexpr std::array<std::array<int, 2>, 4> kRing = {{{1, 0}, {0, -1}, {-1, 0}, {0, 1}}};
    std::array<std::optional<Vec3>, 4> edges;
    for (std::size_t k = 0; k < 4; ++k) {
        const auto neighbor = grid.find(i + kRing[k][0], j + kRing[k][1]);
        if (neighbor && grid.joined(here, *neighbor)) {
            edges[k] = grid.point(*neighbor) - grid.point(here);
        }
    }
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
        const auto& a = edges[k];
        const auto& b = edges[(k + 1) % 4];
        if (a && b) sum += a->cross(*b);
    }
    return sum;
}

// One per pixel; zero for pixels without triangles.
LargeVector<Vec3> pixel_normals(const Grid& grid, std::span<const PixelTriangle> triangles) {
    LargeVector<Vec3> by_triangles(grid.size(), Vec3::Zero());
    std::vector<char> is_corner(grid.size(), 0);
    for (const PixelTriangle& t : triangles) {
        const Vec3 area_normal =
            (grid.point(t[1]) - grid.point(t[0])).cross(grid.point(t[2]) - grid.point(t[0]));
        for (const std::size_t corner : t) {
            by_triangles[corner] += area_normal;
            is_corner[corner] = 1;
        }
    }
    // Only corners of triangles are vertices.
    LargeVector<Vec3> normals(grid.size(), Vec3::Zero());
    for_each_row(grid.height(), [&](int j) {
        for (int i = 0; i < grid.width(); ++i) {
            const std::size_t here = std::size_t(j) * std::size_t(grid.width()) + std::size_t(i);
            if (is_corner[here] == 0) continue;
            const Vec3 by_quadrants = quadrant_normal(grid, i, j, here);
            // The corner of a lone triangle may have a neighbour on one axis only.
            normals[here] =
                (by_quadrants.isZero(0) ? by_triangles[here] : by_quadrants).normalized();
        }
    });
    return normals;
}

// Turns pixels and the points where the seam cuts an edge into vertices.
class MeshBuilder {
  public:
    MeshBuilder(const Grid& grid, LargeVector<Vec3> normals)
        : grid_(grid), normals_(std::move(normals)), vertex_of_(grid.size(), kNoVertex) {}

    // For so many triangles, but for what the seam adds.
    void reserve(std::size_t num_triangles) {
        mesh_.triangles.reserve(num_triangles);
        mesh_.positions.reserve(grid_.size());
        mesh_.normals.reserve(grid_.size());
        mesh_.uvs.reserve(grid_.size());
    }

    void add(const PixelTriangle& t) {
        if (crosses_seam(t)) {
            add_cut(t);
        } else {
            mesh_.triangles.push_back({vertex(t[0]), vertex(t[1]), vertex(t[2])});
        }
    }

    [[nodiscard]] Mesh finish(bool mirrored) {
        if (mirrored) {
            for (Triangle& t : mesh_.triangles) std::swap(t[1], t[2]);
            for (Vec3f& n : mesh_.normals) n = -n;
        }
        return std::move(mesh_);
    }

  private:
    [[nodiscard]] std::size_t column(std::size_t pixel) const {
        return pixel % std::size_t(grid_.width());
    }
    [[nodiscard]] Vec2 uv(std::size_t pixel) const {
        const std::size_t row = pixel / std::size_t(grid_.width());
        return {(double(column(pixel)) + 0.5) / grid_.width(),
                1 - (double(row) + 0.5) / grid_.height()};
    }
    [[nodiscard]] bool crosses_seam(const PixelTriangle& t) const {
        const auto [low, high] = std::minmax({column(t[0]), column(t[1]), column(t[2])});
        return high - low > 1;
    }

    std::uint32_t add_vertex(const Vec3& position, const Vec3& normal, const Vec2& uv_position) {
        mesh_.positions.push_back(position.cast<float>());
        mesh_.normals.push_back(normal.cast<float>());
        mesh_.uvs.push_back(uv_position.cast<float>());
        return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
    }

    std::uint32_t vertex(std::size_t pixel) {
        std::uint32_t& index = vertex_of_[pixel];
        if (index == kNoVertex) index = add_vertex(grid_.point(pixel), normals_[pixel], uv(pixel));
        return index;
    }

    // The middle of an edge from the last column to the first: once at u = 1 and once at u = 0.
    std::array<std::uint32_t, 2> cut_vertices(std::size_t a, std::size_t b) {
        const auto [entry, is_new] = cuts_.try_emplace(std::minmax(a, b));
        if (is_new) {
            const Vec3 position = 0.5 * (grid_.point(a) + grid_.point(b));
            const Vec3 normal = (normals_[a] + normals_[b]).normalized();
            const double v = 0.5 * (uv(a).y() + uv(b).y());
            entry->second = {add_vertex(position, normal, Vec2(1, v)),
                             add_vertex(position, normal, Vec2(0, v))};
        }
        return entry->second;
    }

    // One corner lies alone on its side of the seam: a triangle there, a quad on the other side.
    void add_cut(PixelTriangle t) {
        while ((column(t[0]) == 0) == (column(t[1]) == 0) ||
               (column(t[0]) == 0) == (column(t[2]) == 0)) {
            std::rotate(t.begin(), t.begin() + 1, t.end());
        }
        const std::size_t alone_side = column(t[0]) == 0 ? 1 : 0;
        const auto cut1 = cut_vertices(t[0], t[1]);
        const auto cut2 = cut_vertices(t[0], t[2]);
        mesh_.triangles.push_back({vertex(t[0]), cut1[alone_side], cut2[alone_side]});
        const std::size_t quad_side = 1 - alone_side;
        mesh_.triangles.push_back({cut1[quad_side], vertex(t[1]), vertex(t[2])});
        mesh_.triangles.push_back({cut1[quad_side], vertex(t[2]), cut2[quad_side]});
    }

    const Grid& grid_;
    LargeVector<Vec3> normals_;
    std::vector<std::uint32_t> vertex_of_;
    std::map<std::pair<std::size_t, std::size_t>, std::array<std::uint32_t, 2>> cuts_;
    Mesh mesh_;
};

}  // namespace

bool RangeFrame::wraps_around() const {
    return projection == RangeProjection::cylindrical &&
           std::abs(std::abs(azimuth_end - azimuth_begin) - 2 * kPi) < kFullTurnTolerance;
}

double column_azimuth(const RangeFrame& frame, int width, double column) {
    return frame.azimuth_begin + (frame.azimuth_end - frame.azimuth_begin) * (column + 0.5) / width;
}

Mesh mesh_from_range(const RangeFrame& frame, const Image& range) {
    PATINA_CHECK_EQ(range.channels, 1);
    const Grid grid(frame, range);
    const LargeVector<PixelTriangle> triangles = triangulate(grid);
    MeshBuilder builder(grid, pixel_normals(grid, triangles));
    builder.reserve(triangles.size());
    for (const PixelTriangle& t : triangles) builder.add(t);
    // Azimuth or height running backwards shows the surface as in a mirror.
    const bool mirrored =
        frame.projection == RangeProjection::cylindrical &&
        (frame.azimuth_end < frame.azimuth_begin) != (frame.height_end < frame.height_begin);
    return builder.finish(mirrored);
}

}  // namespace patina
