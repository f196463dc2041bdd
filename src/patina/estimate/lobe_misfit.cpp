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

// The median of so many is known to 1.6 %, and its root, by which errors are multiplied, to half of
// that.
constexpr std::size_t kManyMisfits = 20'000;

// `all` without the element at `left_out`.
template <typename Value>
std::vector<Value> without(std::span<const Value> all, std::ptrdiff_t left_out) {
    std::vector<Value> others(all.begin(), all.begin() + left_out);
    others.insert(others.end(), all.begin() + left_out + 1, all.end());
    return others;
}

// The left-out look's residual, standardised and as a mean over channels.
class LeftOut {
  public:
    LeftOut(const FitRow& row, std::span<const FitRow> others, const Reflectance& fitted)
        : row_(row),
          others_(others),
          gradient_(gradient_of(row, fitted)),
          propagation_(others, fitted, KnownLobe::all) {}

    // Of the residual, when those of all looks have variance 1 and their channels err alike.
    [[nodiscard]] double noise_variance() const {
        std::vector<Rgb> change(others_.size(), Rgb::Zero());
        double variance = 1;
        for (std::size_t k = 0; k < others_.size(); ++k) {
            if (!(others_[k].weight > 0).all()) continue;
            change[k] = others_[k].weight.rsqrt();
            variance += square(gradient_.dot(propagation_.response(change)));
            change[k] = Rgb::Zero();
        }
        return variance;
    }

    // Of the residual, when its radiance changes by `own` and that of the others by `change`.
    [[nodiscard]] double response(const Rgb& own, std::span<const Rgb> change) const {
        return (row_.weight.sqrt() * own).mean() - gradient_.dot(propagation_.response(change));
    }

  private:
    const FitRow& row_;
    std::span<const FitRow> others_;
    Parameters gradient_;
    ErrorPropagation propagation_;
};

}  // namespace

std::optional<double> left_out_misfit(std::span<const FitRow> rows,
                                      const Reflectance& fitted,
                                      std::span<const std::vector<Rgb>> changes,
                                      double noise_scale,
                                      const FitOptions& options) {
    if (rows.size() < kMinLooks + 1) return std::nullopt;
    const auto deepest =
        std::min_element(rows.begin(), rows.end(), [](const FitRow& a, const FitRow& b) {
            return a.theta_r < b.theta_r;
        });
    const std::ptrdiff_t index = deepest - rows.begin();
    const std::vector<FitRow> others = without(rows, index);
    JointFit fit;
    fit.load(others);
    TexelFit refitted;
    refitted.reflectance = fit.solve(options, fitted.roughness);
    judge_lobe(others, noise_scale, false, options, refitted);
    if (!refitted.roughness_measured) return std::nullopt;
    const LeftOut left_out(*deepest, others, refitted.reflectance);
    double variance = square(noise_scale) * left_out.noise_variance();
    for (const std::vector<Rgb>& change : changes) {
        const std::vector<Rgb> of_others = without(std::span<const Rgb>(change), index);
        variance += square(left_out.response(change[std::size_t(index)], of_others));
    }
    if (!(variance > 0)) return std::nullopt;  // looks without any noise
    const Rgb residual = deepest->radiance - predict(*deepest, refitted.reflectance);
    return square((deepest->weight.sqrt() * residual).mean()) / variance;
}

std::size_t misfit_stride(std::span<const TexelFit> fits) {
    const auto num_measured = std::count_if(
        fits.begin(), fits.end(), [](const TexelFit& fit) { return fit.roughness_measured; });
    return 1 + std::size_t(num_measured) / kManyMisfits;
}

double lobe_misfit_factor(std::span<const std::optional<double>> misfits) {
    std::vector<double> known;
    for (const std::optional<double>& misfit : misfits) {
        if (misfit) known.push_back(*misfit);
    }
    if (known.size() < kMinMisfits) return 1;
    return std::max(1.0, std::sqrt(median(std::move(known)) / kMedianChiSquare));
}

}  // namespace patina
