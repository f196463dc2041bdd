#include "patina/estimate/lobe_misfit.h"

#include "patina/estimate/error_propagation.h"
#include "patina/estimate/joint_fit.h"
#include "patina/estimate/texel_turn.h"
#include "patina/math/statistics.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

constexpr std::size_t kMinLooks = 4;     // that remain: Pd, Ps, sigma and one to spare
constexpr std::size_t kMinMisfits = 30;  // texels
// Median of chi-square with one degree of freedom.
constexpr double kMedianChiSquare = 0.4549;

// Derivative of the mean over channels of the standardised prediction of a look.
Parameters gradient_of(const FitRow& row, const Reflectance& fitted) {
    const Rgb root = row.weight.sqrt() / 3;
    Parameters gradient;
    gradient.head<3>() = (root * row.irradiance / kPi).matrix();
    gradient[3] = (root * lobe_basis(row, fitted.roughness) / kPi).sum();
    gradient[4] =
        (root * fitted.specular * direct_lobe_basis_by_roughness(row, fitted.roughness) / kPi)
            .sum();
    return gradient;
}

// Variance of that prediction when the residuals of every look have variance 1 and its channels err
// alike.
double prediction_variance(std::span<const FitRow> rows,
                           const Reflectance& fitted,
                           const Parameters& gradient) {
    const ErrorPropagation propagation(rows, fitted, KnownLobe::all);
    std::vector<Rgb> change(rows.size(), Rgb::Zero());
    double variance = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (!(rows[k].weight > 0).all()) continue;
        change[k] = rows[k].weight.rsqrt();
        variance += square(gradient.dot(propagation.response(change)));
        change[k] = Rgb::Zero();
    }
    return variance;
}

}  // namespace

std::optional<double> left_out_misfit(std::span<const FitRow> rows,
                                      const Reflectance& fitted,
                                      double noise_scale,
                                      const FitOptions& options) {
    if (rows.size() < kMinLooks + 1) return std::nullopt;
    const auto deepest = std::min_element(
        rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.theta_r < b.theta_r; });
    std::vector<FitRow> others(rows.begin(), deepest);
    others.insert(others.end(), deepest + 1, rows.end());
    JointFit fit;
    fit.load(others);
    TexelFit without;
    without.reflectance = fit.solve(options, fitted.roughness);
    judge_lobe(others, noise_scale, false, options, without);
    if (!without.roughness_measured) return std::nullopt;
    const Rgb residual = deepest->radiance - predict(*deepest, without.reflectance);
    const double z = (deepest->weight.sqrt() * residual).mean();
    const Parameters gradient = gradient_of(*deepest, without.reflectance);
    const double variance = 1 + prediction_variance(others, without.reflectance, gradient);
    return square(z / noise_scale) / variance;
}

double lobe_misfit_factor(std::vector<double> misfits) {
    if (misfits.size() < kMinMisfits) return 1;
    return std::max(1.0, std::sqrt(median(std::move(misfits)) / kMedianChiSquare));
}

}  // namespace patina
