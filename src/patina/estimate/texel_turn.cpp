#include "patina/estimate/texel_turn.h"

#include "patina/base/parallel.h"
#include "patina/estimate/informed_lobe.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {
namespace {

// Nor is a lobe measured whose width is not: what it fills around it would be as wide as it
// pleases.
constexpr double kRoughnessRelativeError = 0.2;
constexpr double kStayMeasured = 1.5;
// Stray lobes come in clumps whose texels confirm each other; from the rims inwards few of them
// last. So many turns of that, and the fewest texels that a clump of lobes may have then.
constexpr int kConfirmations = 32;
constexpr std::size_t kSmallestClump = 9;
// Specular albedos of neighbours that confirm each other lie within this factor.
constexpr double kLikeAlbedo = 2.0;
constexpr double kWidestShare = 0.8;  // of the widest sigma searched

// Looks without any residual still bear some noise, so that no information stays an infinite error
// [standard deviations].
constexpr double kSmallestScale = 1e-6;
// A lobe is shown when some lamp stands inside it; tails alone say too little of its height. One as
// wide as the search allows is not a lobe but shading that the diffuse part did not explain.
bool lobe_is_shown(std::span<const FitRow> rows, double roughness, const FitOptions& options) {
    if (roughness > kWidestShare * options.max_roughness) return false;
    return has_look_inside(rows, roughness);
}

// Standard error of Ps with sigma given; FitErrors::specular_sigma_known without the others.
double specular_error_at(std::span<const FitRow> rows, double roughness) {
    Rgb hh = Rgb::Zero(), hb = Rgb::Zero(), bb = Rgb::Zero();
    for (const FitRow& row : rows) {
        const Rgb h = row.irradiance / kPi;
        const Rgb b = direct_lobe_basis(row, roughness) / kPi;
        hh += row.weight * h * h;
        hb += row.weight * h * b;
        bb += row.weight * b * b;
    }
    const double information = (bb - (hh > 0).select(hb * hb / hh, 0.0)).sum();
    return information > 0 ? 1 / std::sqrt(information) : std::numeric_limits<double>::infinity();
}

// What texels confirm each other by, side by side in memory: Ps sigma^2 of a measured lobe, or one
// of these.
constexpr double kNotMeasured = 0.0;
constexpr double kMatte = -1.0;

double likeness_of(const TexelFit& fit) {
    if (!fit.specular_measured) return kNotMeasured;
    if (!fit.roughness_measured) return kMatte;
    return fit.reflectance.specular * square(fit.reflectance.roughness);
}

// Texels with a measured Ps that hang together.
std::vector<std::vector<TexelId>> measured_clumps(const TexelAtlas& atlas,
                                                  std::span<const double> likeness) {
    std::vector<std::vector<TexelId>> clumps;
    std::vector<std::uint8_t> found(likeness.size(), 0);
    const auto add = [&](TexelId texel) {
        if (found[texel] != 0 || likeness[texel] == kNotMeasured) return;
        found[texel] = 1;
        clumps.back().push_back(texel);
    };
    for (std::size_t i = 0; i < likeness.size(); ++i) {
        if (found[i] != 0 || likeness[i] == kNotMeasured) continue;
        clumps.emplace_back();
        add(TexelId(i));
        for (std::size_t next = 0; next < clumps.back().size(); ++next) {
            const TexelId texel = clumps.back()[next];
            for (std::uint32_t k = atlas.neighbor_begin[texel]; k < atlas.neighbor_begin[texel + 1];
                 ++k) {
                add(atlas.neighbors[k]);
            }
        }
    }
    return clumps;
}

// Whether a neighbour has measured a lobe like that of a texel.
bool confirms(double neighbor, double texel) {
    if (neighbor == kMatte || texel == kMatte) return neighbor == texel;
    return neighbor < kLikeAlbedo * texel && neighbor * kLikeAlbedo > texel;
}

// Measured texels that less than half of their neighbours confirm.
std::vector<std::uint8_t> without_majority(const TexelAtlas& atlas,
                                           std::span<const double> likeness) {
    std::vector<std::uint8_t> found(likeness.size(), 0);
    parallel_for(likeness.size(), [&](std::size_t i) {
        if (likeness[i] == kNotMeasured) return;
        const std::uint32_t begin = atlas.neighbor_begin[i];
        const std::uint32_t end = atlas.neighbor_begin[i + 1];
        std::uint32_t num_confirming = 0;
        for (std::uint32_t k = begin; k < end; ++k) {
            num_confirming += confirms(likeness[atlas.neighbors[k]], likeness[i]) ? 1 : 0;
        }
        found[i] = 2 * num_confirming < end - begin;
    });
    return found;
}

}  // namespace

double largest_specular_error(double specular) {
    return std::max(kSpecularRelativeError * specular, kSpecularAbsoluteError);
}

double largest_roughness_error(double roughness) { return kRoughnessRelativeError * roughness; }

bool has_look_inside(std::span<const FitRow> rows, double roughness, double reach) {
    return std::any_of(rows.begin(), rows.end(), [roughness, reach](const FitRow& row) {
        return row.theta_r < reach * roughness;
    });
}

double noise_scale_of(const TexelFit& fit, double noise_scale) {
    return std::max({noise_scale, std::sqrt(fit.misfit), kSmallestScale});
}

void judge_lobe(std::span<const FitRow> rows,
                double noise_scale,
                bool settled,
                const FitOptions& options,
                TexelFit& fit) {
    const FitErrors errors = fit_errors(rows, fit.reflectance);
    fit.misfit = errors.misfit;
    const double scale = noise_scale_of(fit, noise_scale);
    const auto holds = [settled](bool before, double error, double limit) {
        return before ? error < kStayMeasured * limit : !settled && error < limit;
    };
    const double ps = fit.reflectance.specular;
    const double limit = largest_specular_error(ps);
    const double detection = ps / kSpecularDetection;
    fit.roughness_measured =
        lobe_is_shown(rows, fit.reflectance.roughness, options) &&
        holds(fit.roughness_measured, scale * errors.specular, std::min(limit, detection)) &&
        holds(fit.roughness_measured,
              scale * errors.roughness,
              largest_roughness_error(fit.reflectance.roughness));
    // Not told from zero: measured, to be matte, if no lobe of ordinary width would have escaped.
    // The width found means nothing then; a wide one would be excluded by any look.
    const auto is_matte = [&] {
        const double roughness = std::min(fit.reflectance.roughness, options.initial_roughness);
        const double error = scale * specular_error_at(rows, roughness);
        return ps < kSpecularDetection * error &&
               holds(fit.specular_measured, error, kSpecularAbsoluteError);
    };
    fit.specular_measured = fit.roughness_measured || is_matte();
    fit.specular_error = scale * errors.specular;
    fit.roughness_error = scale * errors.roughness;
    fit.lobe_information.setZero();
    if (fit.roughness_measured) {
        const Eigen::Matrix2d by_lobe = by_log_lobe(fit.reflectance);
        fit.lobe_information =
            (by_lobe.transpose() * errors.lobe_information * by_lobe / square(scale)).cast<float>();
    }
}

TexelFit fit_texel(std::span<const FitRow> rows,
                   const Reflectance& present,
                   const TexelFit& previous,
                   double noise_scale,
                   bool settled,
                   const FitOptions& options) {
    TexelFit fit = previous;
    fit.observed = !rows.empty();
    if (rows.empty()) return fit;
    bool has_lobe = true;
    if (fit.joint) {
        fit.reflectance = fit_jointly(rows, options);
    } else {
        fit.reflectance.diffuse = fit_diffuse(rows, present, options);
        const SpecularFit lobe = fit_specular(rows, fit.reflectance.diffuse, options);
        fit.reflectance.specular = lobe.specular;
        fit.reflectance.roughness = lobe.has_rows ? lobe.roughness : present.roughness;
        has_lobe = lobe.has_rows;
    }
    if (has_lobe) {
        judge_lobe(rows, noise_scale, settled, options, fit);
    } else {
        fit.specular_measured = fit.roughness_measured = false;
    }
    // With a lobe that will be filled, Pd must fit that one and not the wild one found here.
    if (!fit.specular_measured) fit.reflectance.diffuse = fit_diffuse(rows, present, options);
    return fit;
}

MapChange& MapChange::operator+=(const MapChange& other) {
    moved += other.moved;
    size += other.size;
    num_clamped += other.num_clamped;
    return *this;
}

MapChange move_map(Reflectance& map, const Reflectance& next) {
    const Projection projection = project_to_feasible(next);
    const Reflectance& held = projection.reflectance;
    const double change_of_albedo =
        held.specular * square(held.roughness) - map.specular * square(map.roughness);
    MapChange change;
    change.moved = (held.diffuse - map.diffuse).square().sum() + square(change_of_albedo);
    change.size = held.diffuse.square().sum();
    change.num_clamped = projection.was_clamped ? 1 : 0;
    map = held;
    return change;
}

std::vector<std::uint8_t> drop_unconfirmed(const TexelAtlas& atlas, std::span<TexelFit> fits) {
    std::vector<std::uint8_t> dropped(fits.size(), 0);
    std::vector<double> likeness(fits.size());
    parallel_for(fits.size(), [&](std::size_t i) { likeness[i] = likeness_of(fits[i]); });
    const auto drop = [&](std::size_t i) {
        likeness[i] = kNotMeasured;
        fits[i].specular_measured = fits[i].roughness_measured = false;
        fits[i].lobe_information.setZero();
        dropped[i] = 1;
    };
    std::size_t num_dropped = 1;
    for (int pass = 0; pass < kConfirmations && num_dropped > 0; ++pass) {
        const std::vector<std::uint8_t> now = without_majority(atlas, likeness);
        num_dropped = 0;
        for (std::size_t i = 0; i < fits.size(); ++i) {
            if (now[i] == 0) continue;
            drop(i);
            ++num_dropped;
        }
    }
    for (const std::vector<TexelId>& clump : measured_clumps(atlas, likeness)) {
        if (clump.size() >= kSmallestClump) continue;
        for (const TexelId texel : clump) drop(texel);
    }
    return dropped;
}

}  // namespace patina
