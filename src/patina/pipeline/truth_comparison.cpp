#include "patina/pipeline/truth_comparison.h"

#include "patina/estimate/lobe_bounds.h"
#include "patina/math/statistics.h"
#include "patina/math/types.h"

#include <cmath>
#include <span>

namespace patina {
namespace {

constexpr double kNarrowInterval = 0.68;
constexpr double kWideInterval = 0.95;

// Half width of the interval of that probability, in standard errors.
double half_width(double probability) { return normal_quantile(0.5 * (1 + probability)); }

// One map, its standard error, the truth; the same number of channels each.
struct MapsOfOne {
    const Image& estimate;
    const Image& standard_error;
    const Image& truth;
};

class TruthSums {
  public:
    void add(double estimate, double standard_error, double truth) {
        const double error = estimate - truth;
        ++count_;
        error_ += error;
        squared_error_ += square(error);
        truth_ += truth;
        if (truth > 0) relative_.push_back(std::abs(error) / truth);
        if (std::isfinite(standard_error)) {
            predicted_.push_back(standard_error);
            made_.push_back(std::abs(error));
        }
        if (std::abs(error) <= half_width(kNarrowInterval) * standard_error) ++num_narrow_;
        if (std::abs(error) <= half_width(kWideInterval) * standard_error) ++num_wide_;
    }

    [[nodiscard]] std::optional<MapComparison> result(std::size_t num_texels) const {
        if (count_ == 0) return std::nullopt;
        const auto count = double(count_);
        MapComparison comparison;
        comparison.mean_relative_error = truth_ != 0 ? error_ / truth_ : 0;
        comparison.median_absolute_relative_error = relative_.empty() ? 0 : median(relative_);
        comparison.rmse = std::sqrt(squared_error_ / count);
        comparison.coverage68 = double(num_narrow_) / count;
        comparison.coverage95 = double(num_wide_) / count;
        comparison.error_rank_correlation = rank_correlation(predicted_, made_);
        comparison.num_texels = num_texels;
        return comparison;
    }

  private:
    std::size_t count_ = 0;
    std::size_t num_narrow_ = 0;
    std::size_t num_wide_ = 0;
    double error_ = 0;
    double squared_error_ = 0;
    double truth_ = 0;
    std::vector<double> relative_;
    std::vector<double> predicted_;  // standard errors, finite ones
    std::vector<double> made_;       // the errors' sizes beside them
};

std::optional<MapComparison> compare_map(const MapsOfOne& maps,
                                         const Image& status,
                                         const Image& mask,
                                         bool diffuse_suffices) {
    TruthSums sums;
    std::size_t num_texels = 0;
    for (int y = 0; y < status.height; ++y) {
        for (int x = 0; x < status.width; ++x) {
            const auto texel = TexelStatus(int(status.at(x, y)));
            const bool counts = texel == TexelStatus::measured ||
                                (diffuse_suffices && texel == TexelStatus::diffuse_measured);
            if (!counts || (!mask.empty() && mask.at(x, y) == 0)) continue;
            ++num_texels;
            for (int channel = 0; channel < maps.estimate.channels; ++channel) {
                sums.add(double(maps.estimate.at(x, y, channel)),
                         double(maps.standard_error.at(x, y, channel)),
                         double(maps.truth.at(x, y, channel)));
            }
        }
    }
    return sums.result(num_texels);
}

}  // namespace

Comparison::Truth compare_with_truth(const ReflectanceMaps& maps, const TruthMaps& truth) {
    const auto compare = [&](const Image& estimate,
                             const Image& standard_error,
                             const Image& true_map,
                             bool diffuse_suffices) {
        return compare_map(
            {estimate, standard_error, true_map}, maps.status, truth.mask, diffuse_suffices);
    };
    return {compare(maps.diffuse, maps.diffuse_stderr, truth.diffuse, true),
            compare(maps.specular, maps.specular_stderr, truth.specular, false),
            compare(maps.roughness, maps.roughness_stderr, truth.roughness, false),
            std::nullopt};
}

std::optional<BoundComparison> compare_with_bound(const Capture& capture,
                                                  const ReflectanceMaps& maps,
                                                  const TruthMaps& truth,
                                                  const FitNoise& noise,
                                                  Progress& progress) {
    const std::span<const Texel> texels = capture.atlas.texels;
    std::vector<Reflectance> reflectance(texels.size());
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const int x = texels[i].column;
        const int y = texels[i].row;
        reflectance[i] = {{double(truth.diffuse.at(x, y, 0)),
                           double(truth.diffuse.at(x, y, 1)),
                           double(truth.diffuse.at(x, y, 2))},
                          double(truth.specular.at(x, y)),
                          std::max(double(truth.roughness.at(x, y)), kMinRoughness)};
    }
    const std::vector<LobeBound> bounds = lobe_bounds(capture, reflectance, noise, progress);
    std::size_t num_measured = 0;
    BoundComparison comparison;
    std::vector<double> specular;
    std::vector<double> roughness;
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const int x = texels[i].column;
        const int y = texels[i].row;
        if (!truth.mask.empty() && truth.mask.at(x, y) == 0) continue;
        const LobeBound& bound = bounds[i];
        const bool is_measured = TexelStatus(int(maps.status.at(x, y))) == TexelStatus::measured;
        comparison.num_measurable += bound.measurable ? 1 : 0;
        num_measured += bound.measurable && is_measured ? 1 : 0;
        if (!is_measured || !(bound.specular > 0) || !std::isfinite(bound.specular)) continue;
        const auto ratio = [](double estimate, double true_value, double deviation) {
            return std::abs(estimate - true_value) / (half_width(0.5) * deviation);
        };
        specular.push_back(
            ratio(double(maps.specular.at(x, y)), reflectance[i].specular, bound.specular));
        roughness.push_back(
            ratio(double(maps.roughness.at(x, y)), reflectance[i].roughness, bound.roughness));
    }
    if (specular.empty() || comparison.num_measurable == 0) return std::nullopt;
    comparison.measured_share = double(num_measured) / double(comparison.num_measurable);
    comparison.specular_ratio = median(std::move(specular));
    comparison.roughness_ratio = median(std::move(roughness));
    return comparison;
}

}  // namespace patina
