#include "patina/estimate/fit_rows.h"

#include <numbers>

namespace patina {
namespace {

// Keeps weights finite for captures that are noise-free to the last bit [radiance^2].
constexpr double kSmallestVariance = 1e-16;

}  // namespace

void FitRowMaker::make(std::size_t texel,
                       const IndirectLight& light,
                       const Reflectance& map,
                       std::vector<FitRow>& rows) const {
    const double inverse = 1 / lamp_factor_;
    rows.clear();
    for (const Observation& look : observations_.of(texel)) {
        FitRow& row = rows.emplace_back();
        row.radiance = inverse * look.radiance.cast<double>();
        row.lamps = observations_.lamps(look);
        row.theta_r = double(look.theta_r);
        for (const LampTerm& lamp : row.lamps) row.irradiance += lamp.irradiance.cast<double>();
        Rgb variance = square(inverse) * look.variance.cast<double>();
        if (!light.irradiance.empty()) {
            const IndirectIrradiance& indirect =
                light.irradiance.of(texel)[scene_.lamp_set_of_shot[look.shot]];
            row.irradiance += indirect.mean();
            row.irradiance_variance = indirect.variance();
            variance += (std::numbers::inv_pi * map.diffuse).square() * row.irradiance_variance;
        }
        if (!light.lobe.empty()) row.indirect_lobe = light.lobe.of(texel)[look.shot];
        row.indirect_roughness = map.roughness;
        row.weight = 1 / variance.max(kSmallestVariance);
    }
}

void FitRowMaker::expect(std::size_t texel, const IndirectLight& light) const {
    for (const Observation& look : observations_.of(texel)) {
        if (!light.irradiance.empty()) {
            __builtin_prefetch(&light.irradiance.of(texel)[scene_.lamp_set_of_shot[look.shot]]);
        }
        if (!light.lobe.empty()) __builtin_prefetch(&light.lobe.of(texel)[look.shot]);
    }
}

}  // namespace patina
