// Pd, Ps and sigma of one texel from all of its looks at once, by variable projection: Pd and Ps in
// closed form for every sigma, sigma by a one-dimensional search. Looks side by side in SIMD lanes.
//
// Based on: Golub, Pereyra. The Differentiation of Pseudo-Inverses and Nonlinear Least Squares
// Problems Whose Variables Separate. SIAM J. Numer. Anal. 10(2), 1973.
#pragma once

#include "patina/estimate/texel_fit.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace patina {

// Reuses its memory from texel to texel. Not thread-safe; one per thread.
class JointFit {
  public:
    // Takes the rows with their weights; classes are ignored.
    void load(std::span<const FitRow> rows);

    // start: sigma to search about [rad]; 0: none, the whole range is searched.
    [[nodiscard]] Reflectance solve(const FitOptions& options, double start) const;
    // The nearest best sigma, or `start` itself (> 0) where the least cost lies elsewhere: a fit
    // that follows small changes of the light does not leap to another minimum.
    [[nodiscard]] Reflectance follow(const FitOptions& options, double start) const;
    // Pd for a lobe that is given.
    [[nodiscard]] Rgb diffuse_with(double specular, double roughness) const;
    // Pd and Ps for a sigma that is given.
    [[nodiscard]] Reflectance solve_at(double roughness) const;
    // Mean over channels of weight x residual^2 for every row [-], at the weights that were loaded:
    // 1 is what the stated noise makes of a perfect model if no robust factor lowers them.
    void misfits(const Reflectance& reflectance, std::vector<double>& result) const;
    // Sum over rows and channels of residual^2 [radiance^2].
    [[nodiscard]] double squared_error(const Reflectance& reflectance) const;

  private:
    using Lanes = std::vector<float>;  // padded to whole vectors with rows of weight 0

    // Sums of the normal equations for one sigma, per channel.
    struct Sums {
        Rgb hb = Rgb::Zero(), bb = Rgb::Zero(), bo = Rgb::Zero();
    };
    void basis_at(double roughness) const;  // fills basis_
    void slope_at(double roughness) const;  // fills basis_slope_, after basis_at()
    [[nodiscard]] Sums sums_at(double roughness) const;
    [[nodiscard]] double specular_of(const Sums& sums) const;
    [[nodiscard]] Rgb diffuse_of(const Sums& sums, double specular) const;
    [[nodiscard]] double cost_at(double log_roughness) const;
    // One Gauss-Newton step of log sigma towards the least cost.
    struct Step {
        double length = 0;
        double error = 0;  // standard error of log sigma at weights of 1 / variance
    };
    // Nothing where the best Ps is 0.
    [[nodiscard]] std::optional<Step> step_at(double log_roughness) const;
    // Such steps from `start`; nothing where they do not come to rest. All in [log rad].
    [[nodiscard]] std::optional<double> descend(double start, double low, double high) const;

    std::size_t num_rows_ = 0;
    std::size_t num_lanes_ = 0;
    bool one_lamp_each_ = true;
    bool has_indirect_ = false;
    double indirect_roughness_ = 1;
    // Per lamp term.
    Lanes theta_squared_, spread_along_, spread_across_;
    std::array<Lanes, 3> amplitude_;  // irradiance x lobe_cosines() / pi
    std::vector<std::uint32_t> row_of_term_;
    // Per row.
    std::array<Lanes, 3> weight_, irradiance_, radiance_;  // irradiance over pi
    std::array<Lanes, 3> same_, slope_, bend_;             // of the indirect lobe, over pi
    mutable std::array<Lanes, 3> basis_;                   // of the lobe, per Ps
    mutable std::array<Lanes, 3> basis_slope_;             // its derivative in log sigma
    mutable Lanes gaussian_, gaussian_slope_;
    Rgb hh_ = Rgb::Zero(), ho_ = Rgb::Zero(), oo_ = Rgb::Zero();
};

}  // namespace patina
