// How errors of one texel's looks reach its Pd, Ps and sigma: the weighted least squares fit,
// linearised about its solution. docs/uncertainty.md has the formulas.
#pragma once

#include "patina/estimate/texel_fit.h"

#include <Eigen/Core>

#include <span>

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

class ErrorPropagation {
  public:
    // rows: with the weights of the fit.
    ErrorPropagation(std::span<const FitRow> rows, const Reflectance& fitted, KnownLobe known);

    // Change of the estimate when the observed radiance of every row changes by so much.
    [[nodiscard]] Parameters response(std::span<const Rgb> radiance_change) const;
    // Variances of the estimate when every z has variance 1: independent in all looks and channels.
    [[nodiscard]] const Parameters& own_variance() const { return own_variance_; }
    // The same when the channels of a look err alike.
    [[nodiscard]] const Parameters& shared_variance() const { return shared_variance_; }
    [[nodiscard]] const ResidualMoments& moments() const { return moments_; }

  private:
    using Jacobian = Eigen::Matrix<double, kNumParameters, 3>;  // a column per channel
    std::span<const FitRow> rows_;
    std::vector<Jacobian> jacobians_;
    Eigen::Matrix<double, kNumParameters, kNumParameters> inverse_;  // of the information
    Parameters own_variance_ = Parameters::Zero();
    Parameters shared_variance_ = Parameters::Zero();
    ResidualMoments moments_;
};

}  // namespace patina
