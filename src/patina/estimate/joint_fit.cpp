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
// Gauss-Newton steps about a sigma that is known nearly [log rad]: none is longer than this, each
// is shorter than the one before by this factor, and there are at most so many.
constexpr double kLongestStep = 0.3;
constexpr double kLeastContraction = 0.7;
constexpr int kMaxSteps = 8;
// The search ends when the next point is this close: a length [log rad], and a share of the
// standard error that noise of weight 1 leaves.
constexpr double kLogTolerance = 1e-4;
constexpr double kErrorTolerance = 0.01;
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
    gaussian_slope_.assign(padded_terms, 0.0f);
    row_of_term_.clear();
    for (std::size_t c = 0; c < 3; ++c) {
        amplitude_[c].assign(padded_terms, 0.0f);
        for (Lanes* lanes :
             {&weight_[c], &irradiance_[c], &radiance_[c], &basis_[c], &basis_slope_[c]}) {
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

// After basis_at() of the same sigma.
void JointFit::slope_at(double roughness) const {
    const auto variance = float(square(roughness));
    // The logarithm of spread_gaussian(), with 2 variance for its derivative in log sigma.
    for (std::size_t t = 0; t < theta_squared_.size(); ++t) {
        const float along = variance / (variance + spread_along_[t]);
        const float across = variance / (variance + spread_across_[t]);
        gaussian_slope_[t] =
            gaussian_[t] * (2.0f - along - across + theta_squared_[t] / variance * (along * along));
    }
    const double octave = std::log2(roughness / indirect_roughness_);
    const auto clamped = float(std::clamp(octave, -1.0, 1.0));
    const auto by_log = float(std::abs(octave) < 1 ? 1 / std::log(2.0) : 0.0);
    for (std::size_t c = 0; c < 3; ++c) {
        Lanes& slope = basis_slope_[c];
        if (one_lamp_each_) {
            for (std::size_t l = 0; l < num_lanes_; ++l) {
                slope[l] = amplitude_[c][l] * gaussian_slope_[l];
            }
        } else {
            std::fill(slope.begin(), slope.end(), 0.0f);
            for (std::size_t t = 0; t < row_of_term_.size(); ++t) {
                slope[row_of_term_[t]] += amplitude_[c][t] * gaussian_slope_[t];
            }
        }
        if (!has_indirect_) continue;
        for (std::size_t l = 0; l < num_lanes_; ++l) {
            const float over_square =
                same_[c][l] + clamped * (slope_[c][l] + clamped * bend_[c][l]);
            const float rise = by_log * (slope_[c][l] + 2.0f * clamped * bend_[c][l]);
            slope[l] += over_square > 0.0f ? variance * (2.0f * over_square + rise) : 0.0f;
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

std::optional<JointFit::Step> JointFit::step_at(double log_roughness) const {
    const double roughness = std::exp(log_roughness);
    const Sums sums = sums_at(roughness);
    const double ps = specular_of(sums);
    if (!(ps > 0)) return std::nullopt;
    const Rgb pd = diffuse_of(sums, ps);
    slope_at(roughness);
    // At the best Pd and Ps for this sigma the derivative of the cost is that by sigma alone; its
    // second one is taken without what Pd and Ps can make up for (Kaufman's approximation).
    double descent = 0;
    Rgb hs = Rgb::Zero(), bs = Rgb::Zero(), ss = Rgb::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
        const auto i = static_cast<Eigen::Index>(c);
        const auto diffuse = float(pd[i]);
        const auto specular = float(ps);
        std::array<float, kVector> rs_lanes{}, hs_lanes{}, bs_lanes{}, ss_lanes{};
        for (std::size_t begin = 0; begin < num_lanes_; begin += kVector) {
            for (std::size_t l = 0; l < kVector; ++l) {
                const std::size_t r = begin + l;
                const float ws = weight_[c][r] * basis_slope_[c][r];
                rs_lanes[l] +=
                    ws * (radiance_[c][r] - diffuse * irradiance_[c][r] - specular * basis_[c][r]);
                hs_lanes[l] += ws * irradiance_[c][r];
                bs_lanes[l] += ws * basis_[c][r];
                ss_lanes[l] += ws * basis_slope_[c][r];
            }
        }
        for (std::size_t l = 0; l < kVector; ++l) {
            descent += double(rs_lanes[l]);
            hs[i] += double(hs_lanes[l]);
            bs[i] += double(bs_lanes[l]);
            ss[i] += double(ss_lanes[l]);
        }
    }
    const Rgb inverse = (hh_ > 0).select(1 / hh_, 0.0);
    const double of_specular = (sums.bb - sums.hb * sums.hb * inverse).sum();
    const double shared = (bs - sums.hb * hs * inverse).sum();
    const double curvature = (ss - hs * hs * inverse).sum() - square(shared) / of_specular;
    if (!(curvature > 0)) return std::nullopt;
    return Step{std::clamp(descent / (ps * curvature), -kLongestStep, kLongestStep),
                1 / (ps * std::sqrt(curvature))};
}

std::optional<double> JointFit::descend(double start, double low, double high) const {
    double x = std::clamp(start, low, high);
    double allowed = kLongestStep;
    for (int k = 0; k < kMaxSteps; ++k) {
        const std::optional<Step> step = step_at(x);
        if (!step) return std::nullopt;
        const double length = std::abs(step->length);
        if (length > allowed) return std::nullopt;
        const double before = x;
        x = std::clamp(x + step->length, low, high);
        if (std::abs(x - before) < std::max(kLogTolerance, kErrorTolerance * step->error)) return x;
        if (length < kLongestStep) allowed = kLeastContraction * length;
    }
    return std::nullopt;
}

Reflectance JointFit::solve(const FitOptions& options, double start) const {
    const double low = std::log(options.min_roughness);
    const double high = std::log(options.max_roughness);
    if (start > 0) {
        const std::optional<double> found = descend(std::log(start), low, high);
        if (found) return solve_at(std::exp(*found));
    }
    const auto cost = [this](double x) { return cost_at(x); };
    const double step = (high - low) / (kRoughnessGrid - 1);
    std::array<double, kRoughnessGrid> costs;
    for (int i = 0; i < kRoughnessGrid; ++i) costs[std::size_t(i)] = cost(low + i * step);
    const auto lowest = std::min_element(costs.begin(), costs.end()) - costs.begin();
    double best = low + double(lowest) * step;
    if (lowest > 0 && lowest + 1 < kRoughnessGrid) {
        const std::optional<double> found = descend(best, best - step, best + step);
        const auto i = std::size_t(lowest);
        best = found
                   ? *found
                   : refine({best - step, best, best + step, costs[i - 1], costs[i], costs[i + 1]},
                            cost);
    }
    return solve_at(std::exp(best));
}

Reflectance JointFit::follow(const FitOptions& options, double start) const {
    const double from = std::log(start);
    const double low = std::max(std::log(options.min_roughness), from - kLongestStep);
    const double high = std::min(std::log(options.max_roughness), from + kLongestStep);
    const std::optional<double> found = low < high ? descend(from, low, high) : std::nullopt;
    const bool is_inside = found && *found > low && *found < high;
    return solve_at(is_inside ? std::exp(*found) : start);
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
