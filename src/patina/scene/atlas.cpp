#include "patina/scene/atlas.h"

#include "patina/scene/atlas_cells.h"
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
    std::unordered_map<std::uint64_t, EdgeUse> open_edges;  // by both its ends
    open_edges.reserve(2 * mesh.triangles.size());
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        for (int corner = 0; corner < 3; ++corner) {
            const std::uint32_t a = mesh.triangles[i][std::size_t(corner)];
            const std::uint32_t b = mesh.triangles[i][std::size_t((corner + 1) % 3)];
            const auto [low, high] = std::minmax(welded[a], welded[b]);
            const std::uint64_t key = std::uint64_t(low) << 32 | high;
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

    collect_texels(mesh, rasterize_cells(mesh, width, height), find_charts(mesh), atlas);

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
