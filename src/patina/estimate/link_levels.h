// A preconditioner for the equation of the links: the same equation on coarser and coarser cells of
// the atlas, by their diagonals alone.
//
// Based on: Bramble, Pasciak, Xu. Parallel Multilevel Preconditioners. Math. Comp. 55(191), 1990;
// with cells of 2 x 2, 4 x 4, ... texels in place of nested elements.
#pragma once

#include "patina/estimate/link_equation.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

class LinkLevels {
  public:
    // Keeps a reference to the equation. link: see solve_links().
    LinkLevels(const TexelAtlas& atlas, std::span<const float> link, const LinkEquation& equation);

    // Makes corrections() those of this residual, one entry per row of the equation.
    void load(std::span<const double> residual);
    // Of one row: the sum over the texel itself and the cells that hold it of what is left there
    // over their diagonals.
    [[nodiscard]] double correction(std::size_t row, double residual) const {
        return residual / equation_.diagonal[row] + levels_.front().values[parent_of_row_[row]];
    }

  private:
    // Cells of one size.
    struct Level {
        std::vector<std::uint32_t> begin;     // per cell and one more, into children
        std::vector<std::uint32_t> children;  // cells of the level below; rows of the first level
        std::vector<std::uint32_t> parent;    // per cell, of the level above; empty in the last one
        std::vector<double> diagonal;         // of the equation for functions constant on the cells
        std::vector<double> values;
    };

    const LinkEquation& equation_;
    std::vector<std::uint32_t> parent_of_row_;
    std::vector<Level> levels_;  // fine to coarse, at least one
};

}  // namespace patina
