#include "patina/estimate/lobe_filling.h"

#include "patina/base/parallel.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// A lobe known to this share counts fully when it fills others.
constexpr double kFullConfidenceError = 0.1;

// Lobes that depart from others by more times their root mean square fill nothing.
constexpr double kStray = 3.0;
// What a texel that was measured to be matte counts as then, of the mean lobe.
constexpr double kMatteShare = 0.1;

bool measures_specular(const TexelFit& fit) { return fit.observed && fit.specular_measured; }
bool measures_roughness(const TexelFit& fit) { return fit.observed && fit.roughness_measured; }

double specular_albedo(const TexelFit& fit) {
    return fit.reflectance.specular * square(fit.reflectance.roughness);
}

float confidence_of(double error, double value) {
    const double share = error / std::max(value, 1e-12);
    return float(std::min(1.0, square(kFullConfidenceError / std::max(share, 1e-6))));
}

}  // namespace

LobeFilling::LobeFilling(const TexelAtlas& atlas)
    : atlas_(atlas),
      stray_(atlas.texels.size(), 0),
      log_roughness_(atlas.texels.size(), std::log(kInitialRoughness)),
      specular_albedo_(atlas.texels.size(), 0.0),
      confidence_(atlas.texels.size(), 0.0f) {}

void LobeFilling::set_guide(std::span<const TexelFit> fits) {
    std::vector<Rgb> diffuse(fits.size());
    parallel_for(fits.size(), [&](std::size_t i) { diffuse[i] = fits[i].reflectance.diffuse; });
    fill_.emplace(atlas_, diffuse);
    find_strays(fits);
}

void LobeFilling::find_strays(std::span<const TexelFit> fits) {
    double sum = 0;
    double count = 0;
    for (const TexelFit& fit : fits) {
        if (!measures_roughness(fit)) continue;
        sum += specular_albedo(fit);
        count += 1;
    }
    std::fill(stray_.begin(), stray_.end(), std::uint8_t{0});
    if (!(sum > 0)) return;
    const double least = kMatteShare * sum / count;
    const auto mark = [&](const auto& is_known, const auto& value_of) {
        std::vector<float> known(fits.size());
        std::vector<double> values(fits.size());
        parallel_for(fits.size(), [&](std::size_t i) {
            known[i] = is_known(fits[i]) ? 1.0f : 0.0f;
            values[i] = is_known(fits[i]) ? value_of(fits[i]) : 0.0;
        });
        const std::vector<double> above = fill_->above_trend(known, values);
        double squares = 0;
        double num_known = 0;
        for (std::size_t i = 0; i < above.size(); ++i) {
            squares += square(above[i]);
            num_known += double(known[i]);
        }
        const double limit = kStray * std::sqrt(squares / num_known);
        for (std::size_t i = 0; i < above.size(); ++i) {
            if (std::abs(above[i]) > limit) stray_[i] = 1;
        }
    };
    mark(measures_specular,
         [&](const TexelFit& fit) { return std::log(std::max(specular_albedo(fit), least)); });
    mark(measures_roughness,
         [](const TexelFit& fit) { return std::log(fit.reflectance.roughness); });
}

bool LobeFilling::fills(std::span<const TexelFit> fits, std::size_t texel) const {
    return measures_specular(fits[texel]) && stray_[texel] == 0;
}

void LobeFilling::find_spread(std::span<const TexelFit> fits) {
    std::vector<Reflectance> maps(fits.size());
    std::vector<Reflectance> errors(fits.size());
    std::vector<std::uint8_t> measured(fits.size());
    parallel_for(fits.size(), [&](std::size_t i) {
        maps[i] = fits[i].reflectance;
        errors[i].specular = fits[i].specular_error;
        errors[i].roughness = fits[i].roughness_error;
        measured[i] = fills(fits, i) && fits[i].roughness_measured;
    });
    spread_ = fill_errors(atlas_, maps, errors, measured);
}

void LobeFilling::fill_roughness(double tolerance, std::span<TexelFit> fits) {
    parallel_for(fits.size(), [&](std::size_t i) {
        const TexelFit& fit = fits[i];
        const bool known = fills(fits, i) && fit.roughness_measured;
        confidence_[i] =
            known ? confidence_of(fit.roughness_error, fit.reflectance.roughness) : 0.0f;
        if (known) log_roughness_[i] = std::log(fit.reflectance.roughness);
    });
    fill_->fill(confidence_, std::log(kInitialRoughness), log_roughness_, tolerance);
    parallel_for(fits.size(), [&](std::size_t i) {
        if (measures_roughness(fits[i])) return;
        fits[i].reflectance.roughness =
            std::clamp(std::exp(log_roughness_[i]), kMinRoughness, kMaxRoughness);
    });
}

void LobeFilling::fill_specular(double tolerance, double fallback, std::span<TexelFit> fits) {
    parallel_for(fits.size(), [&](std::size_t i) {
        const TexelFit& fit = fits[i];
        const bool known = fills(fits, i);
        confidence_[i] = !known ? 0.0f
                         : fit.roughness_measured
                             ? confidence_of(fit.specular_error, fit.reflectance.specular)
                             : 1.0f;
        if (known) specular_albedo_[i] = specular_albedo(fit);
    });
    fill_->fill(confidence_, fallback, specular_albedo_, tolerance);
    parallel_for(fits.size(), [&](std::size_t i) {
        if (measures_specular(fits[i])) return;
        Reflectance& lobe = fits[i].reflectance;
        lobe.specular = std::max(0.0, specular_albedo_[i]) / square(lobe.roughness);
    });
}

LogLobe LobeFilling::lobe(std::size_t texel) const {
    return {std::log(specular_albedo_[texel]), log_roughness_[texel]};
}

}  // namespace patina
