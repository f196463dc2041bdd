#include "patina/estimate/guided_fill.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <unordered_map>

namespace patina {
namespace {

// Colours this far apart count as different materials: a quarter in brightness, 0.02 in
// chromaticity.
constexpr double kBrightnessScale = 0.25;
constexpr double kChromaScale = 0.02;
constexpr double kSmallestAlbedo = 1e-3;
// Normals of neighbours that differ by so much lie across an edge [rad].
constexpr double kNormalScale = 0.3;
constexpr float kWeakestLink = 1e-3f;
// e: values fade to the trend over about so many texels.
constexpr double kReach = 60.0;
// Known texels that the trend is made of, at most, and how many of them count as nothing new.
constexpr std::size_t kMaxSamples = 2000;
constexpr double kPriorCount = 2.0;
// Means over all samples that a thread takes at once.
constexpr std::size_t kSampleGrain = 8;

struct Sample {
    Vec3 color = Vec3::Zero();
    double value = 0;
    double weight = 0;
};

// Mean of the samples of a like colour, drawn towards `prior` where there are few.
double kernel_mean(std::span<const Sample> samples, const Vec3& color, double prior) {
    double weight = kPriorCount;
    double sum = kPriorCount * prior;
    for (const Sample& sample : samples) {
        const double distance = (sample.color - color).squaredNorm();
        if (distance > 9) continue;
        const double w = sample.weight * std::exp(-0.5 * distance);
        weight += w;
        sum += w * sample.value;
    }
    return sum / weight;
}

// How much of the samples' variance their colour explains: every second sample predicted from the
// others [0 to 1].
double explained_share(std::span<const Sample> samples, double mean) {
    std::array<std::vector<Sample>, 2> sets;
    for (std::size_t i = 0; i < samples.size(); ++i) sets[i % 2].push_back(samples[i]);
    std::vector<double> predicted(sets[1].size());
    const auto predict = [&](std::size_t i) {
        predicted[i] = kernel_mean(sets[0], sets[1][i].color, mean);
    };
    parallel_for(predicted.size(), predict, kSampleGrain);
    double before = 0;
    double after = 0;
    for (std::size_t i = 0; i < predicted.size(); ++i) {
        const Sample& sample = sets[1][i];
        before += sample.weight * square(sample.value - mean);
        after += sample.weight * square(sample.value - predicted[i]);
    }
    return before > 0 ? std::clamp(1 - after / before, 0.0, 1.0) : 0.0;
}

bool has_known(std::span<const float> confidence) {
    return std::any_of(confidence.begin(), confidence.end(), [](float c) { return c > 0; });
}

using Cell = std::array<int, 3>;

Cell cell_of(const Vec3& color) {
    Cell cell;
    for (std::size_t c = 0; c < 3; ++c) cell[c] = int(std::floor(2 * color[Eigen::Index(c)]));
    return cell;
}

Vec3 middle_of(const Cell& cell) {
    return {0.5 * (cell[0] + 0.5), 0.5 * (cell[1] + 0.5), 0.5 * (cell[2] + 0.5)};
}

// Cells of one key lie 2^21 apart: colours reach less than 200 from 0.
std::uint64_t cell_key(const Cell& cell) {
    std::uint64_t key = 0;
    for (const int c : cell) key = key << 21 | (std::uint64_t(c) & 0x1fffff);
    return key;
}

}  // namespace

GuidedFill::GuidedFill(const TexelAtlas& atlas, std::span<const Rgb> diffuse)
    : atlas_(atlas),
      color_(atlas.texels.size()),
      cell_(atlas.texels.size()),
      link_(atlas.neighbors.size()) {
    PATINA_CHECK_EQ(diffuse.size(), atlas.texels.size());
    parallel_for(color_.size(), [&](std::size_t i) {
        const Rgb albedo = diffuse[i].max(kSmallestAlbedo);
        const double sum = albedo.sum();
        color_[i] = Vec3(std::log(sum / 3) / kBrightnessScale,
                         albedo[0] / sum / kChromaScale,
                         albedo[1] / sum / kChromaScale);
    });
    parallel_for(color_.size(), [&](std::size_t i) {
        for (std::uint32_t k = atlas.neighbor_begin[i]; k < atlas.neighbor_begin[i + 1]; ++k) {
            const TexelId j = atlas.neighbors[k];
            const double bend =
                (atlas.texels[i].point.normal - atlas.texels[j].point.normal).squaredNorm() /
                square(kNormalScale);
            const double differs = (color_[i] - color_[j]).squaredNorm();
            link_[k] = std::max(kWeakestLink, float(std::exp(-0.5 * (bend + differs))));
        }
    });
    find_cells();
}

// Colours on a grid finer than the kernel of the trend are looked up once.
void GuidedFill::find_cells() {
    std::vector<std::uint64_t> keys(color_.size());
    parallel_for(keys.size(), [&](std::size_t i) { keys[i] = cell_key(cell_of(color_[i])); });
    std::unordered_map<std::uint64_t, std::uint32_t> number_of_cell;
    std::uint64_t last_key = 0;
    std::uint32_t last_number = 0;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (i == 0 || keys[i] != last_key) {
            const auto [found, is_new] =
                number_of_cell.try_emplace(keys[i], std::uint32_t(cell_middle_.size()));
            if (is_new) cell_middle_.push_back(middle_of(cell_of(color_[i])));
            last_key = keys[i];
            last_number = found->second;
        }
        cell_[i] = last_number;
    }
}

std::vector<double> GuidedFill::trend(std::span<const float> confidence,
                                      std::span<const double> values) const {
    std::vector<std::size_t> known;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (confidence[i] > 0) known.push_back(i);
    }
    const std::size_t stride = (known.size() + kMaxSamples - 1) / kMaxSamples;
    std::vector<Sample> samples;
    double weight = 0;
    double sum = 0;
    for (std::size_t k = stride / 2; k < known.size(); k += stride) {
        const std::size_t i = known[k];
        samples.push_back({color_[i], values[i], double(confidence[i])});
        weight += samples.back().weight;
        sum += samples.back().weight * samples.back().value;
    }
    const double mean = sum / weight;
    const double share = explained_share(samples, mean);
    std::vector<double> result(values.size(), mean);
    if (share <= 0) return result;
    std::vector<double> trend_of_cell(cell_middle_.size());
    const auto find_trend = [&](std::size_t cell) {
        trend_of_cell[cell] =
            mean + share * (kernel_mean(samples, cell_middle_[cell], mean) - mean);
    };
    parallel_for(trend_of_cell.size(), find_trend, kSampleGrain);
    parallel_for(result.size(), [&](std::size_t i) { result[i] = trend_of_cell[cell_[i]]; });
    return result;
}

std::vector<double> GuidedFill::above_trend(std::span<const float> confidence,
                                            std::span<const double> values) const {
    std::vector<double> above(values.size(), 0.0);
    if (!has_known(confidence)) return above;
    const std::vector<double> expected = trend(confidence, values);
    parallel_for(above.size(), [&](std::size_t i) {
        if (confidence[i] > 0) above[i] = values[i] - expected[i];
    });
    return above;
}

void GuidedFill::fill(std::span<const float> confidence,
                      double fallback,
                      std::span<double> values,
                      double tolerance) const {
    PATINA_CHECK_EQ(confidence.size(), values.size());
    PATINA_CHECK_EQ(values.size(), atlas_.texels.size());
    if (!has_known(confidence)) {
        std::fill(values.begin(), values.end(), fallback);
        return;
    }
    LinkEquation equation;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!(confidence[i] > 0)) equation.unknown.push_back(TexelId(i));
    }
    if (equation.unknown.empty()) return;
    const std::vector<double> expected = trend(confidence, values);
    equation.diagonal.resize(equation.unknown.size());
    equation.right.resize(equation.unknown.size());
    parallel_for(equation.unknown.size(), [&](std::size_t row) {
        const TexelId i = equation.unknown[row];
        double diagonal = 1 / square(kReach);
        double right = 0;
        for (std::uint32_t k = atlas_.neighbor_begin[i]; k < atlas_.neighbor_begin[i + 1]; ++k) {
            const TexelId j = atlas_.neighbors[k];
            const bool is_known = confidence[j] > 0;
            const double weight = double(link_[k]) * (is_known ? double(confidence[j]) : 1.0);
            diagonal += weight;
            if (is_known) right += weight * (values[j] - expected[j]);
        }
        equation.diagonal[row] = diagonal;
        equation.right[row] = right;
    });
    std::vector<double> above(values.size());
    parallel_for(values.size(), [&](std::size_t i) { above[i] = values[i] - expected[i]; });
    LinkSolverOptions options;
    options.tolerance = tolerance;
    solve_links(atlas_, link_, equation, options, above);
    for (const TexelId i : equation.unknown) values[i] = expected[i] + above[i];
}

}  // namespace patina
