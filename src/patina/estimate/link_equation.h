// The screened Laplace equation over the surface, in parallel and with the same bytes for any
// number of threads.
//
// Based on: Hestenes, Stiefel. Methods of Conjugate Gradients for Solving Linear Systems. J. Res.
// NBS 49(6), 1952; preconditioned by coarser equations (link_levels.h).
#pragma once

#include "patina/scene/atlas.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// For every texel x of `unknown`:  diagonal_x u_x - sum_y link_xy u_y = right_x,  the sum over the
// neighbours that are unknown as well.
struct LinkEquation {
    std::vector<TexelId> unknown;  // ascending
    std::vector<double> diagonal;  // one per entry of unknown; > the sum of the texel's links
    std::vector<double> right;     // one per entry of unknown
};

struct LinkSolverOptions {
    double tolerance = 1e-5;  // |residual| over |right|
    int max_steps = 400;
};

// link: one per entry of atlas.neighbors, the same in both directions. values: one per texel; those
// of unknown texels are the start and become the solution, the others are set to 0. Returns the
// steps taken. Eigen's conjugate gradients do the same on one thread, with the matrix held besides
// the links.
int solve_links(const TexelAtlas& atlas,
                std::span<const float> link,
                const LinkEquation& equation,
                const LinkSolverOptions& options,
                std::vector<double>& values);

}  // namespace patina
