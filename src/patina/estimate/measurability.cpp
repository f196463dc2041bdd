#include "patina/estimate/measurability.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// What is left of the information on Ps once Pd is unknown counts as none below this share of it:
// roundings of a difference.
constexpr double kNoInformation = 1e-12;

// Information that the looks carry on Pd and Ps, sigma given, per channel.
struct LobeInformation {
    Rgb diffuse = Rgb::Zero();   // on Pd
    Rgb crossed = Rgb::Zero();   // of Pd and Ps
    Rgb specular = Rgb::Zero();  // on Ps
    double at_peak = 0;          // on Ps, of the best look if it lay in the mirror direction

    LobeInformation(std::span<const FitRow> rows, double roughness) {
        for (const FitRow& row : rows) {
            const Rgb h = row.irradiance / kPi;
            const Rgb b = direct_lobe_basis(row, roughness) / kPi;
            diffuse += row.weight * h * h;
            crossed += row.weight * h * b;
            specular += row.weight * b * b;
            for (LampTerm lamp : row.lamps) {
                lamp.theta_r_squared = 0;
                const Rgb peak = lamp.irradiance.cast<double>() * double(lamp.lobe_cosines) *
                                 spread_gaussian(lamp, roughness) / kPi;
                at_peak = std::max(at_peak, (row.weight * peak * peak).sum());
            }
        }
    }

    // On Ps with Pd unknown.
    [[nodiscard]] double specular_alone() const {
        const Rgb taken = (diffuse > 0).select(crossed * crossed / diffuse, 0.0);
        const double left = (specular - taken).sum();
        return left > kNoInformation * specular.sum() ? left : 0;
    }
};

double error_of(double information) {
    return information > 0 ? 1 / std::sqrt(information) : kInfinity;
}

LobeReason largest_cause(const LobeShortfall& shortfall) {
    const double sigma_given = shortfall.noise * shortfall.off_lobe * shortfall.diffuse;
    if (sigma_given <= 1) {
        return sigma_given * shortfall.width > 1 ? LobeReason::few_angles : LobeReason::unconfirmed;
    }
    struct Cause {
        LobeReason reason;
        double factor;
    };
    // Of equal ones the first: the one to mend first.
    const std::array<Cause, 3> causes = {{{LobeReason::no_lamp_in_lobe, shortfall.off_lobe},
                                          {LobeReason::narrow_baseline, shortfall.diffuse},
                                          {LobeReason::noise, shortfall.noise}}};
    return std::max_element(causes.begin(),
                            causes.end(),
                            [](const Cause& a, const Cause& b) { return a.factor < b.factor; })
        ->reason;
}

}  // namespace

ExpectedErrors expected_errors(std::span<const FitRow> rows,
                               const Reflectance& map,
                               double noise_scale) {
    ExpectedErrors errors;
    const LobeInformation information(rows, map.roughness);
    // Relative to what the mark is relative to, which for a faint lobe is more than its Ps.
    errors.specular = noise_scale * error_of(information.specular_alone()) *
                      kSpecularRelativeError / largest_specular_error(map.specular);
    errors.roughness = noise_scale * fit_errors(rows, map).roughness / map.roughness;
    if (!(information.diffuse > 0).all() || !(map.diffuse.mean() > 0)) return errors;
    // No lobe sends out more light than it receives: what is known of Ps before any look.
    const double prior = square(max_lobe_albedo(map.roughness) / kMaxAlbedo);
    const double specular = information.specular_alone() / square(noise_scale) + prior;
    const Rgb variance = square(noise_scale) / information.diffuse +
                         (information.crossed / information.diffuse).square() / specular;
    errors.diffuse = std::sqrt(variance.mean()) / map.diffuse.mean();
    return errors;
}

LobeShortfall lobe_shortfall(std::span<const FitRow> rows,
                             const Reflectance& map,
                             double noise_scale) {
    const double mark = largest_specular_error(map.specular);
    const LobeInformation information(rows, map.roughness);
    const double all_known = error_of(information.specular.sum());
    const double diffuse_unknown = error_of(information.specular_alone());
    LobeShortfall shortfall;
    shortfall.noise = noise_scale * error_of(information.at_peak) / mark;
    if (!std::isfinite(all_known)) {
        shortfall.off_lobe = kInfinity;
        return shortfall;
    }
    shortfall.off_lobe = all_known / error_of(information.at_peak);
    shortfall.diffuse = diffuse_unknown / all_known;
    if (!std::isfinite(diffuse_unknown)) return shortfall;
    if (map.specular < kSpecularDetection * noise_scale * diffuse_unknown) return shortfall;
    const FitErrors errors = fit_errors(rows, map);
    shortfall.width = std::max(errors.specular / mark,
                               errors.roughness / largest_roughness_error(map.roughness)) /
                      (diffuse_unknown / mark);
    return shortfall;
}

TexelMeasurability texel_measurability(std::span<const FitRow> rows,
                                       const Reflectance& map,
                                       const TexelFit& fit,
                                       double noise_scale) {
    TexelMeasurability result;
    if (!fit.observed) return result;
    const double scale = noise_scale_of(fit, noise_scale);
    result.errors = expected_errors(rows, map, scale);
    if (fit.roughness_measured) {
        result.reason = LobeReason::measured;
    } else if (fit.specular_measured) {
        result.reason = LobeReason::matte;
    } else if (!has_look_inside(rows, map.roughness)) {
        // Tails alone never count, however little noise they bear.
        result.reason = LobeReason::no_lamp_in_lobe;
    } else {
        result.reason = largest_cause(lobe_shortfall(rows, map, scale));
    }
    return result;
}

}  // namespace patina
