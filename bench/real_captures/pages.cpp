#include "pages.h"

#include "patina/base/check.h"
#include "patina/pipeline/version.h"

#include <fmt/format.h>

#include "picture_sheet.h"
#include "texel_sets.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>

namespace patina {
namespace {

// Texels this close to what is not seen are not compared: silhouettes and registration would decide
// there [texels].
constexpr int kMargin = 6;
// Creases: indirect over direct irradiance above this [-].
constexpr double kCreaseShare = 0.1;

// --- Markdown ------------------------------------------------------------------------------------

std::string number(double value) { return fmt::format("{:.4g}", value); }

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string heldout_text(const MethodRun& run) {
    return run.heldout ? fmt::format("{:.4f}", run.heldout->relative_rmse) : "-";
}

// --- Values of texels ----------------------------------------------------------------------------

bool is_roughness_measured(const MethodRun& run, TexelId texel) {
    return has_status(run, texel, TexelStatus::measured) &&
           std::isfinite(run.estimate.errors[texel].roughness);
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

// --- Uniform colour: real_cat --------------------------------------------------------------------

// The methods that are compared, in the order of the columns: direct first.
using MethodRuns = std::vector<MethodRun>;

MethodRuns run_methods(const Capture& capture, const PageSettings& settings, Progress& progress) {
    MethodRuns runs;
    for (const Method method : {Method::direct, Method::photon, Method::gather}) {
        runs.push_back(run_method(capture, method, settings.run, progress));
    }
    return runs;
}

// One figure by every method, and whether those that know of bounced light are better than direct.
std::string claim_row(const std::string& what,
                      const MethodRuns& runs,
                      const std::function<double(const MethodRun&)>& figure,
                      bool may_be_equal) {
    std::vector<std::string> cells = {what};
    std::vector<std::string> failing;
    const double direct = figure(runs.front());
    for (const MethodRun& run : runs) {
        const double value = figure(run);
        cells.push_back(fmt::format("{:.4f}", value));
        if (&run == &runs.front() || (may_be_equal ? value <= direct : value < direct)) continue;
        failing.push_back("**not " + run.name + "**");
    }
    cells.push_back(failing.empty() ? "yes" : fmt::format("{}", fmt::join(failing, ", ")));
    return table_row(cells);
}

std::string uniformity_rows(const std::string& where,
                            const TexelSet& texels,
                            const MethodRuns& runs) {
    const auto spread = [&](const MethodRun& run) {
        return spread_of(texels, [&](TexelId t) { return mean_diffuse(run, t); });
    };
    return claim_row(
               "coefficient of variation of Pd, " + where,
               runs,
               [&](const MethodRun& run) { return spread(run).coefficient_of_variation; },
               false) +
           claim_row(
               "p95/p50 of Pd, " + where,
               runs,
               [&](const MethodRun& run) { return spread(run).p95_over_p50; },
               false);
}

std::string cat_section(const Capture& capture, const PageSettings& settings, Progress& progress) {
    const MethodRuns runs = run_methods(capture, settings, progress);
    const MethodRun& gather = runs.back();
    const TexelSet inner = inner_texels(capture.atlas, gather.estimate.seen, kMargin);
    const TexelSet creases = select(inner, [&](TexelId t) {
        return double(gather.estimate.indirect_over_direct[t]) > kCreaseShare;
    });
    std::string text =
        "Plaster of one colour: Pd should be the same everywhere. It is compared as it is, never "
        "smoothed.\n\n";
    std::vector<std::string> head = {""};
    for (const MethodRun& run : runs) head.push_back(run.name);
    std::vector<std::string> claim_head = head;
    claim_head.push_back("better than direct");
    text += table_head(claim_head);
    text += uniformity_rows(fmt::format("{} texels", inner.size()), inner, runs);
    text += uniformity_rows(fmt::format("{} texels in creases", creases.size()), creases, runs);
    text += claim_row(
        "relative RMSE of the held-out shots",
        runs,
        [](const MethodRun& run) {
            PATINA_CHECK(run.heldout);
            return run.heldout->relative_rmse;
        },
        true);
    head.front() = "over the same texels";
    text += "\n" + table_head(head);
    const auto row = [&](const std::string& what, const auto& figure) {
        std::vector<std::string> cells = {what};
        for (const MethodRun& run : runs) cells.push_back(figure(run));
        text += table_row(cells);
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
    return text + "\n" + write_pictures("real_cat", capture, settings.docs, runs.front(), gather);
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
    const MethodRuns runs = run_methods(capture, settings, progress);
    const MethodRun& gather = runs.back();
    const TexelSet inner = inner_texels(capture.atlas, gather.estimate.seen, kMargin);
    std::string text = introduction + "\n\n";
    text += fmt::format(
        "{} texels. Median (16 % to 84 %), and half that distance over the median; Pd of status 1 "
        "and 2, Ps of status 1, sigma where it is measured.\n\n",
        inner.size());
    text +=
        table_head({"", "Pd", "Ps of", "Ps", "sigma of", "sigma [rad]", "held-out relative RMSE"});
    text += material_row(inner, lambertian);
    for (const MethodRun& run : runs) text += material_row(inner, run);
    PATINA_CHECK(lambertian.heldout && gather.heldout);
    const auto against = [&](const MethodRun& run, const MethodRun& other) {
        const double error = run.heldout->relative_rmse;
        return fmt::format("{} that of {}",
                           error < other.heldout->relative_rmse ? "below" : "**not** below",
                           other.name == "direct" ? "direct" : "the Lambertian fit");
    };
    text += "\n";
    for (const MethodRun& run : std::span(runs).subspan(1)) {
        text += fmt::format("The held-out relative RMSE of {} is {} and {}; it took {}. ",
                            run.name,
                            against(run, lambertian),
                            against(run, runs.front()),
                            iteration_text(run));
    }
    return text + "\n\n" + write_pictures(name, capture, settings.docs, runs.front(), gather);
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
    for (const Method method : {Method::direct, Method::diffuse, Method::photon, Method::gather}) {
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
        "looks, as gather finds it. Pictures show texels of status 1 and 2, Ps and sigma with what "
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
