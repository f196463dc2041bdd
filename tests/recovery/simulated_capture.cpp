#include "simulated_capture.h"

#include <utility>

namespace patina {

SimulatedCapture::SimulatedCapture(ObjectKind kind,
                                   const std::vector<std::size_t>& lamps,
                                   const ScanOptions& options) {
    Progress progress;
    const SimulatedObject object = make_object(kind, options.columns, options.rows);
    simulate_capture(object, lamps, options, progress, folder_.path());
    capture_ = load_capture(folder_.path());
    truth_ = load_truth(capture_.description);
}

Estimate SimulatedCapture::estimate(const EstimateOptions& options) const {
    Progress progress;
    return estimate_reflectance(capture_, options, progress);
}

std::vector<double> SimulatedCapture::row_errors(const Estimate& estimate, int channel) const {
    const TexelAtlas& atlas = capture_.atlas;
    std::vector<double> sums(std::size_t(atlas.height), 0.0);
    std::vector<double> counts(sums.size(), 0.0);
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        const auto [column, row] = std::pair(atlas.texels[i].column, atlas.texels[i].row);
        if (4 * column < atlas.width || 4 * column >= 3 * atlas.width) continue;
        const double truth = double(truth_.diffuse.at(column, row, channel));
        sums[std::size_t(row)] += estimate.maps[i].diffuse[channel] / truth - 1;
        counts[std::size_t(row)] += 1;
    }
    for (std::size_t row = 0; row < sums.size(); ++row) sums[row] /= counts[row];
    return sums;
}

}  // namespace patina
