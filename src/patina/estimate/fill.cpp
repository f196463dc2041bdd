#include "patina/estimate/fill.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/math/statistics.h"

namespace patina {
namespace {

// The measured texel met last while walking along a line.
struct LastMeasured {
    double value = 0;
    double distance = -1;  // [texels]; negative: none yet
};

struct FillSums {
    double value = 0;
    double weight = 0;
};

// Walks along one line of cells and adds what was met last to every texel that is not measured.
// cell(k): index of the k-th cell. length: cells of the line; a line that goes around is walked
// twice.
template <typename Cell>
void walk(const TexelAtlas& atlas,
          std::span<const std::uint8_t> measured,
          std::span<const double> values,
          int length,
          bool goes_around,
          const Cell& cell,
          std::vector<FillSums>& sums) {
    LastMeasured last;
    std::uint32_t chart = 0;
    const int num_steps = goes_around ? 2 * length : length;
    for (int step = 0; step < num_steps; ++step) {
        const TexelId id = atlas.cell_texel[cell(step % length)];
        if (last.distance >= 0) last.distance += 1;
        if (id == kNoTexel) continue;
        if (atlas.texels[id].chart != chart) last = {};
        chart = atlas.texels[id].chart;
        if (measured[id] != 0) {
            last = {values[id], 0};
        } else if (last.distance > 0 && step >= num_steps - length) {
            sums[id].value += last.value / last.distance;
            sums[id].weight += 1 / last.distance;
        }
    }
}

}  // namespace

void interpolate_linearly(const TexelAtlas& atlas,
                          std::span<const std::uint8_t> measured,
                          double fallback,
                          std::span<double> values) {
    PATINA_CHECK_EQ(measured.size(), atlas.texels.size());
    PATINA_CHECK_EQ(values.size(), atlas.texels.size());
    std::vector<double> known;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (measured[i] != 0) known.push_back(values[i]);
    }
    const double middle = known.empty() ? fallback : median(std::move(known));
    std::vector<FillSums> sums(values.size());
    const int width = atlas.width;
    const int height = atlas.height;
    const auto index = [width](int x, int y) {
        return std::size_t(y) * std::size_t(width) + std::size_t(x);
    };
    parallel_for(std::size_t(height), [&](std::size_t row) {
        const int y = int(row);
        const bool around = atlas.wraps_around;
        walk(
            atlas, measured, values, width, around, [&](int k) { return index(k, y); }, sums);
        walk(
            atlas,
            measured,
            values,
            width,
            around,
            [&](int k) { return index(width - 1 - k, y); },
            sums);
    });
    parallel_for(std::size_t(width), [&](std::size_t column) {
        const int x = int(column);
        walk(
            atlas, measured, values, height, false, [&](int k) { return index(x, k); }, sums);
        walk(
            atlas,
            measured,
            values,
            height,
            false,
            [&](int k) { return index(x, height - 1 - k); },
            sums);
    });
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (measured[i] != 0) continue;
        values[i] = sums[i].weight > 0 ? sums[i].value / sums[i].weight : middle;
    }
}

}  // namespace patina
