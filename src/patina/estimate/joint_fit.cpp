#include "patina/estimate/joint_fit.h"

#include "patina/math/bracket.h"
#include "patina/reflectance/lobe_lanes.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

constexpr std::size_t kVector = 8;
constexpr int kRoughnessGrid = 14;
// The errors-in-variables term never takes away more than this share of the information.
constexpr double kMaxNoiseShare = 0.5;
// First bracket about a sigma that is known from the last turn, and how often it may double
// [log rad].
constexpr double kWarmStep = 0.06;
constexpr int kWarmSteps = 3;
// The search ends when the next point is this close [log rad].
constexpr double kLogTolerance = 1e-4;
constexpr int kMaxRefinements = 12;

template <typename Cost>
double refine(Bracket bracket, const Cost& cost) {
    for (int step = 0; step < kMaxRefinements; ++step) {
        double x = bracket.next();
        if (std::abs(x - bracket.middle) < kLogTolerance) break;
        bracket.insert(x, cost(x));
    }
    return bracket.middle;
}

}  // namespace

void JointFit::load(std::span<const FitRow> rows) {
    num_rows_ = rows.size();
    num_lanes_ = (rows.size() + kVector - 1) / kVector * kVector;
    std::size_t num_terms = 0;
    for (const FitRow& row : rows) num_terms += row.lamps.size();
    one_lamp_each_ = std::all_of(
        rows.begin(), rows.end(), [](const FitRow& row) { return row.lamps.size() == 1; });
    has_indirect_ = std::any_of(rows.begin(), rows.end(), [](const FitRow& row) {
        return (row.indirect_lobe.twice != 0.0f).any();
    });
    indirect_roughness_ = rows.empty() ? 1.0 : rows.front().indirect_roughness;
    const std::size_t padded_terms =
        one_lamp_each_ ? num_lanes_ : (num_terms + kVector - 1) / kVector * kVector;
    theta_squared_.assign(padded_terms, 0.0f);
    spread_along_.assign(padded_terms, 0.0f);
    spread_across_.assign(padded_terms, 0.0f);
    gaussian_.assign(padded_terms, 0.0f);
    row_of_term_.clear();
    for (std::size_t c = 0; c < 3; ++c) {
        amplitude_[c].assign(padded_terms, 0.0f);
        for (Lanes* lanes : {&weight_[c], &irradiance_[c], &radiance_[c], &basis_[c]}) {
            lanes->assign(num_lanes_, 0.0f);
        }
        if (!has_indirect_) continue;
        for (Lanes* lanes : {&same_[c], &slope_[c], &bend_[c]}) lanes->assign(num_lanes_, 0.0f);
    }
    hh_ = ho_ = oo_ = Rgb::Zero();
    std::size_t term = 0;
    for (std::size_t r = 0; r < num_rows_; ++r) {
        const FitRow& row = rows[r];
        for (const LampTerm& lamp : row.lamps) {
            theta_squared_[term] = lamp.theta_r_squared;
            spread_along_[term] = lamp.spread_along;
            spread_across_[term] = lamp.spread_across;
            for (std::size_t c = 0; c < 3; ++c) {
                amplitude_[c][term] =
                    lamp.irradiance[Eigen::Index(c)] * lamp.lobe_cosines * float(1 / kPi);
            }
            row_of_term_.push_back(std::uint32_t(r));
            ++term;
        }
        for (std::size_t c = 0; c < 3; ++c) {
            const auto i = static_cast<Eigen::Index>(c);
            const double w = row.weight[i];
            const double h = row.irradiance[i] / kPi;
            weight_[c][r] = float(w);
            irradiance_[c][r] = float(h);
            radiance_[c][r] = float(row.radiance[i]);
            const double noise =
                std::min(row.irradiance_variance[i] / square(kPi), kMaxNoiseShare * h * h);
            hh_[i] += w * (h * h - noise);
            ho_[i] += w * h * row.radiance[i];
            oo_[i] += w * square(row.radiance[i]);
            if (!has_indirect_) continue;
            const IndirectLobe& lobe = row.indirect_lobe;
            same_[c][r] = lobe.same[i] * float(1 / kPi);
            slope_[c][r] = 0.5f * (lobe.twice[i] - lobe.half[i]) * float(1 / kPi);
            bend_[c][r] = (0.5f * (lobe.twice[i] + lobe.half[i]) - lobe.same[i]) * float(1 / kPi);
        }
    }
}

void JointFit::basis_at(double roughness) const {
    const auto variance = float(square(roughness));
    // See spread_gaussian().
    for (std::size_t t = 0; t < theta_squared_.size(); ++t) {
        const float along = variance + spread_along_[t];
        const float across = variance + spread_across_[t];
        gaussian_[t] = exp_of_negative(-0.5f * theta_squared_[t] / along) * variance /
                       std::sqrt(along * across);
    }
    const auto octave = float(std::clamp(std::log2(roughness / indirect_roughness_), -1.0, 1.0));
    for (std::size_t c = 0; c < 3; ++c) {
        Lanes& basis = basis_[c];
        if (one_lamp_each_) {
            for (std::size_t l = 0; l < num_lanes_; ++l) {
                basis[l] = amplitude_[c][l] * gaussian_[l];
            }
        } else {
            std::fill(basis.begin(), basis.end(), 0.0f);
            for (std::size_t t = 0; t < row_of_term_.size(); ++t) {
                basis[row_of_term_[t]] += amplitude_[c][t] * gaussian_[t];
            }
        }
        if (!has_indirect_) continue;
        // The parabola through the three widths (see lobe_basis()).
        for (std::size_t l = 0; l < num_lanes_; ++l) {
            const float over_square = same_[c][l] + octave * (slope_[c][l] + octave * bend_[c][l]);
            basis[l] += std::max(over_square, 0.0f) * variance;
        }
    }
}

JointFit::Sums JointFit::sums_at(double roughness) const {
    basis_at(roughness);
    Sums sums;
    for (std::size_t c = 0; c < 3; ++c) {
        std::array<float, kVector> hb{}, bb{}, bo{};
        for (std::size_t begin = 0; begin < num_lanes_; begin += kVector) {
            for (std::size_t l = 0; l < kVector; ++l) {
                const std::size_t r = begin + l;
                const float wb = weight_[c][r] * basis_[c][r];
                hb[l] += wb * irradiance_[c][r];
                bb[l] += wb * basis_[c][r];
                bo[l] += wb * radiance_[c][r];
            }
        }
        const auto i = static_cast<Eigen::Index>(c);
        for (std::size_t l = 0; l < kVector; ++l) {
            sums.hb[i] += double(hb[l]);
            sums.bb[i] += double(bb[l]);
            sums.bo[i] += double(bo[l]);
        }
    }
    return sums;
}

double JointFit::specular_of(const Sums& sums) const {
    const Rgb inverse = (hh_ > 0).select(1 / hh_, 0.0);
    const double information = (sums.bb - sums.hb * sums.hb * inverse).sum();
    if (!(information > 0)) return 0;
    return std::max(0.0, (sums.bo - sums.hb * ho_ * inverse).sum() / information);
}

Rgb JointFit::diffuse_of(const Sums& sums, double specular) const {
    return (hh_ > 0).select((ho_ - specular * sums.hb) / hh_, 0.0).max(0.0);
}

double JointFit::cost_at(double log_roughness) const {
    const Sums sums = sums_at(std::exp(log_roughness));
    const double ps = specular_of(sums);
    const Rgb pd = diffuse_of(sums, ps);
    return (oo_ - 2 * (pd * ho_ + ps * sums.bo) + pd * pd * hh_ + 2 * ps * pd * sums.hb +
            ps * ps * sums.bb)
        .sum();
}

Reflectance JointFit::solve(const FitOptions& options, double start) const {
    const double low = std::log(options.min_roughness);
    const double high = std::log(options.max_roughness);
    const auto cost = [this](double x) { return cost_at(x); };
    double best = 0;
    bool found = false;
    if (start > 0) {
        double step = kWarmStep;
        const double x = std::clamp(std::log(start), low, high);
        Bracket bracket{x - step, x, x + step, cost(x - step), cost(x), cost(x + step)};
        for (int k = 0; k < kWarmSteps; ++k) {
            if (bracket.cost_middle <= std::min(bracket.cost_low, bracket.cost_high)) break;
            // Downhill, in steps that double.
            step *= 2;
            if (bracket.cost_low < bracket.cost_high) {
                const double next = bracket.low - step;
                bracket = {next,
                           bracket.low,
                           bracket.middle,
                           cost(next),
                           bracket.cost_low,
                           bracket.cost_middle};
            } else {
                const double next = bracket.high + step;
                bracket = {bracket.middle,
                           bracket.high,
                           next,
                           bracket.cost_middle,
                           bracket.cost_high,
                           cost(next)};
            }
        }
        found = bracket.cost_middle <= std::min(bracket.cost_low, bracket.cost_high);
        if (found) best = refine(bracket, cost);
    }
    if (!found) {
        const double step = (high - low) / (kRoughnessGrid - 1);
        std::array<double, kRoughnessGrid> costs;
        for (int i = 0; i < kRoughnessGrid; ++i) costs[std::size_t(i)] = cost(low + i * step);
        const auto lowest = std::min_element(costs.begin(), costs.end()) - costs.begin();
        best = low + double(lowest) * step;
        if (lowest > 0 && lowest + 1 < kRoughnessGrid) {
            const auto i = std::size_t(lowest);
            best = refine({best - step, best, best + step, costs[i - 1], costs[i], costs[i + 1]},
                          cost);
        }
    }
    return solve_at(std::exp(std::clamp(best, low, high)));
}

Reflectance JointFit::solve_at(double roughness) const {
    Reflectance fit;
    fit.roughness = roughness;
    const Sums sums = sums_at(roughness);
    fit.specular = specular_of(sums);
    fit.diffuse = diffuse_of(sums, fit.specular);
    return fit;
}

Rgb JointFit::diffuse_with(double specular, double roughness) const {
    return diffuse_of(specular > 0 ? sums_at(roughness) : Sums(), specular);
}

void JointFit::misfits(const Reflectance& reflectance, std::vector<double>& result) const {
    basis_at(reflectance.roughness);
    result.assign(num_rows_, 0.0);
    for (std::size_t c = 0; c < 3; ++c) {
        const auto diffuse = float(reflectance.diffuse[Eigen::Index(c)]);
        const auto specular = float(reflectance.specular);
        for (std::size_t r = 0; r < num_rows_; ++r) {
            const float residual =
                radiance_[c][r] - diffuse * irradiance_[c][r] - specular * basis_[c][r];
            result[r] += double(weight_[c][r] * residual * residual) / 3;
        }
    }
}

double JointFit::squared_error(const Reflectance& reflectance) const {
    basis_at(reflectance.roughness);
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto diffuse = float(reflectance.diffuse[Eigen::Index(c)]);
        const auto specular = float(reflectance.specular);
        for (std::size_t r = 0; r < num_rows_; ++r) {
            const float residual =
                radiance_[c][r] - diffuse * irradiance_[c][r] - specular * basis_[c][r];
            sum += double(residual * residual);
        }
    }
    return sum;
}

}  // namespace patina
