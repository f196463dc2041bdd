// How errors of one texel's looks reach its Pd, Ps and sigma: the weighted least squares fit,
// linearised about its solution. docs/uncertainty.md has the formulas.
#pragma once

#include "patina/estimate/texel_fit.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace patina {

// Pd (R, G, B), Ps, sigma.
inline constexpr int kNumParameters = 5;
using Parameters = Eigen::Matrix<double, kNumParameters, 1>;

// What a texel's own looks told; the rest of the lobe was given when Pd was fitted.
enum class KnownLobe { all, specular, none };

// Moments of the standardised residuals z = residual sqrt(weight) of the looks. Channels of one
// look share the errors of its lamp and of the geometry, so their products are kept apart.
struct ResidualMoments {
    double own = 0;      // sum of z_c^2
    double shared = 0;   // sum of z_c z_c' over different channels
    double freedom = 0;  // degrees of freedom left in a channel, over the three of them

    ResidualMoments& operator+=(const ResidualMoments& other);
    // Variance of z that the channels do not share, and that they do [-].
    [[nodiscard]] double own_variance() const;
    [[nodiscard]] double shared_variance() const;
};

// What the looks' residuals did to each parameter, g the change of the parameter per standardised
// residual: the sum over looks of (g z)^2, channels of one look added first (the meat of a sandwich
// covariance, clustered by look), and what it is in the mean when every z has variance 1.
struct InfluenceMoments {
    Parameters found = Parameters::Zero();
    Parameters by_own = Parameters::Zero();     // z independent in all looks and channels
    Parameters by_shared = Parameters::Zero();  // z alike in the channels of a look
};

class ErrorPropagation {
  public:
    // rows: with the weights of the fit.
    ErrorPropagation(std::span<const FitRow> rows, const Reflectance& fitted, KnownLobe known);

    // J' W d for a change d of the observed radiance of every row.
    [[nodiscard]] Parameters pull(std::span<const Rgb> radiance_change) const;
    // Change of the estimate when the observed radiance of every row changes by so much.
    [[nodiscard]] Parameters response(std::span<const Rgb> radiance_change) const;
    // Of each parameter's variance the share that is left when something else besides the looks
    // tells `information` of (Ps, sigma), which must be free [0 to 1]. noise_scale: standard
    // deviations of the looks over the stated ones.
    [[nodiscard]] Parameters share_beside(const Eigen::Matrix2d& information,
                                          double noise_scale) const;
    // Observed radiance of every row less that predicted by the best fit, in the linearised model
    // [radiance].
    [[nodiscard]] const std::vector<Rgb>& residuals() const { return residuals_; }
    // Variances of the estimate when every z has variance 1: independent in all looks and channels.
    [[nodiscard]] const Parameters& own_variance() const { return own_variance_; }
    // The same when the channels of a look err alike.
    [[nodiscard]] const Parameters& shared_variance() const { return shared_variance_; }
    [[nodiscard]] const ResidualMoments& moments() const { return moments_; }
    [[nodiscard]] InfluenceMoments influence() const;

  private:
    void leave_least_residuals();

    using Jacobian = Eigen::Matrix<double, kNumParameters, 3>;  // a column per channel
    using Covariance = Eigen::Matrix<double, kNumParameters, kNumParameters>;
    std::span<const FitRow> rows_;
    std::vector<Rgb> residuals_;
    std::vector<Jacobian> jacobians_;
    Covariance inverse_;            // of the information
    Covariance shared_covariance_;  // of the estimate, z alike in the channels of a look
    Parameters own_variance_ = Parameters::Zero();
    Parameters shared_variance_ = Parameters::Zero();
    ResidualMoments moments_;
};

}  // namespace patina
