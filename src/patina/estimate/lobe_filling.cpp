#include "patina/estimate/lobe_filling.h"

#include "patina/base/parallel.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// A lobe known to this share counts fully when it fills others.
constexpr double kFullConfidenceError = 0.1;

float confidence_of(double error, double value) {
    const double share = error / std::max(value, 1e-12);
    return float(std::min(1.0, square(kFullConfidenceError / std::max(share, 1e-6))));
}

}  // namespace

LobeFilling::LobeFilling(const TexelAtlas& atlas)
    : atlas_(atlas),
      log_roughness_(atlas.texels.size(), std::log(kInitialRoughness)),
      specular_albedo_(atlas.texels.size(), 0.0),
      confidence_(atlas.texels.size(), 0.0f) {}

void LobeFilling::set_guide(std::span<const TexelFit> fits) {
    std::vector<Rgb> diffuse(fits.size());
    parallel_for(fits.size(), [&](std::size_t i) { diffuse[i] = fits[i].reflectance.diffuse; });
    fill_.emplace(atlas_, diffuse);
}

void LobeFilling::find_spread(std::span<const TexelFit> fits) {
    std::vector<Reflectance> maps(fits.size());
    std::vector<Reflectance> errors(fits.size());
    std::vector<std::uint8_t> measured(fits.size());
    parallel_for(fits.size(), [&](std::size_t i) {
        maps[i] = fits[i].reflectance;
        errors[i].specular = fits[i].specular_error;
        errors[i].roughness = fits[i].roughness_error;
        measured[i] = fits[i].observed && fits[i].roughness_measured;
    });
    spread_ = fill_errors(atlas_, maps, errors, measured);
}

void LobeFilling::fill_roughness(double tolerance, std::span<TexelFit> fits) {
    parallel_for(fits.size(), [&](std::size_t i) {
        const TexelFit& fit = fits[i];
        const bool known = fit.observed && fit.roughness_measured;
        confidence_[i] =
            known ? confidence_of(fit.roughness_error, fit.reflectance.roughness) : 0.0f;
        if (known) log_roughness_[i] = std::log(fit.reflectance.roughness);
    });
    fill_->fill(confidence_, std::log(kInitialRoughness), log_roughness_, tolerance);
    parallel_for(fits.size(), [&](std::size_t i) {
        if (confidence_[i] > 0) return;
        fits[i].reflectance.roughness =
            std::clamp(std::exp(log_roughness_[i]), kMinRoughness, kMaxRoughness);
    });
}

void LobeFilling::fill_specular(double tolerance, double fallback, std::span<TexelFit> fits) {
    parallel_for(fits.size(), [&](std::size_t i) {
        const TexelFit& fit = fits[i];
        const bool known = fit.observed && fit.specular_measured;
        confidence_[i] = !known ? 0.0f
                         : fit.roughness_measured
                             ? confidence_of(fit.specular_error, fit.reflectance.specular)
                             : 1.0f;
        const Reflectance& lobe = fit.reflectance;
        if (known) specular_albedo_[i] = lobe.specular * square(lobe.roughness);
    });
    fill_->fill(confidence_, fallback, specular_albedo_, tolerance);
    parallel_for(fits.size(), [&](std::size_t i) {
        if (confidence_[i] > 0) return;
        Reflectance& lobe = fits[i].reflectance;
        lobe.specular = std::max(0.0, specular_albedo_[i]) / square(lobe.roughness);
    });
}

LogLobe LobeFilling::lobe(std::size_t texel) const {
    return {std::log(specular_albedo_[texel]), log_roughness_[texel]};
}

}  // namespace patina
