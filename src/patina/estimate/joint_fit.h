// Pd, Ps and sigma of one texel from all of its looks at once, by variable projection: Pd and Ps in
// closed form for every sigma, sigma by a one-dimensional search. Looks side by side in SIMD lanes.
//
// Based on: Golub, Pereyra. The Differentiation of Pseudo-Inverses and Nonlinear Least Squares
// Problems Whose Variables Separate. SIAM J. Numer. Anal. 10(2), 1973.
#pragma once

#include "patina/estimate/texel_fit.h"
#include "patina/math/lanes.h"

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
    using RgbLanes = std::array<Lanes, 3>;

    // Eight rows; those beyond the last have no weight and no light.
    struct Rows {
        RgbLanes weight{};
        RgbLanes irradiance{};  // over pi
        RgbLanes radiance{};
        RgbLanes same{}, slope{}, bend{};  // of the indirect lobe, over pi
    };
    // Eight lamp terms, those of one row after those of another.
    struct Terms {
        Lanes theta_squared{}, spread_along{}, spread_across{};
        RgbLanes amplitude{};  // irradiance x lobe_cosines() / pi
    };
    // Sums of the normal equations for one sigma, per channel.
    struct Sums {
        Rgb hb = Rgb::Zero(), bb = Rgb::Zero(), bo = Rgb::Zero();
    };
    void load_row(const FitRow& row, std::size_t number);
    void load_term(const LampTerm& lamp, std::size_t row);
    // From one number per lamp term (lane by lane as in terms_) to one per row.
    void collect(const std::vector<Lanes>& of_term, std::vector<RgbLanes>& of_row) const;
    template <typename Use>
    void for_each_residual(const Reflectance& reflectance, const Use& use) const;
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
    bool one_lamp_each_ = true;  // terms lie as rows do
    bool has_indirect_ = false;
    double indirect_roughness_ = 1;
    std::vector<Rows> rows_;
    std::vector<Terms> terms_;
    std::vector<std::uint32_t> row_of_term_;
    mutable std::vector<RgbLanes> basis_;        // of the lobe, per Ps
    mutable std::vector<RgbLanes> basis_slope_;  // its derivative in log sigma
    mutable std::vector<Lanes> gaussian_, gaussian_slope_;
    Rgb hh_ = Rgb::Zero(), ho_ = Rgb::Zero(), oo_ = Rgb::Zero();
    Rgb inverse_hh_ = Rgb::Zero();  // 0 where hh_ is
};

}  // namespace patina
