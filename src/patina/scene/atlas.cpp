#include "patina/scene/atlas.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/scene/atlas_cells.h"
#include "patina/scene/range_image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <tuple>

namespace patina {
namespace {

// Texels that share a border on the surface are closer than this many times their mean size;
// further ones are separated by a crack (a step in a range image) although their cells touch.
constexpr double kMaxNeighborDistance = 6.0;
// How far an uncentred cell looks for a texel of its chart [cells].
constexpr int kOwnerSearchRadius = 8;

// --- Vertices that coincide -------------------------------------------------------------------

// Of every vertex, the first one with the same bits in its coordinates.
template <std::size_t Size, typename Coordinates>
std::vector<std::uint32_t> weld(std::size_t num_vertices, const Coordinates& coordinates) {
    using Bits = std::array<std::uint32_t, Size>;
    const auto bits_of = [&](std::size_t vertex) {
        const std::array<float, Size> values = coordinates(vertex);
        Bits bits;
        // Minus zero is zero.
        for (std::size_t i = 0; i < Size; ++i) {
            bits[i] = std::bit_cast<std::uint32_t>(values[i] + 0.0f);
        }
        return bits;
    };
    // Open addressing: a slot holds a vertex, or the next one is looked at.
    constexpr auto kFree = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> slots(std::bit_ceil(2 * num_vertices + 1), kFree);
    std::vector<std::uint32_t> first(num_vertices);
    for (std::size_t i = 0; i < num_vertices; ++i) {
        const Bits bits = bits_of(i);
        std::size_t hash = 0;
        for (const std::uint32_t word : bits) hash = (hash ^ word) * 0x9E3779B97F4A7C15ull;
        std::size_t slot = (hash ^ (hash >> 29)) & (slots.size() - 1);
        while (slots[slot] != kFree && bits_of(slots[slot]) != bits) {
            slot = (slot + 1) & (slots.size() - 1);
        }
        if (slots[slot] == kFree) slots[slot] = std::uint32_t(i);
        first[i] = slots[slot];
    }
    return first;
}

std::vector<std::uint32_t> weld_by_position(const Mesh& mesh) {
    return weld<3>(mesh.positions.size(), [&mesh](std::size_t i) {
        const Vec3f& p = mesh.positions[i];
        return std::array<float, 3>{p.x(), p.y(), p.z()};
    });
}

std::vector<std::uint32_t> weld_by_position_and_uv(const Mesh& mesh) {
    return weld<5>(mesh.positions.size(), [&mesh](std::size_t i) {
        const Vec3f& p = mesh.positions[i];
        const Vec2f& uv = mesh.uvs[i];
        return std::array<float, 5>{p.x(), p.y(), p.z(), uv.x(), uv.y()};
    });
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

bool close_in_space(const Texel& a, const Texel& b) {
    const double size = 0.5 * (std::sqrt(a.area) + std::sqrt(b.area));
    return (a.point.position - b.point.position).norm() <= kMaxNeighborDistance * size;
}

// The texel of the same chart in a cell beside this one's, if both lie close on the surface.
TexelId grid_neighbor(const TexelAtlas& atlas, const Texel& texel, int dx, int dy) {
    const int x = texel.column + dx;
    const int y = texel.row + dy;
    if (x < 0 || y < 0 || x >= atlas.width || y >= atlas.height) return kNoTexel;
    const TexelId other =
        atlas.cell_texel[std::size_t(y) * std::size_t(atlas.width) + std::size_t(x)];
    if (other == kNoTexel || atlas.texels[other].chart != texel.chart) return kNoTexel;
    return close_in_space(texel, atlas.texels[other]) ? other : kNoTexel;
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

// An edge that two triangles share in space but not in the texel domain: between charts.
struct Seam {
    EdgeUse here;
    EdgeUse there;
    bool reversed;  // whether there it runs the other way
};

// All uses of edges by the welded numbers of their ends, those of one edge side by side in the
// order of the triangles.
class EdgeUses {
  public:
    EdgeUses(const Mesh& mesh, const std::vector<std::uint32_t>& welded)
        : mesh_(mesh), welded_(welded), begin_(mesh.positions.size() + 1, 0) {
        PATINA_CHECK(mesh.triangles.size() <= std::numeric_limits<std::uint32_t>::max() / 3);
        const auto for_each_use = [&](const auto& work) {
            for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
                for (int corner = 0; corner < 3; ++corner) work(EdgeUse{i, corner});
            }
        };
        for_each_use([&](const EdgeUse& use) { ++begin_[welded_ends(use).first + 1]; });
        std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
        uses_.resize(3 * mesh.triangles.size());
        std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
        for_each_use([&](const EdgeUse& use) { uses_[next[welded_ends(use).first]++] = use; });
        parallel_for(mesh.positions.size(), [&](std::size_t low) {
            std::sort(uses_.begin() + begin_[low],
                      uses_.begin() + begin_[low + 1],
                      [&](const EdgeUse& a, const EdgeUse& b) {
                          return std::tuple(welded_ends(a).second, a.triangle, a.corner) <
                                 std::tuple(welded_ends(b).second, b.triangle, b.corner);
                      });
        });
    }

    [[nodiscard]] std::span<const EdgeUse> all() const { return uses_; }
    [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> ends(const EdgeUse& use) const {
        const Triangle& triangle = mesh_.triangles[use.triangle];
        return {triangle[std::size_t(use.corner)], triangle[std::size_t((use.corner + 1) % 3)]};
    }
    // The lower first.
    [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> welded_ends(const EdgeUse& use) const {
        const auto [a, b] = ends(use);
        return std::minmax({welded_[a], welded_[b]});
    }

  private:
    const Mesh& mesh_;
    const std::vector<std::uint32_t>& welded_;
    std::vector<std::uint32_t> begin_;  // by the lower end
    LargeVector<EdgeUse> uses_;
};

// Where more than two triangles share an edge, each with the first of them.
std::vector<Seam> find_seams(const Mesh& mesh) {
    const std::vector<std::uint32_t> welded = weld_by_position(mesh);
    const EdgeUses uses(mesh, welded);
    std::vector<Seam> seams;
    EdgeUse first{};
    for (const EdgeUse& use : uses.all()) {
        if (&use == uses.all().data() || uses.welded_ends(use) != uses.welded_ends(first)) {
            first = use;
            continue;
        }
        const auto [a, b] = uses.ends(use);
        const auto [first_a, first_b] = uses.ends(first);
        const bool reversed = welded[first_a] != welded[a];
        if (mesh.uvs[reversed ? first_b : first_a] != mesh.uvs[a] ||
            mesh.uvs[reversed ? first_a : first_b] != mesh.uvs[b]) {
            seams.push_back({use, first, reversed});
        }
    }
    return seams;
}

// Both ways, in ascending order.
TexelPairs seam_neighbors(const Mesh& mesh,
                          const TexelAtlas& atlas,
                          const std::vector<Seam>& seams) {
    TexelPairs pairs;
    for (const auto& [here, there, reversed] : seams) {
        const CellTriangle at_here = cell_triangle(mesh, here.triangle, atlas.width, atlas.height);
        const CellTriangle at_there =
            cell_triangle(mesh, there.triangle, atlas.width, atlas.height);
        const Vec2 here_a = at_here[std::size_t(here.corner)];
        const Vec2 here_b = at_here[std::size_t((here.corner + 1) % 3)];
        const int next_there = (there.corner + 1) % 3;
        const Vec2 there_a = at_there[std::size_t(reversed ? next_there : there.corner)];
        const Vec2 there_b = at_there[std::size_t(reversed ? there.corner : next_there)];
        const double length = std::max((here_b - here_a).norm(), (there_b - there_a).norm());
        const int num_steps = std::max(1, int(std::ceil(2 * length)));
        for (int step = 0; step < num_steps; ++step) {
            const double s = (step + 0.5) / num_steps;
            const TexelId a = texel_beside_edge(atlas, at_here, here_a + s * (here_b - here_a));
            const TexelId b = texel_beside_edge(atlas, at_there, there_a + s * (there_b - there_a));
            if (a == kNoTexel || b == kNoTexel || a == b) continue;
            pairs.emplace_back(a, b);
            pairs.emplace_back(b, a);
        }
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

// On the grid and over seams, in ascending order.
void store_neighbors(TexelAtlas& atlas, const TexelPairs& over_seams) {
    const auto find = [&](TexelId id, std::vector<TexelId>& found) {
        found.clear();
        for (const auto& [dx, dy] : {std::pair{0, -1}, {-1, 0}, {1, 0}, {0, 1}}) {
            const TexelId other = grid_neighbor(atlas, atlas.texels[id], dx, dy);
            if (other != kNoTexel) found.push_back(other);
        }
        auto pair =
            std::lower_bound(over_seams.begin(), over_seams.end(), std::pair(id, TexelId(0)));
        for (; pair != over_seams.end() && pair->first == id; ++pair) {
            found.push_back(pair->second);
        }
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
    };
    const std::size_t num_texels = atlas.texels.size();
    atlas.neighbor_begin.assign(num_texels + 1, 0);
    parallel_blocks(num_texels, kParallelBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<TexelId> found;
        for (std::size_t i = begin; i < end; ++i) {
            find(TexelId(i), found);
            atlas.neighbor_begin[i + 1] = std::uint32_t(found.size());
        }
    });
    std::partial_sum(
        atlas.neighbor_begin.begin(), atlas.neighbor_begin.end(), atlas.neighbor_begin.begin());
    atlas.neighbors.resize(atlas.neighbor_begin.back());
    parallel_blocks(num_texels, kParallelBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<TexelId> found;
        for (std::size_t i = begin; i < end; ++i) {
            find(TexelId(i), found);
            std::copy(
                found.begin(), found.end(), atlas.neighbors.begin() + atlas.neighbor_begin[i]);
        }
    });
}

void collect_texels(const Mesh& mesh,
                    std::span<const Cell> cells,
                    const std::vector<std::uint32_t>& charts,
                    TexelAtlas& atlas) {
    TexelId num_texels = 0;
    for (std::size_t index = 0; index < cells.size(); ++index) {
        if (!cells[index].has_center) continue;
        atlas.cell_owner[index] = atlas.cell_texel[index] = num_texels++;
    }
    atlas.texels.resize(num_texels);
    parallel_for(cells.size(), [&](std::size_t index) {
        const Cell& cell = cells[index];
        if (!cell.has_center) return;
        Texel& texel = atlas.texels[atlas.cell_texel[index]];
        texel.column = int(index % std::size_t(atlas.width));
        texel.row = int(index / std::size_t(atlas.width));
        texel.point = surface_point(mesh, cell.center_triangle, cell.center_barycentric);
        texel.area = cell.area;
        texel.chart = charts[cell.center_triangle];
    });
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

    LargeVector<Cell> cells;
    std::vector<std::uint32_t> charts;
    std::vector<Seam> seams;
    const std::array<std::function<void()>, 3> tasks = {
        [&] { cells = rasterize_cells(mesh, width, height); },
        [&] { charts = find_charts(mesh); },
        [&] { seams = find_seams(mesh); },
    };
    parallel_for(
        tasks.size(), [&](std::size_t task) { tasks[task](); }, 1);
    collect_texels(mesh, cells, charts, atlas);
    store_neighbors(atlas, seam_neighbors(mesh, atlas, seams));
    return atlas;
}

void set_scanner_columns(TexelAtlas& atlas, const RangeFrame& frame) {
    atlas.wraps_around = frame.wraps_around();
    for (Texel& texel : atlas.texels) {
        texel.azimuth = column_azimuth(frame, atlas.width, texel.column);
    }
}

}  // namespace patina
