#include "patina/scan/surface_nets.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace patina {
namespace {

// Cells along an edge of the blocks in which empty space is skipped.
constexpr int kBlock = 4;
// Newton steps per vertex; each squares the remaining distance relative to the curvature's radius.
constexpr int kNewtonSteps = 4;
// A vertex this close to the surface, in cells, is on it: below the rounding of single precision.
constexpr double kOnSurface = 1e-5;
// Step of the gradient's central differences, in cells.
constexpr double kGradientStep = 0.05;

// Samples at the corners of the cells: num.x() x num.y() x num.z(), x fastest.
struct Grid {
    Vec3 origin;
    double cell = 0;
    Eigen::Vector3i num;
    std::vector<float> values;

    [[nodiscard]] std::size_t index(int x, int y, int z) const {
        return (std::size_t(z) * std::size_t(num.y()) + std::size_t(y)) * std::size_t(num.x()) +
               std::size_t(x);
    }
    [[nodiscard]] Vec3 corner(int x, int y, int z) const { return origin + cell * Vec3(x, y, z); }
    [[nodiscard]] bool inside(int x, int y, int z) const { return values[index(x, y, z)] < 0; }
};

void sample_block(const SignedDistance& distance, const Eigen::Vector3i& begin, Grid& grid) {
    const Eigen::Vector3i end = (begin.array() + kBlock).min(grid.num.array());
    const Vec3 center =
        grid.origin + grid.cell * (begin.cast<double>().array() + 0.5 * kBlock).matrix();
    const double reach = 0.5 * std::sqrt(3.0) * kBlock * grid.cell;
    const double at_center = distance(center);
    const bool is_far = std::abs(at_center) > kMaxDistanceRatio * reach;
    for (int z = begin.z(); z < end.z(); ++z) {
        for (int y = begin.y(); y < end.y(); ++y) {
            for (int x = begin.x(); x < end.x(); ++x) {
                const double value = is_far ? at_center : distance(grid.corner(x, y, z));
                grid.values[grid.index(x, y, z)] = float(value);
            }
        }
    }
}

Grid sample_grid(const SignedDistance& distance, const SurfaceNetsOptions& options) {
    Grid grid;
    grid.cell = options.cell;
    grid.origin = options.bounds.low;
    const Vec3 size = options.bounds.high - options.bounds.low;
    grid.num = (size / options.cell).array().ceil().cast<int>() + 1;
    grid.values.resize(std::size_t(grid.num.x()) * std::size_t(grid.num.y()) *
                       std::size_t(grid.num.z()));
    const Eigen::Vector3i blocks = (grid.num.array() + kBlock - 1) / kBlock;
    parallel_for(
        std::size_t(blocks.z()) * std::size_t(blocks.y()),
        [&](std::size_t row) {
            const int z = int(row) / blocks.y();
            const int y = int(row) % blocks.y();
            for (int x = 0; x < blocks.x(); ++x) {
                sample_block(distance, kBlock * Eigen::Vector3i(x, y, z), grid);
            }
        },
        1);
    return grid;
}

// The four corners of the face at corner p that is normal to `axis`, in order around the face.
std::array<std::size_t, 4> face_corners(const Grid& grid, const Eigen::Vector3i& p, int axis) {
    const Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3);
    const Eigen::Vector3i v = Eigen::Vector3i::Unit((axis + 2) % 3);
    const auto at = [&](const Eigen::Vector3i& q) { return grid.index(q.x(), q.y(), q.z()); };
    return {at(p), at(p + u), at(p + u + v), at(p + v)};
}

// Turns one outside corner of an ambiguous face into an inside one; returns whether it was
// ambiguous.
bool settle_face(const std::array<std::size_t, 4>& corners, std::vector<float>& values) {
    const auto inside = [&](std::size_t i) { return values[corners[i]] < 0; };
    if (inside(0) != inside(2) || inside(1) != inside(3) || inside(0) == inside(1)) return false;
    const std::size_t first = inside(0) ? 1 : 0;
    const std::size_t nearer =
        values[corners[first]] <= values[corners[first + 2]] ? first : first + 2;
    values[corners[nearer]] = -std::numeric_limits<float>::min();
    return true;
}

// Ends, since the inside only grows.
void settle_ambiguous_faces(Grid& grid) {
    bool changed = true;
    while (changed) {
        changed = false;
        for (int z = 0; z + 1 < grid.num.z(); ++z) {
            for (int y = 0; y + 1 < grid.num.y(); ++y) {
                for (int x = 0; x + 1 < grid.num.x(); ++x) {
                    for (int axis = 0; axis < 3; ++axis) {
                        const auto corners = face_corners(grid, {x, y, z}, axis);
                        changed |= settle_face(corners, grid.values);
                    }
                }
            }
        }
    }
}

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

// Mean of the crossings of the cell's edges, or nothing when no edge is crossed.
std::optional<Vec3> cell_crossing(const Grid& grid, int x, int y, int z) {
    std::array<double, 8> value;
    int num_inside = 0;
    for (int c = 0; c < 8; ++c) {
        const float sample = grid.values[grid.index(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))];
        value[std::size_t(c)] = sample;
        num_inside += sample < 0 ? 1 : 0;
    }
    if (num_inside == 0 || num_inside == 8) return std::nullopt;
    Vec3 sum = Vec3::Zero();
    int num_crossings = 0;
    for (int c = 0; c < 8; ++c) {
        for (int axis = 0; axis < 3; ++axis) {
            const int other = c | (1 << axis);
            const double a = value[std::size_t(c)];
            const double b = value[std::size_t(other)];
            if (other == c || (a < 0) == (b < 0)) continue;
            Vec3 crossing(c & 1, c >> 1 & 1, c >> 2);
            crossing[axis] += a / (a - b);
            sum += crossing;
            ++num_crossings;
        }
    }
    return grid.corner(x, y, z) + grid.cell * sum / num_crossings;
}

// Joins the four cells around one crossed grid edge along `axis`; ring: their vertices,
// counter-clockwise seen from the edge's far end.
void add_quad(const std::array<std::uint32_t, 4>& ring, bool starts_inside, Mesh& mesh) {
    for (const std::uint32_t vertex : ring) PATINA_CHECK_LT(vertex, kNoVertex);
    const auto& [a, b, c, d] = ring;
    const std::array<std::uint32_t, 4> quad =
        starts_inside ? ring : std::array<std::uint32_t, 4>{a, d, c, b};
    mesh.triangles.push_back({quad[0], quad[1], quad[2]});
    mesh.triangles.push_back({quad[0], quad[2], quad[3]});
}

// Vertex ids of the cells of one layer (constant z), and of the layer below it.
class Layers {
  public:
    explicit Layers(const Eigen::Vector3i& num)
        : num_x_(num.x()), size_(std::size_t(num.x()) * std::size_t(num.y())) {}

    void advance() {
        below_ = std::move(here_);
        here_.assign(size_, kNoVertex);
    }
    [[nodiscard]] std::uint32_t& here(int x, int y) { return here_[index(x, y)]; }
    [[nodiscard]] std::uint32_t below(int x, int y) const { return below_[index(x, y)]; }

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return std::size_t(y) * std::size_t(num_x_) + std::size_t(x);
    }
    int num_x_;
    std::size_t size_;
    std::vector<std::uint32_t> below_;
    std::vector<std::uint32_t> here_;
};

// The quads of the three grid edges that start at corner (x, y, z).
void add_quads_of_corner(const Grid& grid, int x, int y, int z, Layers& layers, Mesh& mesh) {
    const bool inside = grid.inside(x, y, z);
    if (inside != grid.inside(x + 1, y, z)) {
        add_quad(
            {layers.below(x, y - 1), layers.below(x, y), layers.here(x, y), layers.here(x, y - 1)},
            inside,
            mesh);
    }
    if (inside != grid.inside(x, y + 1, z)) {
        add_quad(
            {layers.below(x - 1, y), layers.here(x - 1, y), layers.here(x, y), layers.below(x, y)},
            inside,
            mesh);
    }
    if (inside != grid.inside(x, y, z + 1)) {
        add_quad({layers.here(x - 1, y - 1),
                  layers.here(x, y - 1),
                  layers.here(x, y),
                  layers.here(x - 1, y)},
                 inside,
                 mesh);
    }
}

Mesh connect(const Grid& grid) {
    Mesh mesh;
    Layers layers(grid.num);
    for (int z = 0; z + 1 < grid.num.z(); ++z) {
        layers.advance();
        for (int y = 0; y + 1 < grid.num.y(); ++y) {
            for (int x = 0; x + 1 < grid.num.x(); ++x) {
                if (const auto crossing = cell_crossing(grid, x, y, z)) {
                    layers.here(x, y) = std::uint32_t(mesh.positions.size());
                    mesh.positions.push_back(crossing->cast<float>());
                }
            }
        }
        if (z == 0) continue;
        for (int y = 1; y + 1 < grid.num.y(); ++y) {
            for (int x = 1; x + 1 < grid.num.x(); ++x) {
                add_quads_of_corner(grid, x, y, z, layers, mesh);
            }
        }
    }
    return mesh;
}

// Moves each vertex along the gradient onto the surface, at most one cell away from where it was.
void project_vertices(const SignedDistance& distance, double cell, Mesh& mesh) {
    mesh.normals.resize(mesh.positions.size());
    const double step = kGradientStep * cell;
    parallel_for(mesh.positions.size(), [&](std::size_t i) {
        const Vec3 start = mesh.positions[i].cast<double>();
        Vec3 p = start;
        for (int k = 0; k < kNewtonSteps; ++k) {
            const double value = distance(p);
            if (std::abs(value) < kOnSurface * cell) break;
            const Vec3 gradient = distance_gradient(distance, p, step);
            const double length_squared = gradient.squaredNorm();
            if (length_squared == 0) break;
            const Vec3 moved = p - value / length_squared * gradient;
            if ((moved - start).norm() > cell) break;
            p = moved;
        }
        mesh.positions[i] = p.cast<float>();
        mesh.normals[i] = distance_gradient(distance, p, step).normalized().cast<float>();
    });
}

// Area of a triangle as seen along its vertices' normals, relative to its edges: largest for an
// equilateral triangle that lies in the surface, negative for one that is folded over.
double triangle_quality(const Mesh& mesh, const Triangle& triangle) {
    const auto& [a, b, c] = triangle;
    const Vec3f ab = mesh.positions[b] - mesh.positions[a];
    const Vec3f ac = mesh.positions[c] - mesh.positions[a];
    const Vec3f normal = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
    const float edges = ab.squaredNorm() + ac.squaredNorm() + (ac - ab).squaredNorm();
    return edges > 0 ? double(ab.cross(ac).dot(normal) / edges) : 0.0;
}

// Cuts each quad (two consecutive triangles) along the better one of its diagonals.
void choose_diagonals(Mesh& mesh) {
    parallel_for(mesh.triangles.size() / 2, [&](std::size_t i) {
        Triangle& first = mesh.triangles[2 * i];
        Triangle& second = mesh.triangles[2 * i + 1];
        const Triangle other_first = {first[0], first[1], second[2]};
        const Triangle other_second = {first[1], second[1], second[2]};
        const auto quality = [&](const Triangle& a, const Triangle& b) {
            return std::min(triangle_quality(mesh, a), triangle_quality(mesh, b));
        };
        if (quality(other_first, other_second) <= quality(first, second)) return;
        first = other_first;
        second = other_second;
    });
}

}  // namespace

Mesh surface_nets(const SignedDistance& distance, const SurfaceNetsOptions& options) {
    PATINA_CHECK_GT(options.cell, 0.0);
    Grid grid = sample_grid(distance, options);
    settle_ambiguous_faces(grid);
    Mesh mesh = connect(grid);
    project_vertices(distance, options.cell, mesh);
    choose_diagonals(mesh);
    return mesh;
}

}  // namespace patina
