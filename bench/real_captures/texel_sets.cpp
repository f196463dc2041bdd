#include "texel_sets.h"

#include "patina/math/statistics.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// For each of `count` cells, `stride` apart: whether it and all within `margin` of it are set;
// cells beyond the ends are not.
void erode_line(std::vector<std::uint8_t>& cells,
                std::size_t begin,
                std::size_t stride,
                int count,
                int margin) {
    // How many cells in a row are set, up to and including this one.
    std::vector<int> run(std::size_t(count), 0);
    for (int k = 0; k < count; ++k) {
        const bool is_set = cells[begin + std::size_t(k) * stride] != 0;
        run[std::size_t(k)] = is_set ? 1 + (k > 0 ? run[std::size_t(k) - 1] : 0) : 0;
    }
    for (int k = 0; k < count; ++k) {
        const int end = k + margin;
        const bool stays = end < count && run[std::size_t(end)] >= 2 * margin + 1;
        cells[begin + std::size_t(k) * stride] = stays ? 1 : 0;
    }
}

}  // namespace

TexelSet inner_texels(const TexelAtlas& atlas, std::span<const std::uint8_t> seen, int margin) {
    const auto width = std::size_t(atlas.width);
    const auto height = std::size_t(atlas.height);
    std::vector<std::uint8_t> cells(width * height, 0);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const TexelId texel = atlas.cell_texel[i];
        cells[i] = texel != kNoTexel ? seen[texel] : 0;
    }
    for (std::size_t y = 0; y < height; ++y) erode_line(cells, y * width, 1, atlas.width, margin);
    for (std::size_t x = 0; x < width; ++x) erode_line(cells, x, width, atlas.height, margin);
    TexelSet texels;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (cells[i] != 0) texels.push_back(atlas.cell_texel[i]);
    }
    return texels;
}

TexelSet select(const TexelSet& texels, const std::function<bool(TexelId)>& holds) {
    TexelSet selected;
    std::copy_if(texels.begin(), texels.end(), std::back_inserter(selected), holds);
    return selected;
}

Spread spread_of(const TexelSet& texels, const std::function<double(TexelId)>& value) {
    std::vector<double> values;
    values.reserve(texels.size());
    for (const TexelId texel : texels) values.push_back(value(texel));
    const Moments sums = moments(values);
    std::sort(values.begin(), values.end());
    Spread spread;
    spread.count = values.size();
    spread.median = median(values);
    spread.low = quantile(values, normal_cdf(-1));
    spread.high = quantile(values, normal_cdf(1));
    spread.coefficient_of_variation = std::sqrt(sums.variance) / sums.mean;
    spread.p95_over_p50 = quantile(std::move(values), 0.95) / spread.median;
    return spread;
}

}  // namespace patina
