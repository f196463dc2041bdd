#include "patina/scene/atlas.h"

#include "patina/scene/range_image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <numeric>
#include <unordered_map>

namespace patina {
namespace {

// Texels that share a border on the surface are closer than this many times their mean size;
// further ones are separated by a crack (a step in a range image) although their cells touch.
constexpr double kMaxNeighborDistance = 6.0;
// How far an uncentred cell looks for a texel of its chart [cells].
constexpr int kOwnerSearchRadius = 8;

// --- Vertices that coincide -------------------------------------------------------------------

// Numbers vertices by the bits of their coordinates: equal keys get equal numbers.
template <std::size_t Size>
class VertexWelder {
  public:
    explicit VertexWelder(std::size_t num_vertices) { numbers_.reserve(num_vertices); }

    std::uint32_t number(const std::array<float, Size>& key) {
        std::array<std::uint32_t, Size> bits;
        for (std::size_t i = 0; i < Size; ++i)
            bits[i] = std::bit_cast<std::uint32_t>(key[i] + 0.0f);
        return numbers_.try_emplace(bits, static_cast<std::uint32_t>(numbers_.size()))
            .first->second;
    }

  private:
    struct Hash {
        std::size_t operator()(const std::array<std::uint32_t, Size>& bits) const {
            std::size_t hash = 0;
            for (const std::uint32_t word : bits) hash = (hash ^ word) * 0x9E3779B97F4A7C15ull;
            return hash ^ (hash >> 29);
        }
    };
    std::unordered_map<std::array<std::uint32_t, Size>, std::uint32_t, Hash> numbers_;
};

std::vector<std::uint32_t> weld_by_position(const Mesh& mesh) {
    VertexWelder<3> welder(mesh.positions.size());
    std::vector<std::uint32_t> ids(mesh.positions.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const Vec3f& p = mesh.positions[i];
        ids[i] = welder.number({p.x(), p.y(), p.z()});
    }
    return ids;
}

std::vector<std::uint32_t> weld_by_position_and_uv(const Mesh& mesh) {
    VertexWelder<5> welder(mesh.positions.size());
    std::vector<std::uint32_t> ids(mesh.positions.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const Vec3f& p = mesh.positions[i];
        const Vec2f& uv = mesh.uvs[i];
        ids[i] = welder.number({p.x(), p.y(), p.z(), uv.x(), uv.y()});
    }
    return ids;
}

// --- Charts -----------------------------------------------------------------------------------

// Triangles joined through shared (position, uv) vertices; charts are numbered by first triangle.
std::vector<std::uint32_t> find_charts(const Mesh& mesh) {
    const std::vector<std::uint32_t> welded = weld_by_position_and_uv(mesh);
    std::vector<std::uint32_t> parent(mesh.positions.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&parent](std::uint32_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::size_t corner : {1u, 2u}) {
            const std::uint32_t a = root(welded[triangle[0]]);
            const std::uint32_t b = root(welded[triangle[corner]]);
            parent[std::max(a, b)] = std::min(a, b);
        }
    }
    std::map<std::uint32_t, std::uint32_t> chart_of_root;
    std::vector<std::uint32_t> charts(mesh.triangles.size());
    for (std::size_t i = 0; i < charts.size(); ++i) {
        const std::uint32_t r = root(welded[mesh.triangles[i][0]]);
        charts[i] = chart_of_root.try_emplace(r, static_cast<std::uint32_t>(chart_of_root.size()))
                        .first->second;
    }
    return charts;
}

// --- Cells ------------------------------------------------------------------------------------

// A triangle in cell coordinates: x = u W to the right, y = (1 - v) H down.
using CellTriangle = std::array<Vec2, 3>;

CellTriangle cell_triangle(const Mesh& mesh, std::uint32_t triangle, int width, int height) {
    CellTriangle corners;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2f& uv = mesh.uvs[mesh.triangles[triangle][i]];
        corners[i] = {double(uv.x()) * width, (1.0 - double(uv.y())) * height};
    }
    return corners;
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double doubled_signed_area(const CellTriangle& t) { return cross(t[1] - t[0], t[2] - t[0]); }

// A convex polygon of at most 3 + 4 corners: a triangle cut by the sides of a square.
struct SmallPolygon {
    std::array<Vec2, 8> corners;
    int size = 0;
};

// Keeps the part where sign * (coordinate - limit) <= 0 (Sutherland and Hodgman, 1974).
SmallPolygon clip(const SmallPolygon& polygon, int axis, double limit, double sign) {
    SmallPolygon result;
    for (int i = 0; i < polygon.size; ++i) {
        const Vec2& a = polygon.corners[std::size_t(i)];
        const Vec2& b = polygon.corners[std::size_t((i + 1) % polygon.size)];
        const double da = sign * (a[axis] - limit);
        const double db = sign * (b[axis] - limit);
        if (da <= 0) result.corners[std::size_t(result.size++)] = a;
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
            result.corners[std::size_t(result.size++)] = a + (b - a) * (da / (da - db));
        }
    }
    return result;
}

// Area of the part of a triangle inside the unit cell whose low corner is (column, row).
double overlap_area(const CellTriangle& t, int column, int row) {
    SmallPolygon polygon;
    polygon.size = 3;
    std::copy(t.begin(), t.end(), polygon.corners.begin());
    polygon = clip(polygon, 0, column, -1);
    polygon = clip(polygon, 0, column + 1, 1);
    polygon = clip(polygon, 1, row, -1);
    polygon = clip(polygon, 1, row + 1, 1);
    double doubled = 0;
    for (int i = 2; i < polygon.size; ++i) {
        doubled += cross(polygon.corners[std::size_t(i - 1)] - polygon.corners[0],
                         polygon.corners[std::size_t(i)] - polygon.corners[0]);
    }
    return 0.5 * std::abs(doubled);
}

// What one cell of the texel domain holds.
struct Cell {
    double area = 0;             // of all surface in it [length^2]
    double largest_overlap = 0;  // of one triangle [cells]
    std::uint32_t largest_triangle = 0;
    bool has_center = false;
    std::uint32_t center_triangle = 0;
    Vec2f center_barycentric = Vec2f::Zero();
};

void rasterize_triangle(
    const Mesh& mesh, std::uint32_t triangle, int width, int height, std::vector<Cell>& cells) {
    const CellTriangle t = cell_triangle(mesh, triangle, width, height);
    const double doubled = doubled_signed_area(t);
    if (doubled == 0) return;
    const double surface_per_cell = 2 * triangle_area(mesh, triangle) / std::abs(doubled);
    const auto [low_x, high_x] = std::minmax({t[0].x(), t[1].x(), t[2].x()});
    const auto [low_y, high_y] = std::minmax({t[0].y(), t[1].y(), t[2].y()});
    const int first_column = std::clamp(int(std::floor(low_x)), 0, width - 1);
    const int last_column = std::clamp(int(std::ceil(high_x)) - 1, first_column, width - 1);
    const int first_row = std::clamp(int(std::floor(low_y)), 0, height - 1);
    const int last_row = std::clamp(int(std::ceil(high_y)) - 1, first_row, height - 1);
    for (int row = first_row; row <= last_row; ++row) {
        for (int column = first_column; column <= last_column; ++column) {
            Cell& cell = cells[std::size_t(row) * std::size_t(width) + std::size_t(column)];
            const double overlap = overlap_area(t, column, row);
            cell.area += overlap * surface_per_cell;
            if (overlap > cell.largest_overlap) {
                cell.largest_overlap = overlap;
                cell.largest_triangle = triangle;
            }
            const Vec2 center(column + 0.5, row + 0.5);
            const double u = cross(center - t[0], t[2] - t[0]) / doubled;
            const double v = cross(t[1] - t[0], center - t[0]) / doubled;
            if (!cell.has_center && u >= 0 && v >= 0 && u + v <= 1) {
                cell.has_center = true;
                cell.center_triangle = triangle;
                cell.center_barycentric = Vec2(u, v).cast<float>();
            }
        }
    }
}

// --- Owners and neighbours --------------------------------------------------------------------

// The texel nearest to a cell, of the wanted chart if there is one in reach.
TexelId nearest_texel(const TexelAtlas& atlas, int column, int row, std::uint32_t chart) {
    TexelId best = kNoTexel;
    double best_distance = 0;
    bool best_same_chart = false;
    for (int dy = -kOwnerSearchRadius; dy <= kOwnerSearchRadius; ++dy) {
        for (int dx = -kOwnerSearchRadius; dx <= kOwnerSearchRadius; ++dx) {
            const int x = column + dx;
            const int y = row + dy;
            if (x < 0 || y < 0 || x >= atlas.width || y >= atlas.height) continue;
            const TexelId id =
                atlas.cell_texel[std::size_t(y) * std::size_t(atlas.width) + std::size_t(x)];
            if (id == kNoTexel) continue;
            const bool same_chart = atlas.texels[id].chart == chart;
            const double distance = dx * dx + dy * dy;
            if (best == kNoTexel || (same_chart && !best_same_chart) ||
                (same_chart == best_same_chart && distance < best_distance)) {
                best = id;
                best_distance = distance;
                best_same_chart = same_chart;
            }
        }
    }
    return best;
}

using TexelPairs = std::vector<std::pair<TexelId, TexelId>>;

void add_pair(TexelPairs& pairs, TexelId a, TexelId b) {
    if (a == kNoTexel || b == kNoTexel || a == b) return;
    pairs.emplace_back(a, b);
    pairs.emplace_back(b, a);
}

bool close_in_space(const Texel& a, const Texel& b) {
    const double size = 0.5 * (std::sqrt(a.area) + std::sqrt(b.area));
    return (a.point.position - b.point.position).norm() <= kMaxNeighborDistance * size;
}

// Neighbouring cells of one chart.
void add_grid_neighbors(const TexelAtlas& atlas, TexelPairs& pairs) {
    const auto texel_at = [&atlas](int x, int y) {
        return atlas.cell_texel[std::size_t(y) * std::size_t(atlas.width) + std::size_t(x)];
    };
    for (TexelId id = 0; id < atlas.texels.size(); ++id) {
        const Texel& texel = atlas.texels[id];
        for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
            const int x = texel.column + dx;
            const int y = texel.row + dy;
            if (x >= atlas.width || y >= atlas.height) continue;
            const TexelId other = texel_at(x, y);
            if (other == kNoTexel || atlas.texels[other].chart != texel.chart) continue;
            if (close_in_space(texel, atlas.texels[other])) add_pair(pairs, id, other);
        }
    }
}

// The texel on this triangle's side of a point of one of its edges.
TexelId texel_beside_edge(const TexelAtlas& atlas, const CellTriangle& t, const Vec2& on_edge) {
    constexpr double kStepInside = 0.25;  // [cells]
    const Vec2 inward = (t[0] + t[1] + t[2]) / 3 - on_edge;
    const double length = inward.norm();
    const Vec2 p =
        length > 0 ? Vec2(on_edge + inward * std::min(1.0, kStepInside / length)) : on_edge;
    const int x = std::clamp(int(std::floor(p.x())), 0, atlas.width - 1);
    const int y = std::clamp(int(std::floor(p.y())), 0, atlas.height - 1);
    return atlas.cell_owner[std::size_t(y) * std::size_t(atlas.width) + std::size_t(x)];
}

struct EdgeUse {
    std::uint32_t triangle;
    int corner;  // the edge runs from this corner to the next
};

// Edges that two triangles share in space but not in the texel domain: seams between charts.
void add_seam_neighbors(const Mesh& mesh, const TexelAtlas& atlas, TexelPairs& pairs) {
    const std::vector<std::uint32_t> welded = weld_by_position(mesh);
    std::map<std::pair<std::uint32_t, std::uint32_t>, EdgeUse> open_edges;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        for (int corner = 0; corner < 3; ++corner) {
            const std::uint32_t a = mesh.triangles[i][std::size_t(corner)];
            const std::uint32_t b = mesh.triangles[i][std::size_t((corner + 1) % 3)];
            const std::pair key = std::minmax(welded[a], welded[b]);
            const auto [found, is_new] = open_edges.try_emplace(key, EdgeUse{i, corner});
            if (is_new) continue;
            const EdgeUse other = found->second;
            const std::uint32_t oa = mesh.triangles[other.triangle][std::size_t(other.corner)];
            const std::uint32_t ob =
                mesh.triangles[other.triangle][std::size_t((other.corner + 1) % 3)];
            const bool reversed = welded[oa] != welded[a];
            const std::uint32_t oa_matching = reversed ? ob : oa;
            const std::uint32_t ob_matching = reversed ? oa : ob;
            if (mesh.uvs[oa_matching] == mesh.uvs[a] && mesh.uvs[ob_matching] == mesh.uvs[b])
                continue;
            const CellTriangle here = cell_triangle(mesh, i, atlas.width, atlas.height);
            const CellTriangle there =
                cell_triangle(mesh, other.triangle, atlas.width, atlas.height);
            const Vec2 here_a = here[std::size_t(corner)];
            const Vec2 here_b = here[std::size_t((corner + 1) % 3)];
            const Vec2 there_a =
                there[std::size_t(reversed ? (other.corner + 1) % 3 : other.corner)];
            const Vec2 there_b =
                there[std::size_t(reversed ? other.corner : (other.corner + 1) % 3)];
            const double length = std::max((here_b - here_a).norm(), (there_b - there_a).norm());
            const int num_steps = std::max(1, int(std::ceil(2 * length)));
            for (int step = 0; step < num_steps; ++step) {
                const double s = (step + 0.5) / num_steps;
                add_pair(pairs,
                         texel_beside_edge(atlas, here, here_a + s * (here_b - here_a)),
                         texel_beside_edge(atlas, there, there_a + s * (there_b - there_a)));
            }
        }
    }
}

void store_neighbors(TexelAtlas& atlas, TexelPairs pairs) {
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    atlas.neighbor_begin.assign(atlas.texels.size() + 1, 0);
    for (const auto& [from, to] : pairs) ++atlas.neighbor_begin[from + 1];
    std::partial_sum(
        atlas.neighbor_begin.begin(), atlas.neighbor_begin.end(), atlas.neighbor_begin.begin());
    atlas.neighbors.resize(pairs.size());
    std::transform(pairs.begin(), pairs.end(), atlas.neighbors.begin(), [](const auto& pair) {
        return pair.second;
    });
}

void collect_texels(const Mesh& mesh,
                    const std::vector<Cell>& cells,
                    const std::vector<std::uint32_t>& charts,
                    TexelAtlas& atlas) {
    for (std::size_t index = 0; index < cells.size(); ++index) {
        const Cell& cell = cells[index];
        if (!cell.has_center) continue;
        atlas.cell_owner[index] = atlas.cell_texel[index] = TexelId(atlas.texels.size());
        Texel texel;
        texel.column = int(index % std::size_t(atlas.width));
        texel.row = int(index / std::size_t(atlas.width));
        texel.point = surface_point(mesh, cell.center_triangle, cell.center_barycentric);
        texel.area = cell.area;
        texel.chart = charts[cell.center_triangle];
        atlas.texels.push_back(texel);
    }
    for (std::size_t index = 0; index < cells.size(); ++index) {
        const Cell& cell = cells[index];
        if (cell.has_center || cell.area <= 0) continue;
        const TexelId owner = nearest_texel(atlas,
                                            int(index % std::size_t(atlas.width)),
                                            int(index / std::size_t(atlas.width)),
                                            charts[cell.largest_triangle]);
        if (owner == kNoTexel) continue;
        atlas.cell_owner[index] = owner;
        atlas.texels[owner].area += cell.area;
    }
}

}  // namespace

TexelId TexelAtlas::lookup(const Mesh& mesh,
                           std::uint32_t triangle,
                           const Vec2f& barycentric) const {
    const Vec2 uv = surface_uv(mesh, triangle, barycentric);
    const int x = std::clamp(int(std::floor(uv.x() * width)), 0, width - 1);
    const int y = std::clamp(int(std::floor((1.0 - uv.y()) * height)), 0, height - 1);
    return cell_owner[std::size_t(y) * std::size_t(width) + std::size_t(x)];
}

TexelAtlas build_atlas(const Mesh& mesh, int width, int height) {
    TexelAtlas atlas;
    atlas.width = width;
    atlas.height = height;
    const std::size_t num_cells = std::size_t(width) * std::size_t(height);
    atlas.cell_owner.assign(num_cells, kNoTexel);
    atlas.cell_texel.assign(num_cells, kNoTexel);

    std::vector<Cell> cells(num_cells);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        rasterize_triangle(mesh, i, width, height, cells);
    }
    collect_texels(mesh, cells, find_charts(mesh), atlas);

    TexelPairs pairs;
    add_grid_neighbors(atlas, pairs);
    add_seam_neighbors(mesh, atlas, pairs);
    store_neighbors(atlas, std::move(pairs));
    return atlas;
}

void set_scanner_columns(TexelAtlas& atlas, const RangeFrame& frame) {
    atlas.wraps_around = frame.wraps_around();
    for (Texel& texel : atlas.texels) {
        texel.azimuth = column_azimuth(frame, atlas.width, texel.column);
    }
}

}  // namespace patina
