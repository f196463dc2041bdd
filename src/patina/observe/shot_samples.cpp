#include "patina/observe/shot_samples.h"

#include "patina/base/parallel.h"
#include "patina/observe/footprint.h"

namespace patina {
namespace {

Rgbf pixel_rgb(const Image& image, int x, int y) {
    const std::size_t i = image.index(x, y);
    return {image.data[i], image.data[i + 1], image.data[i + 2]};
}

TexelSample sample_pixel(const RadianceImage& image, const Vec2f& position) {
    const FootprintAxis x = footprint_axis(position.x(), image.radiance.width);
    const FootprintAxis y = footprint_axis(position.y(), image.radiance.height);
    TexelSample sample;
    sample.usable = true;
    for (int row = y.first; row <= y.last; ++row) {
        for (int column = x.first; column <= x.last; ++column) {
            const auto pixel =
                std::size_t(row) * std::size_t(image.radiance.width) + std::size_t(column);
            if (image.usable[pixel] == 0) return {};
            const float weight =
                (column == x.last && x.last != x.first ? x.weight_last : 1.0f - x.weight_last) *
                (row == y.last && y.last != y.first ? y.weight_last : 1.0f - y.weight_last);
            sample.radiance += weight * pixel_rgb(image.radiance, column, row);
            if (!image.variance.empty()) {
                sample.variance += weight * weight * pixel_rgb(image.variance, column, row);
            }
        }
    }
    return sample;
}

}  // namespace

LargeVector<TexelSample> sample_shot(const RadianceImage& image,
                                     const std::vector<TexelView>& views) {
    LargeVector<TexelSample> samples(views.size());
    parallel_for(views.size(), [&](std::size_t i) {
        if (views[i].state != ViewState::hidden) samples[i] = sample_pixel(image, views[i].pixel);
    });
    return samples;
}

std::vector<SampleGradient> sample_gradients(const RadianceImage& image,
                                             const std::vector<TexelView>& views) {
    std::vector<SampleGradient> gradients(views.size(), {Rgbf::Zero(), Rgbf::Zero()});
    parallel_for(views.size(), [&](std::size_t i) {
        if (views[i].state == ViewState::hidden) return;
        const std::array<Vec2f, 2> half_steps = {Vec2f(0.5f, 0), Vec2f(0, 0.5f)};
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const TexelSample before = sample_pixel(image, views[i].pixel - half_steps[axis]);
            const TexelSample after = sample_pixel(image, views[i].pixel + half_steps[axis]);
            if (!before.usable || !after.usable) continue;
            gradients[i][axis] = after.radiance - before.radiance;
        }
    });
    return gradients;
}

}  // namespace patina
