#include "patina/transport/filtered_light.h"

#include "patina/base/parallel.h"

#include <utility>

namespace patina {
namespace {

// The error of one texel tells little; it is averaged over the filter's texels so many times.
constexpr int kPasses = 3;

static_assert(kLanes <= 8, "a LampMask has eight bits");

// The mean over the texels of one row of the filter, its weights aside.
Lanes mean_over_row(const SurfaceFilter& filter,
                    const LargeVector<Lanes>& values,
                    std::size_t texel) {
    const std::size_t begin = filter.begin[texel];
    const std::size_t end = filter.begin[texel + 1];
    Lanes sum{};
    for (std::size_t k = begin; k < end; ++k) sum += values[filter.texel[k]];
    return sum / float(end - begin);
}

// By how much the filter raises the squared error of one texel, in expectation.
Lanes raised_error(const LightHalves& before, const LightHalves& after) {
    Lanes sum{};
    for (std::size_t c = 0; c < 3; ++c) {
        const Lanes change = 0.5f * (after[0][c] + after[1][c] - before[0][c] - before[1][c]);
        const Lanes noise_before = before[0][c] - before[1][c];
        const Lanes noise_after = after[0][c] - after[1][c];
        sum += change * change - 0.5f * noise_before * (noise_before - noise_after);
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

std::vector<LampMask> where_filter_gains(const SurfaceFilter& filter,
                                         const LargeVector<LightHalves>& light) {
    LargeVector<Lanes> raised(light.size());
    parallel_for(light.size(), [&](std::size_t i) {
        raised[i] = raised_error(light[i], filtered(filter, light, i));
    });
    LargeVector<Lanes> mean(light.size());
    for (int pass = 0; pass < kPasses; ++pass) {
        parallel_for(mean.size(),
                     [&](std::size_t i) { mean[i] = mean_over_row(filter, raised, i); });
        std::swap(mean, raised);
    }
    std::vector<LampMask> gains(light.size(), 0);
    parallel_for(gains.size(), [&](std::size_t i) {
        for (std::size_t l = 0; l < kLanes; ++l) {
            if (raised[i][l] < 0) gains[i] = LampMask(gains[i] | 1u << l);
        }
    });
    return gains;
}

LightHalves filtered_for(LampMask lamps,
                         const SurfaceFilter& filter,
                         const LargeVector<LightHalves>& light,
                         std::size_t texel) {
    if (lamps == 0) return light[texel];
    LightHalves result = filtered(filter, light, texel);
    for (std::size_t half = 0; half < 2; ++half) {
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t l = 0; l < kLanes; ++l) {
                if ((lamps >> l & 1u) == 0) result[half][c][l] = light[texel][half][c][l];
            }
        }
    }
    return result;
}

}  // namespace patina
