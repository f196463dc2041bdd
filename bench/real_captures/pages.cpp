#include "pages.h"

#include "patina/base/check.h"
#include "patina/pipeline/version.h"

#include <fmt/format.h>

#include "map_pictures.h"
#include "texel_sets.h"
#include <algorithm>
#include <array>
#include <cmath>

namespace patina {
namespace {

// Texels this close to what is not seen are not compared: silhouettes and registration would decide
// there [texels].
constexpr int kMargin = 6;
// Creases: indirect over direct irradiance above this [-].
constexpr double kCreaseShare = 0.1;

// --- Markdown ------------------------------------------------------------------------------------

std::string table_row(const std::vector<std::string>& cells) {
    return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

std::string table_head(const std::vector<std::string>& cells) {
    return table_row(cells) + table_row(std::vector<std::string>(cells.size(), "---"));
}

std::string number(double value) { return fmt::format("{:.4g}", value); }

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string heldout_text(const MethodRun& run) {
    return run.heldout ? fmt::format("{:.4f}", run.heldout->relative_rmse) : "-";
}

// --- Values of texels ----------------------------------------------------------------------------

bool has_status(const MethodRun& run, TexelId texel, TexelStatus status) {
    return run.estimate.status[texel] == status;
}

bool is_diffuse_measured(const MethodRun& run, TexelId texel) {
    return has_status(run, texel, TexelStatus::measured) ||
           has_status(run, texel, TexelStatus::diffuse_measured);
}

bool is_roughness_measured(const MethodRun& run, TexelId texel) {
    return has_status(run, texel, TexelStatus::measured) &&
           std::isfinite(run.estimate.errors[texel].roughness);
}

double mean_diffuse(const MethodRun& run, TexelId texel) {
    return run.estimate.maps[texel].diffuse.mean();
}

double share_of(const TexelSet& texels, const std::function<bool(TexelId)>& holds) {
    if (texels.empty()) return 0;
    return double(select(texels, holds).size()) / double(texels.size());
}

std::string iteration_text(const MethodRun& run) {
    const IterationLog& last = run.estimate.iterations.back();
    return fmt::format("{} turns, {}, lambda {:.2f}",
                       run.estimate.iterations.size(),
                       run.estimate.converged ? "settled" : "not settled",
                       last.spectral_radius);
}

// --- Pictures ------------------------------------------------------------------------------------

// The six pictures of a capture, as Markdown; nothing where pictures are not wanted.
class PictureSheet {
  public:
    PictureSheet(const std::string& name, const Capture& capture, const PageSettings& settings)
        : name_(name), atlas_(capture.atlas), docs_(settings.docs) {}

    [[nodiscard]] std::string write(const MethodRun& direct, const MethodRun& photon) {
        if (docs_.empty()) return "";
        const auto diffuse_known = [&](TexelId t) { return is_diffuse_measured(photon, t); };
        const auto diffuse_of = [](const MethodRun& run) {
            return [&run](TexelId t) { return mean_diffuse(run, t); };
        };
        const ColorRange range = range_from_zero(atlas_, diffuse_known, diffuse_of(direct));
        write_map_picture(file("pd_direct"), atlas_, range, diffuse_known, diffuse_of(direct));
        add("Pd by direct, " + range.text);
        write_map_picture(file("pd_photon"), atlas_, range, diffuse_known, diffuse_of(photon));
        add("Pd by photon, " + range.text);
        write_ratio_picture(
            file("pd_ratio"),
            atlas_,
            [&](TexelId t) {
                return diffuse_known(t) && mean_diffuse(direct, t) > 0 &&
                       mean_diffuse(photon, t) > 0;
            },
            [&](TexelId t) { return mean_diffuse(photon, t) / mean_diffuse(direct, t); });
        add("photon over direct, " + ratio_range().text);
        write_lobe(photon);
        write_status_picture(file("status"), atlas_, photon.estimate);
        add("status by photon: 1 at the bar's top, 2, 3 at its bottom");
        return table_head(captions_) + table_row(pictures_);
    }

  private:
    void write_lobe(const MethodRun& photon) {
        const auto lobe_known = [&](TexelId t) { return is_diffuse_measured(photon, t); };
        const auto specular = [&](TexelId t) { return photon.estimate.maps[t].specular; };
        const auto roughness = [&](TexelId t) { return photon.estimate.maps[t].roughness; };
        const ColorRange specular_range = range_from_zero(atlas_, lobe_known, specular);
        write_map_picture(file("ps"), atlas_, specular_range, lobe_known, specular);
        add("Ps by photon, " + specular_range.text);
        const ColorRange roughness_range = range_from_zero(atlas_, lobe_known, roughness);
        write_map_picture(file("sigma"), atlas_, roughness_range, lobe_known, roughness);
        add("sigma by photon, " + roughness_range.text + " rad");
    }

    // The picture to write next.
    [[nodiscard]] std::filesystem::path file(const std::string& map) {
        const std::string picture = fmt::format("pictures/{}_{}.png", name_, map);
        next_picture_ = picture;
        return docs_ / picture;
    }
    void add(const std::string& caption) {
        captions_.push_back(caption);
        pictures_.push_back(fmt::format("![{}]({})", caption, next_picture_));
    }

    std::string name_;
    const TexelAtlas& atlas_;
    std::filesystem::path docs_;
    std::string next_picture_;
    std::vector<std::string> captions_;
    std::vector<std::string> pictures_;
};

// --- Uniform colour: real_cat --------------------------------------------------------------------

// One figure by both methods, and whether photon's is what is claimed.
std::string claim_row(const std::string& what, double direct, double photon, bool may_be_equal) {
    const bool holds = may_be_equal ? photon <= direct : photon < direct;
    return table_row({what,
                      fmt::format("{:.4f}", direct),
                      fmt::format("{:.4f}", photon),
                      holds ? "yes" : "**no**"});
}

std::string uniformity_rows(const std::string& where,
                            const TexelSet& texels,
                            const MethodRun& direct,
                            const MethodRun& photon) {
    const Spread by_direct = spread_of(texels, [&](TexelId t) { return mean_diffuse(direct, t); });
    const Spread by_photon = spread_of(texels, [&](TexelId t) { return mean_diffuse(photon, t); });
    return claim_row("coefficient of variation of Pd, " + where,
                     by_direct.coefficient_of_variation,
                     by_photon.coefficient_of_variation,
                     false) +
           claim_row(
               "p95/p50 of Pd, " + where, by_direct.p95_over_p50, by_photon.p95_over_p50, false);
}

std::string cat_section(const Capture& capture, const PageSettings& settings, Progress& progress) {
    const MethodRun direct = run_method(capture, Method::direct, settings.run, progress);
    const MethodRun photon = run_method(capture, Method::photon, settings.run, progress);
    const TexelSet inner = inner_texels(capture.atlas, photon.estimate.seen, kMargin);
    const TexelSet creases = select(inner, [&](TexelId t) {
        return double(photon.estimate.indirect_over_direct[t]) > kCreaseShare;
    });
    std::string text =
        "Plaster of one colour: Pd should be the same everywhere. It is compared as it is, never "
        "smoothed.\n\n";
    text += table_head({"", "direct", "photon", "photon is better"});
    text += uniformity_rows(fmt::format("{} texels", inner.size()), inner, direct, photon);
    text += uniformity_rows(
        fmt::format("{} texels in creases", creases.size()), creases, direct, photon);
    PATINA_CHECK(direct.heldout && photon.heldout);
    text += claim_row("relative RMSE of the held-out shots",
                      direct.heldout->relative_rmse,
                      photon.heldout->relative_rmse,
                      true);
    text += "\n" + table_head({"over the same texels", "direct", "photon"});
    const auto row = [&](const std::string& what, const auto& figure) {
        text += table_row({what, figure(direct), figure(photon)});
    };
    const auto median_of = [&](const TexelSet& texels) {
        return [&texels](const MethodRun& run) {
            return number(
                spread_of(texels, [&](TexelId t) { return mean_diffuse(run, t); }).median);
        };
    };
    row("median of Pd", median_of(inner));
    row("median of Pd in creases", median_of(creases));
    row("lobe measured (status 1)", [&](const MethodRun& run) {
        return percent(
            share_of(inner, [&](TexelId t) { return has_status(run, t, TexelStatus::measured); }));
    });
    row("sigma measured", [&](const MethodRun& run) {
        return percent(share_of(inner, [&](TexelId t) { return is_roughness_measured(run, t); }));
    });
    row("median of Ps, filled ones too", [&](const MethodRun& run) {
        return number(
            spread_of(inner, [&](TexelId t) { return run.estimate.maps[t].specular; }).median);
    });
    row("iteration", iteration_text);
    return text + "\n" + PictureSheet("real_cat", capture, settings).write(direct, photon);
}

// --- One material, or a flat card: real_ball, real_box -------------------------------------------

std::string spread_text(const Spread& spread) {
    if (spread.count == 0) return "-";
    return fmt::format("{:.4g} ({:.4g} to {:.4g}), {:.1f} %",
                       spread.median,
                       spread.low,
                       spread.high,
                       50 * (spread.high - spread.low) / spread.median);
}

std::string material_row(const TexelSet& inner, const MethodRun& run) {
    const TexelSet with_diffuse =
        select(inner, [&](TexelId t) { return is_diffuse_measured(run, t); });
    const TexelSet with_lobe =
        select(inner, [&](TexelId t) { return has_status(run, t, TexelStatus::measured); });
    const TexelSet with_roughness =
        select(inner, [&](TexelId t) { return is_roughness_measured(run, t); });
    const auto& maps = run.estimate.maps;
    return table_row(
        {run.name,
         spread_text(spread_of(with_diffuse, [&](TexelId t) { return mean_diffuse(run, t); })),
         fmt::format("{}", with_lobe.size()),
         spread_text(spread_of(with_lobe, [&](TexelId t) { return maps[t].specular; })),
         fmt::format("{}", with_roughness.size()),
         spread_text(spread_of(with_roughness, [&](TexelId t) { return maps[t].roughness; })),
         heldout_text(run)});
}

std::string material_section(const std::string& name,
                             const std::string& introduction,
                             const Capture& capture,
                             const PageSettings& settings,
                             Progress& progress) {
    const MethodRun lambertian = run_lambertian(capture, settings.run, progress);
    const MethodRun direct = run_method(capture, Method::direct, settings.run, progress);
    const MethodRun photon = run_method(capture, Method::photon, settings.run, progress);
    const TexelSet inner = inner_texels(capture.atlas, photon.estimate.seen, kMargin);
    std::string text = introduction + "\n\n";
    text += fmt::format(
        "{} texels. Median (16 % to 84 %), and half that distance over the median; Pd of status 1 "
        "and 2, Ps of status 1, sigma where it is measured.\n\n",
        inner.size());
    text +=
        table_head({"", "Pd", "Ps of", "Ps", "sigma of", "sigma [rad]", "held-out relative RMSE"});
    for (const MethodRun* run : {&lambertian, &direct, &photon}) text += material_row(inner, *run);
    PATINA_CHECK(lambertian.heldout && direct.heldout && photon.heldout);
    const double error = photon.heldout->relative_rmse;
    const auto against = [&](const MethodRun& other) {
        return fmt::format("{} that of {}",
                           error < other.heldout->relative_rmse ? "below" : "**not** below",
                           other.name == "direct" ? "direct" : "the Lambertian fit");
    };
    text += fmt::format("\nThe held-out relative RMSE of photon is {} and {}; photon took {}.\n\n",
                        against(lambertian),
                        against(direct),
                        iteration_text(photon));
    return text + PictureSheet(name, capture, settings).write(direct, photon);
}

// --- Known truth: channel ------------------------------------------------------------------------

std::string median_beside_truth(const TexelSet& texels,
                                const std::function<double(TexelId)>& estimate,
                                const std::function<double(TexelId)>& truth) {
    if (texels.empty()) return "-";
    return fmt::format(
        "{:.4g} ({:.4g})", spread_of(texels, estimate).median, spread_of(texels, truth).median);
}

std::string channel_row(const Capture& capture, const TruthMaps& truth, const MethodRun& run) {
    PATINA_CHECK(run.truth && run.truth->diffuse);
    const TexelAtlas& atlas = capture.atlas;
    const auto in_truth = [&](const Image& map) {
        return
            [&](TexelId t) { return double(map.at(atlas.texels[t].column, atlas.texels[t].row)); };
    };
    const TexelSet seen = inner_texels(atlas, run.estimate.seen, 0);
    const TexelSet with_lobe =
        select(seen, [&](TexelId t) { return has_status(run, t, TexelStatus::measured); });
    const TexelSet with_roughness =
        select(seen, [&](TexelId t) { return is_roughness_measured(run, t); });
    const auto& maps = run.estimate.maps;
    const auto measured = [&](TexelId t) { return is_diffuse_measured(run, t); };
    return table_row(
        {run.name,
         fmt::format("{:+.1f} %", 100 * run.truth->diffuse->mean_relative_error),
         percent(run.truth->diffuse->median_absolute_relative_error),
         fmt::format("{}", with_lobe.size()),
         median_beside_truth(
             with_lobe, [&](TexelId t) { return maps[t].specular; }, in_truth(truth.specular)),
         median_beside_truth(
             with_roughness,
             [&](TexelId t) { return maps[t].roughness; },
             in_truth(truth.roughness)),
         percent(share_of(seen, measured)),
         heldout_text(run),
         iteration_text(run)});
}

std::string channel_section(const Capture& capture,
                            const PageSettings& settings,
                            Progress& progress) {
    const TruthMaps truth = load_truth(capture.description);
    std::string text =
        "A bright and glossy U-shaped channel, rendered with sensor noise by an independent "
        "renderer, so its truth is known. Errors of Pd over all texels of status 1 and 2; medians "
        "of "
        "Ps over those of status 1, and of sigma where it is measured, with those of the truth at "
        "the same texels in brackets.\n\n";
    text += table_head({"",
                        "Pd, mean relative error",
                        "Pd, median absolute relative error",
                        "Ps of",
                        "Ps (truth)",
                        "sigma (truth) [rad]",
                        "seen texels of status 1 or 2",
                        "held-out relative RMSE",
                        "iteration"});
    for (const Method method : {Method::direct, Method::diffuse, Method::photon}) {
        text += channel_row(capture, truth, run_method(capture, method, settings.run, progress));
    }
    return text;
}

}  // namespace

std::vector<std::string> section_names() {
    return {"real_cat", "real_ball", "real_box", "channel"};
}

std::string make_section(const std::string& name,
                         const PageSettings& settings,
                         Progress& progress) {
    const Capture capture = load_capture(settings.captures / name);
    const std::string heading = fmt::format("## {}\n\n", name);
    if (name == "real_cat") return heading + cat_section(capture, settings, progress);
    if (name == "channel") return heading + channel_section(capture, settings, progress);
    const std::string introduction =
        name == "real_ball"
            ? "A ball of one glossy material: Pd, Ps and sigma should be the same "
              "everywhere. Nothing bounces on a convex body."
            : "A flat box of printed foil, by a phone with its flash: no truth, but "
              "views that were held out. Nothing bounces on a flat card.";
    return heading + material_section(name, introduction, capture, settings, progress);
}

std::string make_introduction(const PageSettings& settings) {
    const EstimateOptions defaults;
    return fmt::format(
        "# What patina makes of real captures\n\n"
        "Every figure and picture here was made by patina {} with\n\n"
        "```sh\ntools/results CAPTURES --photons {} --seed {} --samples {}\n```\n\n"
        "where CAPTURES is the folder of the captures. Do not edit the page: run the script again. "
        "Estimates have their default settings but for {} photons for each set of lamps; at most "
        "{} turns of each loop. Held-out shots are rendered by the path tracer with {} paths a "
        "pixel. The relative RMSE is the root of the summed squared differences over the summed "
        "squared image, over the pixels of status 1 and 2 (see [results](result.md)).\n\n"
        "Unless said otherwise texels are those with nothing but seen texels within {} rows and "
        "columns of them, the same for every method; Pd is the mean of its three channels. Creases "
        "are the texels whose indirect irradiance is more than {} of the direct one, mean over the "
        "looks, as photon finds it. Pictures show texels of status 1 and 2, Ps and sigma with what "
        "was filled in; the bar on the right has the stated range from bottom to top.\n",
        program_version(),
        settings.run.photons,
        settings.run.seed,
        settings.run.samples,
        settings.run.photons,
        defaults.max_iterations,
        settings.run.samples,
        kMargin,
        kCreaseShare);
}

}  // namespace patina
