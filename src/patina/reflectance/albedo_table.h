// The directional albedo of the lobe, tabulated in (elevation of the light, sigma).
//
// The lobe is circular about the mirror direction and reaches the eye through min(1, cos_o / c0),
// so
//
//     A(cos_i, sigma) = 2 sigma^2 / max(cos_i, c0) g(cos_i, sigma),
//     g = (1 / sigma^2) int_0^pi exp(-theta^2 / (2 sigma^2)) sin(theta) R(theta) dtheta,
//
// with R(theta) the mean of min(1, max(cos_o, 0) / c0) over the circle at the angle theta from the
// mirror direction, known in closed form. g lies in [0, 1] and is smooth: that is what the table
// holds.
#pragma once

#include <vector>

namespace patina {

// g by quadrature, to about 1e-9 [-]. elevation: of the light above the horizon, in [0, pi/2]
// [rad].
[[nodiscard]] double relative_albedo_by_quadrature(double elevation, double roughness);

class AlbedoTable {
  public:
    AlbedoTable();

    // g(cos_i, sigma) [-]; cubic interpolation. roughness is clamped to the table's range.
    [[nodiscard]] double relative(double cos_i, double roughness) const;
    // Largest over cos_i of g c0 / max(cos_i, c0) [-].
    [[nodiscard]] double relative_maximum(double roughness) const;

  private:
    std::vector<double> values_;   // rows: sigma, columns: elevation
    std::vector<double> maximum_;  // one per sigma
};

// The only table: built at the first call (about 50 ms), immutable from then on.
[[nodiscard]] const AlbedoTable& albedo_table();

}  // namespace patina
