#include "patina/pipeline/prediction_check.h"

#include "patina/math/types.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

constexpr double kDarkest = 1e-4;  // radiance of the first bin
constexpr double kBinsPerOctave = 2;

}  // namespace

std::size_t ResidualNoise::bin_of(double synthetic) {
    const double octaves = std::log2(std::max(synthetic, kDarkest) / kDarkest);
    return std::size_t(std::clamp(int(kBinsPerOctave * octaves), 0, kBins - 1));
}

void ResidualNoise::add(double synthetic, double residual) {
    squares_[bin_of(synthetic)] += square(residual);
    counts_[bin_of(synthetic)] += 1;
}

double ResidualNoise::variance(double synthetic, double factor) const {
    const auto bin = std::ptrdiff_t(bin_of(synthetic));
    for (std::ptrdiff_t distance = 0; distance < kBins; ++distance) {
        for (const std::ptrdiff_t near : {bin - distance, bin + distance}) {
            if (near < 0 || near >= kBins || counts_[std::size_t(near)] == 0) continue;
            return factor * squares_[std::size_t(near)] / counts_[std::size_t(near)];
        }
    }
    return 0;
}

void PredictionSums::add(double residual, double variance) {
    const double z = std::abs(residual) / std::sqrt(variance);
    squares_ += square(z);
    narrow_ += z <= 1;
    wide_ += z <= 1.96;
    count_ += 1;
}

std::optional<PredictionCheck> PredictionSums::result() const {
    if (count_ == 0) return std::nullopt;
    return PredictionCheck{squares_ / count_, narrow_ / count_, wide_ / count_};
}

double fitted_share(double looks, bool with_lobe) {
    const double parameters = with_lobe ? 1 + 2.0 / 3 : 1;
    return looks > parameters + 1 ? looks / (looks - parameters) : 1;
}

}  // namespace patina
