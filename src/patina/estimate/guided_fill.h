// Filling what was not measured over the surface: guided by colour and by the surface's bends.
//
// Based on: Levin, Lischinski, Weiss. Colorization Using Optimization. SIGGRAPH 2004 (values spread
// where the guide is smooth); Bhat et al. Fourier Analysis of the 2D Screened Poisson Equation.
// ECCV 2008 (the screening term).
#pragma once

#include "patina/estimate/link_equation.h"
#include "patina/math/types.h"
#include "patina/scene/atlas.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// What the neighbours of a texel say of it: weights of the links of the surface, made once for one
// guide.
class GuidedFill {
  public:
    // diffuse: Pd of every texel, the guide.
    GuidedFill(const TexelAtlas& atlas, std::span<const Rgb> diffuse);

    // values: one per texel; where not known, what the solver starts from. confidence: 0 where the
    // value is not known; elsewhere in (0, 1], how
    // much it counts beside others. Known values stay. The others become the solution of
    //
    //     min sum_links g_xy (r_x - r_y)^2 + e sum_x r_x^2,   r = value - trend(Pd of x),
    //
    // where the trend is what texels of a like colour have (none, if colour explains nothing of the
    // known values), and g falls with the difference of Pd and of the normals. fallback: where
    // nothing at all is known. tolerance: of solve_links().
    void fill(std::span<const float> confidence,
              double fallback,
              std::span<double> values,
              double tolerance = LinkSolverOptions().tolerance) const;

    // What known values are above the trend; 0 where nothing is known.
    [[nodiscard]] std::vector<double> above_trend(std::span<const float> confidence,
                                                  std::span<const double> values) const;

    // g, one per entry of atlas.neighbors, in (0, 1].
    [[nodiscard]] std::span<const float> links() const { return link_; }

  private:
    void find_cells();
    [[nodiscard]] std::vector<double> trend(std::span<const float> confidence,
                                            std::span<const double> values) const;

    const TexelAtlas& atlas_;
    std::vector<Vec3> color_;  // log of the mean of Pd, and two chromaticities, in scaled units
    std::vector<std::uint32_t> cell_;  // of the texel's colour among cell_middle_
    std::vector<Vec3> cell_middle_;
    std::vector<float> link_;  // see links()
};

}  // namespace patina
