#include "patina/pipeline/compare_result.h"

#include "patina/base/output_file.h"
#include "patina/export/picture.h"
#include "patina/math/statistics.h"
#include "patina/pipeline/pictures.h"
#include "patina/pipeline/truth_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace patina {
namespace {

namespace fs = std::filesystem;

// Sums over pixels and channels, in radiance: levels follow once white is known.
struct DifferenceSums {
    double count = 0;
    double absolute = 0;  // of |synthetic - real|
    double squared = 0;   // of (synthetic - real)^2
    double image = 0;     // of real^2
    double noise = 0;     // of the variance of synthetic by its paths
    bool has_noise = false;
    std::size_t num_pixels = 0;

    DifferenceSums& operator+=(const DifferenceSums& other) {
        count += other.count;
        absolute += other.absolute;
        squared += other.squared;
        image += other.image;
        noise += other.noise;
        has_noise = has_noise || other.has_noise;
        num_pixels += other.num_pixels;
        return *this;
    }

    [[nodiscard]] std::optional<ImageComparison> result(double white) const {
        if (num_pixels == 0) return std::nullopt;
        const double levels = kMaxLevel / white;
        const double mean = absolute / count;
        ImageComparison comparison;
        comparison.levels_mean = levels * mean;
        comparison.levels_variance = square(levels) * std::max(0.0, squared / count - square(mean));
        comparison.relative_rmse = image > 0 ? std::sqrt(squared / image) : 0;
        comparison.num_pixels = num_pixels;
        if (has_noise) {
            comparison.noise = {square(levels) * noise / count, squared > 0 ? noise / squared : 0};
        }
        return comparison;
    }
};

bool is_measured(std::uint8_t status) {
    const auto texel = TexelStatus(status);
    return texel == TexelStatus::measured || texel == TexelStatus::diffuse_measured;
}

ShotRenderOptions render_options(const CompareOptions& options, const Shot& shot) {
    ShotRenderOptions render = options.render;
    if (shot.heldout) render.samples_per_pixel *= options.heldout_sample_factor;
    render.with_lobe_errors = shot.heldout;
    render.adaptive = shot.heldout;
    return render;
}

ShotPair make_pair(const Capture& capture,
                   const ShotRenderer& renderer,
                   std::size_t shot,
                   const ShotRenderOptions& options,
                   Progress& progress) {
    RenderedShot rendered = renderer.render(shot, options, progress);
    RadianceImage image = load_radiance(capture.description, shot);
    ShotPair pair{std::move(image.radiance),
                  std::move(rendered.radiance),
                  std::move(rendered.status),
                  std::move(rendered.lobe_variance),
                  std::move(rendered.noise_variance)};
    for (std::size_t i = 0; i < pair.status.size(); ++i) {
        if (image.usable[i] == 0 || !is_measured(pair.status[i])) pair.status[i] = 0;
    }
    return pair;
}

// One channel of a pixel that counts.
struct Value {
    double real = 0;        // [radiance]
    double synthetic = 0;   // [radiance]
    bool has_lobe = false;  // its Ps was measured
    std::size_t index = 0;  // into the images' data
};

// Calls use(Value) for every channel of every pixel that counts, in order.
template <typename Use>
void for_each_value(const ShotPair& pair, const Use& use) {
    for (std::size_t i = 0; i < pair.status.size(); ++i) {
        if (pair.status[i] == 0) continue;
        const bool has_lobe = TexelStatus(pair.status[i]) == TexelStatus::measured;
        for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
            use(Value{double(pair.real.data[k]), double(pair.synthetic.data[k]), has_lobe, k});
        }
    }
}

DifferenceSums difference_of(const ShotPair& pair) {
    DifferenceSums sums;
    sums.has_noise = !pair.noise_variance.empty();
    for_each_value(pair, [&](const Value& value) {
        const double difference = value.synthetic - value.real;
        sums.count += 1;
        sums.absolute += std::abs(difference);
        sums.squared += square(difference);
        sums.image += square(value.real);
        if (sums.has_noise) sums.noise += double(pair.noise_variance.data[value.index]);
    });
    for (const std::uint8_t status : pair.status) sums.num_pixels += status != 0 ? 1 : 0;
    return sums;
}

// Looks at a pixel's surface: one per used shot of the same camera.
double used_looks(const CaptureDescription& description, std::size_t camera) {
    double looks = 0;
    for (const Shot& shot : description.shots) looks += !shot.heldout && shot.camera == camera;
    return looks;
}

// Radiance of level 255 such that `values` have their 99th percentile at level 230.
double default_white(std::vector<double> values) {
    if (values.empty()) return 1;
    const double bright = quantile(std::move(values), kWhiteShare);
    return bright > 0 ? bright * kMaxLevel / kWhiteLevel : 1;
}

void write_pictures(const fs::path& folder,
                    const std::string& name,
                    const ShotPair& pair,
                    double white) {
    write_png(folder / (name + "_real.png"), display_image({pair.real, {}}, white));
    write_png(folder / (name + "_synthetic.png"), display_image({pair.synthetic, {}}, white));
    write_png(folder / (name + "_difference.png"),
              difference_picture(pair.real, pair.synthetic, pair.status, white));
}

}  // namespace

OptionTable compare_option_table(CompareOptions& options) {
    return {
        integer_option("samples",
                       options.render.samples_per_pixel,
                       between(1, 1 << 20),
                       "paths for each pixel of the synthetic images"),
        integer_option("heldout_samples",
                       options.heldout_sample_factor,
                       between(1, 1024),
                       "the synthetic images of held-out shots have this many times as many, "
                       "more where they are noisy"),
        number_option("white",
                      options.white,
                      above(0),
                      "",
                      "99th percentile of the used images is level 230",
                      "radiance of level 255"),
        with_letter(path_option("output",
                                "DIR",
                                options.pictures,
                                "write real, synthetic and difference pictures there"),
                    "o"),
    };
}

Comparison compare_maps(const Capture& capture,
                        const ReflectanceMaps& maps,
                        const std::string& result_place,
                        const CompareOptions& options,
                        Progress& progress) {
    const ShotRenderer renderer(capture, maps, result_place);
    const std::vector<Shot>& shots = capture.description.shots;
    std::uint64_t num_paths = 0;
    for (std::size_t i = 0; i < shots.size(); ++i) {
        num_paths += renderer.num_paths(i, render_options(options, shots[i]));
    }
    progress.begin_stage("render shots", num_paths, "paths");
    std::optional<OutputFolder> folder;
    if (!options.pictures.empty()) folder.emplace(options.pictures, "-o");
    std::vector<DifferenceSums> sums(shots.size());
    std::vector<std::optional<ShotPair>> pairs(shots.size());
    std::vector<double> used_values;
    std::array<ResidualNoise, 2> noise;  // where Ps was filled, and where it was measured
    PredictionSums prediction;
    // The used ones first: they say what the others may differ by.
    std::vector<std::size_t> order(shots.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_partition(
        order.begin(), order.end(), [&](std::size_t i) { return !shots[i].heldout; });
    for (const std::size_t i : order) {
        ShotPair pair =
            make_pair(capture, renderer, i, render_options(options, shots[i]), progress);
        sums[i] = difference_of(pair);
        if (shots[i].heldout) {
            const double looks = used_looks(capture.description, shots[i].camera);
            for_each_value(pair, [&](const Value& value) {
                const double variance = noise[value.has_lobe].variance(
                                            value.synthetic, fitted_share(looks, value.has_lobe)) +
                                        double(pair.lobe_variance.data[value.index]);
                if (variance > 0) prediction.add(value.real - value.synthetic, variance);
            });
        } else {
            for_each_value(pair, [&](const Value& value) {
                used_values.push_back(value.real);
                noise[value.has_lobe].add(value.synthetic, value.real - value.synthetic);
            });
        }
        const bool is_wanted = folder || (options.keep_heldout && shots[i].heldout);
        if (is_wanted) pairs[i] = std::move(pair);
    }
    progress.end_stage(fmt::format("{} shots", shots.size()));

    Comparison comparison;
    comparison.name = capture.description.name;
    comparison.white = options.white ? *options.white : default_white(std::move(used_values));
    DifferenceSums used;
    DifferenceSums heldout;
    for (std::size_t i = 0; i < shots.size(); ++i) {
        (shots[i].heldout ? heldout : used) += sums[i];
        if (folder) {
            write_pictures(
                folder->path(), fmt::format("shot{:03}", i), *pairs[i], comparison.white);
        }
        ShotComparison shot;
        shot.shot = i;
        shot.image = shots[i].image;
        shot.heldout = shots[i].heldout;
        shot.difference = sums[i].result(comparison.white).value_or(ImageComparison{});
        if (options.keep_heldout && shots[i].heldout) shot.images = std::move(pairs[i]);
        comparison.per_shot.push_back(std::move(shot));
    }
    comparison.shots = used.result(comparison.white);
    comparison.heldout = heldout.result(comparison.white);
    comparison.prediction = prediction.result();
    if (capture.description.truth) {
        comparison.truth = compare_with_truth(maps, load_truth(capture.description));
    }
    if (folder) folder->commit();
    return comparison;
}

Comparison compare_result(const fs::path& capture_path,
                          const fs::path& result_path,
                          const CompareOptions& options,
                          Progress& progress) {
    progress.begin_stage("read capture and result");
    Capture capture = load_capture(capture_path);
    const Result result = read_result(result_path);
    multiply_lamps(result.lamp_factor, capture.description);
    progress.end_stage();
    Comparison comparison =
        compare_maps(capture, result.maps, result_path.string(), options, progress);
    if (comparison.truth) {
        comparison.truth->bound = compare_with_bound(
            capture, result.maps, load_truth(capture.description), result.noise, progress);
    }
    return comparison;
}

}  // namespace patina
