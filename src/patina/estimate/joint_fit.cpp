#include "patina/estimate/joint_fit.h"

#include "patina/math/bracket.h"
#include "patina/reflectance/lobe_lanes.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

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

// Sums of the lanes, in double precision.
Rgb sum_of(const std::array<Lanes, 3>& lanes) {
    return Rgb(sum_of_lanes(lanes[0]), sum_of_lanes(lanes[1]), sum_of_lanes(lanes[2]));
}

std::array<float, 3> to_floats(const Rgb& color) {
    return {float(color[0]), float(color[1]), float(color[2])};
}

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
    std::size_t num_terms = 0;
    for (const FitRow& row : rows) num_terms += row.lamps.size();
    one_lamp_each_ = std::all_of(
        rows.begin(), rows.end(), [](const FitRow& row) { return row.lamps.size() == 1; });
    has_indirect_ = std::any_of(rows.begin(), rows.end(), [](const FitRow& row) {
        return (row.indirect_lobe.twice != 0.0f).any();
    });
    indirect_roughness_ = rows.empty() ? 1.0 : rows.front().indirect_roughness;
    const std::size_t num_lanes = (rows.size() + kLanes - 1) / kLanes;
    const std::size_t num_term_lanes = (num_terms + kLanes - 1) / kLanes;
    rows_.assign(num_lanes, {});
    terms_.assign(num_term_lanes, {});
    basis_.resize(num_lanes);
    basis_slope_.resize(num_lanes);
    gaussian_.resize(num_term_lanes);
    gaussian_slope_.resize(num_term_lanes);
    row_of_term_.clear();
    hh_ = ho_ = oo_ = Rgb::Zero();
    for (std::size_t r = 0; r < num_rows_; ++r) {
        for (const LampTerm& lamp : rows[r].lamps) load_term(lamp, r);
        load_row(rows[r], r);
    }
    inverse_hh_ = (hh_ > 0).select(1 / hh_, 0.0);
}

void JointFit::load_term(const LampTerm& lamp, std::size_t row) {
    const std::size_t term = row_of_term_.size();
    Terms& terms = terms_[term / kLanes];
    const std::size_t lane = term % kLanes;
    terms.theta_squared[lane] = lamp.theta_r_squared;
    terms.spread_along[lane] = lamp.spread_along;
    terms.spread_across[lane] = lamp.spread_across;
    for (std::size_t c = 0; c < 3; ++c) {
        terms.amplitude[c][lane] =
            lamp.irradiance[Eigen::Index(c)] * lamp.lobe_cosines * float(1 / kPi);
    }
    row_of_term_.push_back(std::uint32_t(row));
}

void JointFit::load_row(const FitRow& row, std::size_t number) {
    Rows& rows = rows_[number / kLanes];
    const std::size_t lane = number % kLanes;
    const Rgb h = row.irradiance / kPi;
    const Rgb noise = (row.irradiance_variance / square(kPi)).min(kMaxNoiseShare * h * h);
    const Rgb wo = row.weight * row.radiance;
    hh_ += row.weight * (h * h - noise);
    ho_ += wo * h;
    oo_ += wo * row.radiance;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto i = static_cast<Eigen::Index>(c);
        rows.weight[c][lane] = float(row.weight[i]);
        rows.irradiance[c][lane] = float(h[i]);
        rows.radiance[c][lane] = float(row.radiance[i]);
        if (!has_indirect_) continue;
        const IndirectLobe& lobe = row.indirect_lobe;
        rows.same[c][lane] = lobe.same[i] * float(1 / kPi);
        rows.slope[c][lane] = 0.5f * (lobe.twice[i] - lobe.half[i]) * float(1 / kPi);
        rows.bend[c][lane] =
            (0.5f * (lobe.twice[i] + lobe.half[i]) - lobe.same[i]) * float(1 / kPi);
    }
}

void JointFit::collect(const std::vector<Lanes>& of_term, std::vector<RgbLanes>& of_row) const {
    if (one_lamp_each_) {
        for (std::size_t k = 0; k < terms_.size(); ++k) {
            for (std::size_t c = 0; c < 3; ++c) of_row[k][c] = terms_[k].amplitude[c] * of_term[k];
        }
        return;
    }
    std::fill(of_row.begin(), of_row.end(), RgbLanes{});
    for (std::size_t t = 0; t < row_of_term_.size(); ++t) {
        const std::size_t row = row_of_term_[t];
        for (std::size_t c = 0; c < 3; ++c) {
            of_row[row / kLanes][c][row % kLanes] +=
                terms_[t / kLanes].amplitude[c][t % kLanes] * of_term[t / kLanes][t % kLanes];
        }
    }
}

void JointFit::basis_at(double roughness) const {
    const auto variance = float(square(roughness));
    // See spread_gaussian().
    for (std::size_t k = 0; k < terms_.size(); ++k) {
        const Lanes along = variance + terms_[k].spread_along;
        const Lanes across = variance + terms_[k].spread_across;
        gaussian_[k] = exp_of_negative(-0.5f * terms_[k].theta_squared / along) * variance /
                       square_root(along * across);
    }
    collect(gaussian_, basis_);
    if (!has_indirect_) return;
    // The parabola through the three widths (see lobe_basis()).
    const auto octave = float(std::clamp(std::log2(roughness / indirect_roughness_), -1.0, 1.0));
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const Rows& rows = rows_[k];
        for (std::size_t c = 0; c < 3; ++c) {
            const Lanes over_square =
                rows.same[c] + octave * (rows.slope[c] + octave * rows.bend[c]);
            basis_[k][c] += (over_square > 0.0f ? over_square : Lanes{}) * variance;
        }
    }
}

// After basis_at() of the same sigma.
void JointFit::slope_at(double roughness) const {
    const auto variance = float(square(roughness));
    // The logarithm of spread_gaussian(), with 2 variance for its derivative in log sigma.
    for (std::size_t k = 0; k < terms_.size(); ++k) {
        const Terms& terms = terms_[k];
        const Lanes along = variance / (variance + terms.spread_along);
        const Lanes across = variance / (variance + terms.spread_across);
        gaussian_slope_[k] = gaussian_[k] * (2.0f - along - across +
                                             terms.theta_squared / variance * (along * along));
    }
    collect(gaussian_slope_, basis_slope_);
    if (!has_indirect_) return;
    const double octave = std::log2(roughness / indirect_roughness_);
    const auto clamped = float(std::clamp(octave, -1.0, 1.0));
    const auto by_log = float(std::abs(octave) < 1 ? 1 / std::log(2.0) : 0.0);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const Rows& rows = rows_[k];
        for (std::size_t c = 0; c < 3; ++c) {
            const Lanes over_square =
                rows.same[c] + clamped * (rows.slope[c] + clamped * rows.bend[c]);
            const Lanes rise = by_log * (rows.slope[c] + 2.0f * clamped * rows.bend[c]);
            basis_slope_[k][c] +=
                over_square > 0.0f ? variance * (2.0f * over_square + rise) : Lanes{};
        }
    }
}

JointFit::Sums JointFit::sums_at(double roughness) const {
    basis_at(roughness);
    RgbLanes hb{}, bb{}, bo{};
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const Rows& rows = rows_[k];
        for (std::size_t c = 0; c < 3; ++c) {
            const Lanes basis = basis_[k][c];
            const Lanes wb = rows.weight[c] * basis;
            hb[c] += wb * rows.irradiance[c];
            bb[c] += wb * basis;
            bo[c] += wb * rows.radiance[c];
        }
    }
    return {sum_of(hb), sum_of(bb), sum_of(bo)};
}

double JointFit::specular_of(const Sums& sums) const {
    const Rgb share = sums.hb * inverse_hh_;
    const double information = (sums.bb - sums.hb * share).sum();
    if (!(information > 0)) return 0;
    return std::max(0.0, (sums.bo - share * ho_).sum() / information);
}

Rgb JointFit::diffuse_of(const Sums& sums, double specular) const {
    return ((ho_ - specular * sums.hb) * inverse_hh_).max(0.0);
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
    slope_at(roughness);
    // At the best Pd and Ps for this sigma the derivative of the cost is that by sigma alone; its
    // second one is taken without what Pd and Ps can make up for (Kaufman's approximation).
    const std::array<float, 3> diffuse = to_floats(diffuse_of(sums, ps));
    const auto specular = float(ps);
    RgbLanes rs{}, hs_lanes{}, bs_lanes{}, ss_lanes{};
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const Rows& rows = rows_[k];
        for (std::size_t c = 0; c < 3; ++c) {
            const Lanes basis = basis_[k][c];
            const Lanes slope = basis_slope_[k][c];
            const Lanes ws = rows.weight[c] * slope;
            rs[c] += ws * (rows.radiance[c] - diffuse[c] * rows.irradiance[c] - specular * basis);
            hs_lanes[c] += ws * rows.irradiance[c];
            bs_lanes[c] += ws * basis;
            ss_lanes[c] += ws * slope;
        }
    }
    const double descent = sum_of(rs).sum();
    const Rgb hs = sum_of(hs_lanes);
    const double of_specular = (sums.bb - sums.hb * sums.hb * inverse_hh_).sum();
    const double shared = (sum_of(bs_lanes) - sums.hb * hs * inverse_hh_).sum();
    const double curvature =
        (sum_of(ss_lanes) - hs * hs * inverse_hh_).sum() - square(shared) / of_specular;
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

// Residuals of all rows of the model that basis_at() was called for.
template <typename Use>
void JointFit::for_each_residual(const Reflectance& reflectance, const Use& use) const {
    const std::array<float, 3> diffuse = to_floats(reflectance.diffuse);
    const auto specular = float(reflectance.specular);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const Rows& rows = rows_[k];
        for (std::size_t c = 0; c < 3; ++c) {
            use(k, c, rows.radiance[c] - diffuse[c] * rows.irradiance[c] - specular * basis_[k][c]);
        }
    }
}

void JointFit::misfits(const Reflectance& reflectance, std::vector<double>& result) const {
    basis_at(reflectance.roughness);
    result.assign(num_rows_, 0.0);
    for_each_residual(reflectance, [&](std::size_t k, std::size_t c, Lanes residual) {
        const Lanes misfit = rows_[k].weight[c] * residual * residual;
        const std::size_t count = std::min(kLanes, num_rows_ - k * kLanes);
        for (std::size_t l = 0; l < count; ++l) {
            result[k * kLanes + l] += double(misfit[l]) / 3;
        }
    });
}

double JointFit::squared_error(const Reflectance& reflectance) const {
    basis_at(reflectance.roughness);
    RgbLanes sums{};
    for_each_residual(reflectance, [&](std::size_t /*k*/, std::size_t c, Lanes residual) {
        sums[c] += residual * residual;
    });
    return sum_of(sums).sum();
}

}  // namespace patina
