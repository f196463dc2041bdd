// `patina compare`: how well maps explain the photographs, the held-out ones too, and how far they
// are from the truth where it is known.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/capture.h"
#include "patina/capture/json.h"
#include "patina/capture/result_folder.h"
#include "patina/pipeline/options.h"
#include "patina/pipeline/prediction_check.h"
#include "patina/pipeline/shot_renderer.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patina {

// By default the 99th percentile of the used images is level 230 of 255.
inline constexpr double kWhiteShare = 0.99;
inline constexpr double kWhiteLevel = 230;
inline constexpr double kMaxLevel = 255;

struct CompareOptions {
    ShotRenderOptions render;
    // Held-out shots get this many times as many paths, spent where the noise is; >= 1.
    int heldout_sample_factor = 1;
    bool keep_heldout = false;       // leave the images of held-out shots in the result
    std::optional<double> white;     // radiance of level 255 [radiance]; nothing: as said above
    std::filesystem::path pictures;  // folder for real, synthetic and difference; empty: none
};
[[nodiscard]] OptionTable compare_option_table(CompareOptions& options);

// Synthetic against real over pixels of status 1 and 2 and their channels.
struct ImageComparison {
    double levels_mean = 0;      // of |difference| [8-bit levels]
    double levels_variance = 0;  // of |difference| [8-bit levels^2]
    double relative_rmse = 0;    // root of summed squared differences over summed squared image [-]
    std::size_t num_pixels = 0;
    // What the paths' noise adds to the squared differences, where the images tell (held-out ones
    // of 128 paths per pixel and more); an unbiased estimate.
    struct RenderNoise {
        double variance = 0;  // mean over pixels and channels [8-bit levels^2]
        double share = 0;     // of the mean squared difference [-]
    };
    std::optional<RenderNoise> noise;
};

// A map against the truth.
struct MapComparison {
    double mean_relative_error = 0;             // mean(estimate - truth) / mean(truth) [-]
    double median_absolute_relative_error = 0;  // of |estimate - truth| / truth where truth > 0 [-]
    double rmse = 0;                            // [-]; of roughness [rad]
    double coverage68 = 0;                      // share of truth inside the interval [-]
    double coverage95 = 0;
    double error_rank_correlation = 0;  // Spearman's, of standard errors and |estimate - truth| [-]
    std::size_t num_texels = 0;
};

// Lobes against the Cramer-Rao bound at the truth, for the noise that the fit found
// (lobe_bounds()).
struct BoundComparison {
    std::size_t num_measurable = 0;  // texels whose bound calls the lobe measurable
    double measured_share = 0;       // of them, those of status 1 [-]
    // Median over texels of status 1 of |estimate - truth| over its median for an unbiased estimate
    // with normal errors that reaches the bound [-]: 1 is the best there is.
    double specular_ratio = 0;
    double roughness_ratio = 0;
};

// One shot, real and rendered [radiance], and which of its pixels count.
struct ShotPair {
    Image real;
    Image synthetic;
    std::vector<std::uint8_t> status;  // TexelStatus::measured or diffuse_measured; 0: leave it out
    Image lobe_variance;               // of synthetic [radiance^2]; empty for used shots
    Image noise_variance;              // of synthetic [radiance^2]; empty where it is not known
};

struct ShotComparison {
    std::size_t shot = 0;
    std::string image;
    bool heldout = false;
    ImageComparison difference;
    std::optional<ShotPair> images;  // of held-out shots, on request
};

struct Comparison {
    std::string name;  // of the capture
    double white = 0;  // radiance of level 255 [radiance]
    std::vector<ShotComparison> per_shot;
    std::optional<ImageComparison> shots;  // the used ones; nothing where no pixel counts
    std::optional<ImageComparison> heldout;
    // The held-out shots against the spread of the used ones and the errors of lobes; nothing
    // without both.
    std::optional<PredictionCheck> prediction;
    struct Truth {
        std::optional<MapComparison> diffuse;    // over texels of status 1 and 2, three channels
        std::optional<MapComparison> specular;   // over texels of status 1
        std::optional<MapComparison> roughness;  // over texels of status 1
        std::optional<BoundComparison> bound;    // by compare_result() alone
    };
    std::optional<Truth> truth;
};

// Throws Error, WorkFailed, Interrupted.
[[nodiscard]] Comparison compare_result(const std::filesystem::path& capture_path,
                                        const std::filesystem::path& result_path,
                                        const CompareOptions& options,
                                        Progress& progress);
// The same for what is in memory. result_place: for errors.
[[nodiscard]] Comparison compare_maps(const Capture& capture,
                                      const ReflectanceMaps& maps,
                                      const std::string& result_place,
                                      const CompareOptions& options,
                                      Progress& progress);

// With the names of docs/capture.md.
[[nodiscard]] Json comparison_json(const Comparison& comparison);
[[nodiscard]] std::string comparison_text(const Comparison& comparison);

}  // namespace patina
