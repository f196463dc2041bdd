#include "patina/estimate/finish.h"

#include "patina/base/parallel.h"

#include <limits>

namespace patina {
namespace {

void finish_texel(const std::vector<FitRow>& rows,
                  const TexelFit& fit,
                  std::size_t texel,
                  Estimate& estimate) {
    Reflectance& error = estimate.errors[texel];
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    error.diffuse = Rgb::Constant(kInfinity);
    error.specular = kInfinity;
    error.roughness = kInfinity;
    if (rows.empty()) return;
    const FitErrors errors = fit_errors(rows, estimate.maps[texel]);
    const double scale = std::max(estimate.noise_scale, std::sqrt(errors.misfit));
    if (fit.roughness_measured) {
        error.diffuse = scale * errors.diffuse;
        error.specular = scale * errors.specular;
        error.roughness = scale * errors.roughness;
    } else {
        error.diffuse = scale * errors.diffuse_lobe_known;
        if (fit.specular_measured) error.specular = scale * errors.specular_sigma_known;
    }
    estimate.status[texel] =
        fit.specular_measured ? TexelStatus::measured : TexelStatus::diffuse_measured;
    double direct = 0;
    double whole = 0;
    for (const FitRow& row : rows) {
        for (const LampTerm& lamp : row.lamps) direct += double(lamp.irradiance.mean());
        whole += row.irradiance.mean();
    }
    if (direct > 0) estimate.indirect_over_direct[texel] = float(whole / direct - 1);
}

}  // namespace

void finish_estimate(const FitRowMaker& maker,
                     const Observations& observations,
                     const IndirectLight& light,
                     std::span<const TexelFit> fits,
                     std::span<const float> robust,
                     Estimate& estimate) {
    const std::size_t num_texels = estimate.maps.size();
    estimate.errors.resize(num_texels);
    estimate.status.assign(num_texels, TexelStatus::filled);
    estimate.indirect_over_direct.assign(num_texels, 0.0f);
    parallel_blocks(num_texels, 256, [&](std::size_t begin, std::size_t end) {
        std::vector<FitRow> rows;
        for (std::size_t i = begin; i < end; ++i) {
            maker.make(i, light, estimate.maps[i], rows);
            for (std::size_t k = 0; k < rows.size() && !robust.empty(); ++k) {
                rows[k].weight *= double(robust[observations.begin[i] + k]);
            }
            finish_texel(rows, fits[i], i, estimate);
        }
    });
}

}  // namespace patina
