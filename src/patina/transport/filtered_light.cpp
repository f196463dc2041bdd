#include "patina/transport/filtered_light.h"

#include "patina/base/parallel.h"

namespace patina {
namespace {

// The mean over the texels of one row of the filter, its weights aside.
double mean_over_row(const SurfaceFilter& filter,
                     const std::vector<double>& values,
                     std::size_t texel) {
    const std::size_t begin = filter.begin[texel];
    const std::size_t end = filter.begin[texel + 1];
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += values[filter.texel[k]];
    return end > begin ? sum / double(end - begin) : values[texel];
}

// By how much the filter raises the squared error of one texel, in expectation.
double raised_error(const LightHalves& before, const LightHalves& after) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const Lanes change = 0.5f * (after[0][c] + after[1][c] - before[0][c] - before[1][c]);
        const Lanes noise_before = before[0][c] - before[1][c];
        const Lanes noise_after = after[0][c] - after[1][c];
        sum += sum_of_lanes(change * change - 0.5f * noise_before * (noise_before - noise_after));
    }
    return sum;
}

}  // namespace

LightHalves filtered(const SurfaceFilter& filter,
                     const LargeVector<LightHalves>& light,
                     std::size_t texel) {
    LightHalves sums{};
    for (std::size_t k = filter.begin[texel]; k < filter.begin[texel + 1]; ++k) {
        const LightHalves& from = light[filter.texel[k]];
        for (std::size_t half = 0; half < 2; ++half) {
            for (std::size_t c = 0; c < 3; ++c) {
                sums[half][c] += filter.weight[k] * from[half][c];
            }
        }
    }
    for (std::array<Lanes, 3>& half : sums) {
        for (Lanes& channel : half) channel = channel < 0.0f ? Lanes{} : channel;
    }
    return sums;
}

std::vector<std::uint8_t> where_filter_gains(const SurfaceFilter& filter,
                                             const LargeVector<LightHalves>& light) {
    std::vector<double> raised(light.size());
    parallel_for(light.size(), [&](std::size_t i) {
        raised[i] = raised_error(light[i], filtered(filter, light, i));
    });
    std::vector<double> mean(light.size());
    parallel_for(mean.size(), [&](std::size_t i) { mean[i] = mean_over_row(filter, raised, i); });
    std::vector<std::uint8_t> gains(light.size());
    parallel_for(gains.size(),
                 [&](std::size_t i) { gains[i] = mean_over_row(filter, mean, i) < 0 ? 1 : 0; });
    return gains;
}

}  // namespace patina
