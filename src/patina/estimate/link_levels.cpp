#include "patina/estimate/link_levels.h"

#include "patina/base/large_vector.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>

namespace patina {
namespace {

// The coarsest cells have 64 texels a side, about as far as values reach (GuidedFill).
constexpr unsigned kNumLevels = 6;

struct Cell {
    std::uint32_t column = 0;
    std::uint32_t row = 0;
};

Cell cell_of(const Texel& texel) { return {std::uint32_t(texel.column), std::uint32_t(texel.row)}; }

// The finest level on which two texels share a cell; 0 for a texel and itself.
unsigned shared_level(const Cell& a, const Cell& b) {
    return unsigned(std::bit_width((a.column ^ b.column) | (a.row ^ b.row)));
}

// Replaces the cells by those that hold them, in order of appearance; returns which one holds each.
std::vector<std::uint32_t> gather_cells(std::vector<Cell>& cells) {
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    Cell largest;
    for (Cell& cell : cells) {
        cell = {cell.column / 2, cell.row / 2};
        largest = {std::max(largest.column, cell.column), std::max(largest.row, cell.row)};
    }
    const std::size_t width = std::size_t(largest.column) + 1;
    std::vector<std::uint32_t> index(width * (std::size_t(largest.row) + 1), kNone);
    std::vector<std::uint32_t> parent;
    std::vector<Cell> parents;
    for (const Cell& cell : cells) {
        std::uint32_t& at = index[cell.row * width + cell.column];
        if (at == kNone) {
            at = std::uint32_t(parents.size());
            parents.push_back(cell);
        }
        parent.push_back(at);
    }
    cells = std::move(parents);
    return parent;
}

}  // namespace

LinkLevels::LinkLevels(const TexelAtlas& atlas,
                       std::span<const float> link,
                       const LinkEquation& equation)
    : equation_(equation) {
    // Links whose two texels share a cell first on each level, per texel.
    std::vector<std::uint8_t> is_unknown(atlas.texels.size(), 0);
    for (const TexelId texel : equation.unknown) is_unknown[texel] = 1;
    LargeVector<std::array<double, kNumLevels + 1>> inner(equation.unknown.size());
    parallel_for(equation.unknown.size(), [&](std::size_t row) {
        const TexelId texel = equation.unknown[row];
        inner[row].fill(0);
        for (std::uint32_t k = atlas.neighbor_begin[texel]; k < atlas.neighbor_begin[texel + 1];
             ++k) {
            const TexelId other = atlas.neighbors[k];
            if (is_unknown[other] == 0) continue;
            const unsigned level =
                shared_level(cell_of(atlas.texels[texel]), cell_of(atlas.texels[other]));
            if (level <= kNumLevels) inner[row][level] += double(link[k]);
        }
    });

    std::vector<Cell> cells;
    for (const TexelId texel : equation.unknown) cells.push_back(cell_of(atlas.texels[texel]));
    std::vector<std::uint32_t> cell_of_row(cells.size());
    std::iota(cell_of_row.begin(), cell_of_row.end(), 0u);
    std::vector<double> diagonal = equation.diagonal;
    for (unsigned l = 1; l <= kNumLevels; ++l) {
        const std::vector<std::uint32_t> parent = gather_cells(cells);
        Level level;
        level.begin.assign(cells.size() + 1, 0);
        for (const std::uint32_t at : parent) ++level.begin[at + 1];
        std::partial_sum(level.begin.begin(), level.begin.end(), level.begin.begin());
        std::vector<std::uint32_t> end(level.begin.begin(), level.begin.end() - 1);
        level.children.resize(parent.size());
        level.diagonal.assign(cells.size(), 0.0);
        for (std::uint32_t child = 0; child < parent.size(); ++child) {
            level.children[end[parent[child]]++] = child;
            level.diagonal[parent[child]] += diagonal[child];
        }
        for (std::size_t row = 0; row < cell_of_row.size(); ++row) {
            cell_of_row[row] = parent[cell_of_row[row]];
            level.diagonal[cell_of_row[row]] -= inner[row][l];
        }
        level.values.resize(cells.size());
        diagonal = level.diagonal;
        (l == 1 ? parent_of_row_ : levels_.back().parent) = parent;
        levels_.push_back(std::move(level));
    }
}

void LinkLevels::load(std::span<const double> residual) {
    std::span<const double> below = residual;
    for (Level& level : levels_) {
        parallel_for(
            level.values.size(),
            [&](std::size_t cell) {
                double sum = 0;
                for (std::uint32_t k = level.begin[cell]; k < level.begin[cell + 1]; ++k) {
                    sum += below[level.children[k]];
                }
                level.values[cell] = sum;
            },
            kParallelBlock);
        below = level.values;
    }
    for (std::size_t l = levels_.size(); l-- > 0;) {
        Level& level = levels_[l];
        parallel_for(
            level.values.size(),
            [&](std::size_t cell) {
                level.values[cell] /= level.diagonal[cell];
                if (level.parent.empty()) return;
                level.values[cell] += levels_[l + 1].values[level.parent[cell]];
            },
            kParallelBlock);
    }
}

}  // namespace patina
