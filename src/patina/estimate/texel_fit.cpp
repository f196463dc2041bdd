#include "patina/estimate/texel_fit.h"

#include <algorithm>
#include <array>
#include <limits>

namespace patina {
namespace {

constexpr int kRoughnessGrid = 14;
constexpr int kGoldenSteps = 14;
// The errors-in-variables term never takes away more than this share of the information.
constexpr double kMaxNoiseShare = 0.5;
// Rows this many sigma_0 from the mirror direction take part in (b) whatever their class, so that a
// texel once thought matte can be found glossy.
constexpr double kLobeReach = 2.0;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Which rows step (a) uses: T_diff, or the next best.
PixelClass diffuse_source(std::span<const FitRow> rows) {
    PixelClass best = PixelClass::specular;
    for (const FitRow& row : rows) {
        if (row.pixel_class == PixelClass::diffuse) return PixelClass::diffuse;
        if (row.pixel_class == PixelClass::neither) best = PixelClass::neither;
    }
    return best;
}

bool in_lobe(const FitRow& row, const FitOptions& options) {
    return row.pixel_class != PixelClass::diffuse ||
           row.theta_r < kLobeReach * options.initial_roughness;
}

// Weighted sums of step (b) for one sigma.
struct LobeSums {
    double basis_basis = 0;
    double basis_residual = 0;
    double residual_residual = 0;

    [[nodiscard]] double specular() const {
        return basis_basis > 0 ? std::max(0.0, basis_residual / basis_basis) : 0.0;
    }
    [[nodiscard]] double cost() const {
        const double ps = specular();
        return residual_residual - 2 * ps * basis_residual + ps * ps * basis_basis;
    }
};

template <typename Use>
LobeSums lobe_sums(std::span<const FitRow> rows,
                   const Rgb& diffuse,
                   double roughness,
                   const Use& use) {
    LobeSums sums;
    for (const FitRow& row : rows) {
        if (!use(row)) continue;
        const Rgb basis = lobe_basis(row, roughness) / kPi;
        const Rgb residual = row.radiance - diffuse * row.irradiance / kPi;
        sums.basis_basis += (row.weight * basis * basis).sum();
        sums.basis_residual += (row.weight * basis * residual).sum();
        sums.residual_residual += (row.weight * residual * residual).sum();
    }
    return sums;
}

// Smallest cost in [low, high] of log sigma by golden sections.
template <typename Cost>
double golden_section(double low, double high, const Cost& cost) {
    constexpr double kRatio = 0.6180339887498949;
    double a = high - kRatio * (high - low);
    double b = low + kRatio * (high - low);
    double cost_a = cost(a);
    double cost_b = cost(b);
    for (int step = 0; step < kGoldenSteps; ++step) {
        if (cost_a < cost_b) {
            high = b;
            b = a;
            cost_b = cost_a;
            a = high - kRatio * (high - low);
            cost_a = cost(a);
        } else {
            low = a;
            a = b;
            cost_a = cost_b;
            b = low + kRatio * (high - low);
            cost_b = cost(b);
        }
    }
    return cost_a < cost_b ? a : b;
}

// sigma of the smallest cost: a logarithmic grid, then golden sections about its best point.
template <typename Cost>
double best_roughness(const FitOptions& options, const Cost& cost) {
    const double low = std::log(options.min_roughness);
    const double step = (std::log(options.max_roughness) - low) / (kRoughnessGrid - 1);
    int best = 0;
    double best_cost = kInfinity;
    for (int i = 0; i < kRoughnessGrid; ++i) {
        const double at = cost(std::exp(low + i * step));
        if (at < best_cost) {
            best_cost = at;
            best = i;
        }
    }
    return std::exp(
        golden_section(low + std::max(best - 1, 0) * step,
                       low + std::min(best + 1, kRoughnessGrid - 1) * step,
                       [&cost](double log_roughness) { return cost(std::exp(log_roughness)); }));
}

// Weighted sums of the joint fit for one sigma; Pd is projected out of Ps (arrow normal equations).
class JointSums {
  public:
    JointSums(std::span<const FitRow> rows, double roughness) {
        for (const FitRow& row : rows) {
            const Rgb h = row.irradiance / kPi;
            const Rgb b = lobe_basis(row, roughness) / kPi;
            hh_ += row.weight *
                   (h * h - (row.irradiance_variance / square(kPi)).min(kMaxNoiseShare * h * h));
            hb_ += row.weight * h * b;
            bb_ += row.weight * b * b;
            ho_ += row.weight * h * row.radiance;
            bo_ += row.weight * b * row.radiance;
            oo_ += row.weight * row.radiance * row.radiance;
        }
    }

    [[nodiscard]] double specular() const {
        const Rgb inverse = (hh_ > 0).select(1 / hh_, 0.0);
        const double information = (bb_ - hb_ * hb_ * inverse).sum();
        return information > 0 ? std::max(0.0, (bo_ - hb_ * ho_ * inverse).sum() / information)
                               : 0.0;
    }
    [[nodiscard]] Rgb diffuse(double specular) const {
        return (hh_ > 0).select((ho_ - specular * hb_) / hh_, 0.0).max(0.0);
    }
    [[nodiscard]] double cost() const {
        const double ps = specular();
        const Rgb pd = diffuse(ps);
        return (oo_ - 2 * (pd * ho_ + ps * bo_) + pd * pd * hh_ + 2 * ps * pd * hb_ + ps * ps * bb_)
            .sum();
    }

  private:
    Rgb hh_ = Rgb::Zero(), hb_ = Rgb::Zero(), bb_ = Rgb::Zero();
    Rgb ho_ = Rgb::Zero(), bo_ = Rgb::Zero(), oo_ = Rgb::Zero();
};

// Derivative of ln spread_gaussian() with respect to sigma [1/rad].
double log_slope(const LampTerm& lamp, double roughness) {
    const double along = square(roughness) + double(lamp.spread_along);
    const double across = square(roughness) + double(lamp.spread_across);
    return double(lamp.theta_r_squared) * roughness / square(along) + 2 / roughness -
           roughness / along - roughness / across;
}

// The indirect part of lobe_basis().
Rgb indirect_lobe_basis(const FitRow& row, double roughness) {
    const IndirectLobe& lobe = row.indirect_lobe;
    if ((lobe.twice == 0.0f).all()) return Rgb::Zero();
    const auto octave = float(std::clamp(std::log2(roughness / row.indirect_roughness), -1.0, 1.0));
    // The parabola through the three widths; it may dip below zero only where all three are noise.
    const Rgbf slope = 0.5f * (lobe.twice - lobe.half);
    const Rgbf bend = 0.5f * (lobe.twice + lobe.half) - lobe.same;
    const Rgbf over_square = (lobe.same + octave * (slope + octave * bend)).max(0.0f);
    return over_square.cast<double>() * square(roughness);
}

// Sums of the Fisher information of (Pd, Ps, sigma), one channel of Pd at a time.
struct ChannelInformation {
    double hh = 0, hb = 0, hd = 0, bb = 0, bd = 0, dd = 0;
};

}  // namespace

double spread_gaussian(const LampTerm& lamp, double roughness) {
    const double variance = square(roughness);
    const double along = variance + double(lamp.spread_along);
    const double across = variance + double(lamp.spread_across);
    return std::exp(-0.5 * double(lamp.theta_r_squared) / along) * variance /
           std::sqrt(along * across);
}

Rgb direct_lobe_basis(const FitRow& row, double roughness) {
    Rgb sum = Rgb::Zero();
    for (const LampTerm& lamp : row.lamps) {
        sum += lamp.irradiance.cast<double>() *
               (double(lamp.lobe_cosines) * spread_gaussian(lamp, roughness));
    }
    return sum;
}

Rgb direct_lobe_basis_by_roughness(const FitRow& row, double roughness) {
    Rgb sum = Rgb::Zero();
    for (const LampTerm& lamp : row.lamps) {
        sum += lamp.irradiance.cast<double>() *
               (double(lamp.lobe_cosines) * spread_gaussian(lamp, roughness) *
                log_slope(lamp, roughness));
    }
    return sum;
}

Rgb lobe_basis(const FitRow& row, double roughness) {
    return direct_lobe_basis(row, roughness) + indirect_lobe_basis(row, roughness);
}

LobeBasis lobe_basis_and_slope(const FitRow& row, double roughness) {
    LobeBasis basis;
    for (const LampTerm& lamp : row.lamps) {
        const Rgb image = lamp.irradiance.cast<double>() *
                          (double(lamp.lobe_cosines) * spread_gaussian(lamp, roughness));
        basis.direct += image;
        basis.by_roughness += image * log_slope(lamp, roughness);
    }
    basis.whole = basis.direct + indirect_lobe_basis(row, roughness);
    return basis;
}

Rgb predict(const FitRow& row, const Reflectance& reflectance) {
    return (reflectance.diffuse * row.irradiance +
            reflectance.specular * lobe_basis(row, reflectance.roughness)) /
           kPi;
}

PixelClass classify_by_angle(const FitRow& row, const FitOptions& options) {
    if (row.theta_r > 3.5 * options.initial_roughness) return PixelClass::diffuse;
    return row.theta_r < 2.0 * options.initial_roughness ? PixelClass::specular
                                                         : PixelClass::neither;
}

PixelClass classify_by_share(const FitRow& row,
                             const Reflectance& present,
                             PixelClass previous,
                             const FitOptions& options) {
    const double lobe = present.specular * lobe_basis(row, present.roughness).mean();
    const double whole = (present.diffuse * row.irradiance).mean() + lobe;
    const double share = whole > 0 ? lobe / whole : 0;
    const double diffuse_limit =
        options.diffuse_share * (previous == PixelClass::diffuse ? 1.5 : 1.0);
    const double specular_limit =
        options.specular_share / (previous == PixelClass::specular ? 1.5 : 1.0);
    if (share < diffuse_limit) return PixelClass::diffuse;
    return share > specular_limit ? PixelClass::specular : PixelClass::neither;
}

Rgb fit_diffuse(std::span<const FitRow> rows,
                const Reflectance& present,
                const FitOptions& options) {
    const PixelClass source = diffuse_source(rows);
    Rgb numerator = Rgb::Zero();
    Rgb denominator = Rgb::Zero();
    Rgb noise = Rgb::Zero();
    for (const FitRow& row : rows) {
        if (row.pixel_class != source) continue;
        const bool subtract = !(options.literal && source == PixelClass::diffuse);
        const Rgb specular = subtract && present.specular > 0
                                 ? Rgb(present.specular * lobe_basis(row, present.roughness) / kPi)
                                 : Rgb(Rgb::Zero());
        numerator += row.weight * (row.radiance - specular) * row.irradiance;
        denominator += row.weight * row.irradiance.square();
        noise += row.weight * row.irradiance_variance;
    }
    const Rgb information = denominator - noise.min(kMaxNoiseShare * denominator);
    Rgb diffuse = Rgb::Zero();
    for (int channel = 0; channel < 3; ++channel) {
        if (information[channel] <= 0) continue;
        diffuse[channel] = std::max(0.0, kPi * numerator[channel] / information[channel]);
    }
    return diffuse;
}

SpecularFit fit_specular(std::span<const FitRow> rows,
                         const Rgb& diffuse,
                         const FitOptions& options) {
    const auto use = [&options](const FitRow& row) { return in_lobe(row, options); };
    if (std::none_of(rows.begin(), rows.end(), use)) return {};
    SpecularFit fit;
    fit.roughness = best_roughness(
        options, [&](double roughness) { return lobe_sums(rows, diffuse, roughness, use).cost(); });
    fit.specular = lobe_sums(rows, diffuse, fit.roughness, use).specular();
    fit.has_rows = true;
    return fit;
}

bool has_diffuse_row(std::span<const FitRow> rows) {
    return std::any_of(rows.begin(), rows.end(), [](const FitRow& row) {
        return row.pixel_class == PixelClass::diffuse;
    });
}

Reflectance fit_jointly(std::span<const FitRow> rows, const FitOptions& options) {
    Reflectance fit;
    fit.roughness = best_roughness(
        options, [&](double roughness) { return JointSums(rows, roughness).cost(); });
    const JointSums sums(rows, fit.roughness);
    fit.specular = sums.specular();
    fit.diffuse = sums.diffuse(fit.specular);
    return fit;
}

SpecularFit fit_specular_at(std::span<const FitRow> rows, const Rgb& diffuse, double roughness) {
    SpecularFit fit;
    const LobeSums sums = lobe_sums(rows, diffuse, roughness, [](const FitRow&) { return true; });
    fit.specular = sums.specular();
    fit.roughness = roughness;
    fit.has_rows = sums.basis_basis > 0;
    return fit;
}

FitErrors fit_errors(std::span<const FitRow> rows, const Reflectance& reflectance) {
    std::array<ChannelInformation, 3> channels;
    double squared = 0;
    for (const FitRow& row : rows) {
        const LobeBasis basis = lobe_basis_and_slope(row, reflectance.roughness);
        const Rgb h = std::numbers::inv_pi * row.irradiance;
        const Rgb b = std::numbers::inv_pi * basis.direct;
        const Rgb d = std::numbers::inv_pi * reflectance.specular * basis.by_roughness;
        const Rgb predicted =
            reflectance.diffuse * h + std::numbers::inv_pi * reflectance.specular * basis.whole;
        squared += (row.weight * (row.radiance - predicted).square()).sum();
        for (std::size_t c = 0; c < 3; ++c) {
            const auto i = static_cast<Eigen::Index>(c);
            ChannelInformation& sums = channels[c];
            sums.hh += row.weight[i] * h[i] * h[i];
            sums.hb += row.weight[i] * h[i] * b[i];
            sums.hd += row.weight[i] * h[i] * d[i];
            sums.bb += row.weight[i] * b[i] * b[i];
            sums.bd += row.weight[i] * b[i] * d[i];
            sums.dd += row.weight[i] * d[i] * d[i];
        }
    }
    // Information on (Ps, sigma) once Pd is projected out.
    double bb = 0, bd = 0, dd = 0;
    for (const ChannelInformation& sums : channels) {
        const double inverse = sums.hh > 0 ? 1 / sums.hh : 0;
        bb += sums.bb - sums.hb * sums.hb * inverse;
        bd += sums.bd - sums.hb * sums.hd * inverse;
        dd += sums.dd - sums.hd * sums.hd * inverse;
    }
    const double determinant = bb * dd - bd * bd;
    const bool lobe_unknown = !(bb > 0) || !(dd > 0) || !(determinant > 1e-12 * bb * dd);
    FitErrors errors;
    errors.lobe_information << bb, bd, bd, dd;
    errors.specular_sigma_known = bb > 0 ? 1 / std::sqrt(bb) : kInfinity;
    errors.specular = lobe_unknown ? kInfinity : std::sqrt(dd / determinant);
    errors.roughness = lobe_unknown ? kInfinity : std::sqrt(bb / determinant);
    for (std::size_t c = 0; c < 3; ++c) {
        const auto i = static_cast<Eigen::Index>(c);
        const ChannelInformation& sums = channels[c];
        const double own = sums.hh > 0 ? 1 / sums.hh : kInfinity;
        double lobe = 0;
        if (!lobe_unknown && sums.hh > 0) {
            lobe = (sums.hb * sums.hb * dd - 2 * sums.hb * sums.hd * bd + sums.hd * sums.hd * bb) /
                   (determinant * sums.hh * sums.hh);
        } else if (bb > 0 && sums.hh > 0) {
            lobe = sums.hb * sums.hb / (bb * sums.hh * sums.hh);
        }
        errors.diffuse[i] = std::sqrt(own + lobe);
        errors.diffuse_lobe_known[i] = std::sqrt(own);
    }
    const double freedom = 3.0 * double(rows.size()) - 5.0;
    errors.misfit = freedom > 0 ? squared / freedom : 1.0;
    return errors;
}

}  // namespace patina
