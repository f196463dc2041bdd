#include "map_pictures.h"

#include "patina/export/colormap.h"
#include "patina/export/picture.h"
#include "patina/image/image.h"
#include "patina/math/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

constexpr int kMaxMapWidth = 200;  // [pixels]
constexpr int kBarWidth = 10;      // [pixels]
constexpr int kBarGap = 6;         // between map and bar [pixels]
constexpr double kRangeShare = 0.98;
constexpr double kMaxRatio = 1.5;

using Color = std::function<Rgb(double)>;

MaskedImage map_image(const TexelAtlas& atlas,
                      const std::function<bool(TexelId)>& counts,
                      const std::function<double(TexelId)>& value) {
    MaskedImage map{Image(atlas.width, atlas.height, 1), {}};
    map.mask.resize(map.image.data.size(), 0);
    for (std::size_t i = 0; i < map.mask.size(); ++i) {
        const TexelId texel = atlas.cell_texel[i];
        if (texel == kNoTexel || !counts(texel)) continue;
        map.mask[i] = 1;
        map.image.data[i] = float(value(texel));
    }
    return map;
}

// bar_value(t): value that the bar shows at the share t of its height from below.
void write_with_bar(const std::filesystem::path& path,
                    const Image& map,
                    const Color& color,
                    const std::function<double(double)>& bar_value) {
    Image picture(map.width + kBarGap + kBarWidth, map.height, 3, 1.0f);
    for (int y = 0; y < picture.height; ++y) {
        const Rgb bar = color(bar_value(1 - (y + 0.5) / picture.height));
        for (int channel = 0; channel < 3; ++channel) {
            for (int x = 0; x < map.width; ++x) {
                picture.at(x, y, channel) = map.at(x, y, channel);
            }
            for (int x = map.width + kBarGap; x < picture.width; ++x) {
                picture.at(x, y, channel) = float(bar[channel]);
            }
        }
    }
    write_png(path, picture);
}

// Rounded up to one digit: 0.0371 becomes 0.04.
double rounded_up(double value) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)));
    return unit * std::ceil(value / unit);
}

}  // namespace

ColorRange range_from_zero(const TexelAtlas& atlas,
                           const std::function<bool(TexelId)>& counts,
                           const std::function<double(TexelId)>& value) {
    std::vector<double> values;
    for (TexelId texel = 0; texel < atlas.texels.size(); ++texel) {
        if (counts(texel)) values.push_back(value(texel));
    }
    const double top = values.empty() ? 0 : quantile(std::move(values), kRangeShare);
    const double high = top > 0 ? rounded_up(top) : 1;
    return {0, high, fmt::format("0 to {:.3g}", high)};
}

void write_map_picture(const std::filesystem::path& path,
                       const TexelAtlas& atlas,
                       const ColorRange& range,
                       const std::function<bool(TexelId)>& counts,
                       const std::function<double(TexelId)>& value) {
    const double width = range.high - range.low;
    const Color color = [&](double v) { return sequential_color((v - range.low) / width); };
    const MaskedImage map = reduce(map_image(atlas, counts, value), kMaxMapWidth);
    write_with_bar(
        path, colored_image(map, color), color, [&](double t) { return range.low + t * width; });
}

ColorRange ratio_range() {
    return {1 / kMaxRatio, kMaxRatio, fmt::format("{:.2f} to {:.2f}", 1 / kMaxRatio, kMaxRatio)};
}

void write_ratio_picture(const std::filesystem::path& path,
                         const TexelAtlas& atlas,
                         const std::function<bool(TexelId)>& counts,
                         const std::function<double(TexelId)>& ratio) {
    const double limit = std::log(kMaxRatio);
    const Color color = [&](double logarithm) { return diverging_color(logarithm / limit); };
    const auto logarithm = [&](TexelId texel) {
        return std::clamp(std::log(ratio(texel)), -limit, limit);
    };
    const MaskedImage map = reduce(map_image(atlas, counts, logarithm), kMaxMapWidth);
    write_with_bar(
        path, colored_image(map, color), color, [&](double t) { return (2 * t - 1) * limit; });
}

void write_status_picture(const std::filesystem::path& path,
                          const TexelAtlas& atlas,
                          const Estimate& estimate) {
    const Color color = [](double status) { return status_color(int(std::lround(status))); };
    const MaskedImage map = map_image(
        atlas,
        [](TexelId) { return true; },
        [&](TexelId texel) { return double(estimate.status[texel]); });
    const Image labels = reduce_labels(map.image, kMaxMapWidth);
    write_with_bar(path, colored_image({labels, {}}, color), color, [](double t) {
        return 3.0 - std::floor(std::min(3 * t, 2.0));
    });
}

}  // namespace patina
