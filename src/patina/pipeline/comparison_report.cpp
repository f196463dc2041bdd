#include "patina/pipeline/compare_result.h"
#include "patina/pipeline/text_table.h"

#include <fmt/format.h>

namespace patina {
namespace {

Json image_json(const ImageComparison& comparison) {
    Json json = Json::object();
    json.set("levels_mean", Json(comparison.levels_mean));
    json.set("levels_variance", Json(comparison.levels_variance));
    json.set("relative_rmse", Json(comparison.relative_rmse));
    json.set("pixels", Json(std::int64_t(comparison.num_pixels)));
    if (comparison.noise) {
        json.set("render_noise_variance", Json(comparison.noise->variance));
        json.set("render_noise_share", Json(comparison.noise->share));
    }
    return json;
}

Json truth_json(const MapComparison& comparison) {
    Json json = Json::object();
    json.set("mean_relative_error", Json(comparison.mean_relative_error));
    json.set("median_absolute_relative_error", Json(comparison.median_absolute_relative_error));
    json.set("rmse", Json(comparison.rmse));
    json.set("coverage68", Json(comparison.coverage68));
    json.set("coverage95", Json(comparison.coverage95));
    json.set("error_rank_correlation", Json(comparison.error_rank_correlation));
    json.set("texels", Json(std::int64_t(comparison.num_texels)));
    return json;
}

Json bound_json(const BoundComparison& comparison) {
    Json json = Json::object();
    json.set("measurable", Json(std::int64_t(comparison.num_measurable)));
    json.set("measured_share", Json(comparison.measured_share));
    json.set("specular_error_over_bound", Json(comparison.specular_ratio));
    json.set("roughness_error_over_bound", Json(comparison.roughness_ratio));
    return json;
}

void add_row(TextTable& table, const std::string& name, const ImageComparison& comparison) {
    table.add({name,
               fmt::format("{:.3f}", comparison.levels_mean),
               fmt::format("{:.3f}", comparison.levels_variance),
               fmt::format("{:.4f}", comparison.relative_rmse),
               fmt::format("{}", comparison.num_pixels)});
}

void add_row(TextTable& table,
             const std::string& name,
             const std::optional<MapComparison>& comparison) {
    if (!comparison) return;
    table.add({name,
               fmt::format("{:+.2f} %", 100 * comparison->mean_relative_error),
               fmt::format("{:.2f} %", 100 * comparison->median_absolute_relative_error),
               fmt::format("{:.4f}", comparison->rmse),
               fmt::format("{:.1f} %", 100 * comparison->coverage68),
               fmt::format("{:.1f} %", 100 * comparison->coverage95),
               fmt::format("{:.2f}", comparison->error_rank_correlation),
               fmt::format("{}", comparison->num_texels)});
}

}  // namespace

Json comparison_json(const Comparison& comparison) {
    Json json = Json::object();
    json.set("name", Json(comparison.name));
    json.set("white", Json(comparison.white));
    if (comparison.shots) json.set("shots", image_json(*comparison.shots));
    if (comparison.heldout) {
        Json heldout = image_json(*comparison.heldout);
        if (const auto& check = comparison.prediction) {
            heldout.set("reduced_chi_square", Json(check->reduced_chi_square));
            heldout.set("coverage68", Json(check->coverage68));
            heldout.set("coverage95", Json(check->coverage95));
        }
        json.set("heldout", std::move(heldout));
    }
    if (comparison.truth) {
        Json truth = Json::object();
        const auto add = [&](const char* name, const std::optional<MapComparison>& map) {
            if (map) truth.set(name, truth_json(*map));
        };
        add("diffuse", comparison.truth->diffuse);
        add("specular", comparison.truth->specular);
        add("roughness", comparison.truth->roughness);
        if (const auto& bound = comparison.truth->bound) {
            truth.set("cramer_rao", bound_json(*bound));
        }
        json.set("truth", std::move(truth));
    }
    Json per_shot = Json::list();
    for (const ShotComparison& shot : comparison.per_shot) {
        Json item = image_json(shot.difference);
        item.set("image", Json(shot.image));
        item.set("heldout", Json(shot.heldout));
        per_shot.push(std::move(item));
    }
    json.set("per_shot", std::move(per_shot));
    return json;
}

std::string comparison_text(const Comparison& comparison) {
    TextTable images({"images", " mean", " variance", " relative RMSE", " pixels"});
    for (const ShotComparison& shot : comparison.per_shot) {
        add_row(images, shot.image + (shot.heldout ? " (held out)" : ""), shot.difference);
    }
    if (comparison.shots) add_row(images, "all used shots", *comparison.shots);
    if (comparison.heldout) add_row(images, "all held-out shots", *comparison.heldout);
    std::string text =
        fmt::format("|synthetic - real| in 8-bit levels; level 255 is the radiance {:.6g}\n\n",
                    comparison.white) +
        images.text();
    if (comparison.heldout && comparison.heldout->noise) {
        text += fmt::format(
            "\nnoise of the held-out synthetic images: variance {:.3f}, {:.1f} % of the mean "
            "squared "
            "difference\n",
            comparison.heldout->noise->variance,
            100 * comparison.heldout->noise->share);
    }
    if (const auto& check = comparison.prediction) {
        text += fmt::format(
            "\nheld-out pixels against the spread of the used ones: reduced chi-square {:.2f}, "
            "{:.1f} % in 68 %, {:.1f} % in 95 %\n",
            check->reduced_chi_square,
            100 * check->coverage68,
            100 * check->coverage95);
    }
    if (comparison.truth) {
        TextTable truth({"truth",
                         " mean error",
                         " median |error|",
                         " RMSE",
                         " in 68 %",
                         " in 95 %",
                         " rank correlation",
                         " texels"});
        add_row(truth, "diffuse", comparison.truth->diffuse);
        add_row(truth, "specular", comparison.truth->specular);
        add_row(truth, "roughness", comparison.truth->roughness);
        text += "\n" + truth.text();
        if (const auto& bound = comparison.truth->bound) {
            text += fmt::format(
                "\nCramer-Rao bound at the truth: {} texels have a measurable lobe, {:.1f} % of "
                "them "
                "status 1; median errors over the bound's: Ps {:.2f}, sigma {:.2f}\n",
                bound->num_measurable,
                100 * bound->measured_share,
                bound->specular_ratio,
                bound->roughness_ratio);
        }
    }
    return text;
}

}  // namespace patina
