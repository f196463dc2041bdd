// The sections of the report that are charts: Figure 5, Figure 4(d) and the convergence.
#include "patina/export/lamp_map.h"
#include "patina/export/report_parts.h"
#include "patina/export/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace patina {
namespace {

constexpr double kPanelWidth = 345;
constexpr double kPanelHeight = 270;

// Mean of Pd over each row of the texel domain, one vector per channel; NaN where a row is empty.
std::array<std::vector<double>, 3> row_means(const ReportMaps& maps) {
    const PixelMask mask = status_mask(maps, 1, 3);
    const Image& diffuse = maps.diffuse;
    std::array<std::vector<double>, 3> means;
    for (int y = 0; y < diffuse.height; ++y) {
        Rgb sum = Rgb::Zero();
        int count = 0;
        for (int x = 0; x < diffuse.width; ++x) {
            const std::size_t pixel = diffuse.index(x, y) / 3;
            if (!mask.empty() && mask[pixel] == 0) continue;
            for (int c = 0; c < 3; ++c) sum[c] += double(diffuse.at(x, y, c));
            ++count;
        }
        for (int c = 0; c < 3; ++c) {
            means[std::size_t(c)].push_back(count > 0 ? sum[c] / count
                                                      : std::numeric_limits<double>::quiet_NaN());
        }
    }
    return means;
}

PlotSeries profile_series(const std::string& label, const std::vector<double>& means, int color) {
    PlotSeries series{label, {}, means, color};
    for (std::size_t row = 0; row < means.size(); ++row) series.x.push_back(double(row) + 0.5);
    return series;
}

std::string profile_figure(const ReportData& data, const ObjectReport& object) {
    std::array<Plot, 3> panels;
    const auto add = [&](const std::string& label, const ReportMaps& maps, int color, bool dashed) {
        if (maps.diffuse.channels != 3) return;
        const auto means = row_means(maps);
        for (std::size_t c = 0; c < 3; ++c) {
            panels[c].series.push_back(profile_series(label, means[c], color));
            panels[c].series.back().is_dashed = dashed;
        }
    };
    for (const MethodReport& method : object.methods) {
        add(method_label(method.method), method.maps, method_color(method.method), false);
    }
    if (object.truth) add("Truth", *object.truth, 0, true);

    double highest = 0;
    for (const Plot& panel : panels) {
        for (const PlotSeries& series : panel.series) {
            for (const double value : series.y) highest = std::max(highest, value);
        }
    }
    std::string charts;
    static constexpr std::array<const char*, 3> kTitles = {"Red", "Green", "Blue"};
    for (std::size_t c = 0; c < 3; ++c) {
        Plot& panel = panels[c];
        panel.title = kTitles[c];
        panel.x_axis = {"row of the texture, from the top [texels]"};
        panel.y_axis = {"Pd, mean of the row [-]", AxisScale::linear, 0, 1.08 * highest};
        panel.marks = {{*object.profile_edge, "edge"}};
        panel.width = kPanelWidth;
        panel.height = kPanelHeight;
        charts += svg_plot(panel);
    }
    if (charts.empty()) return "";
    return html_figure(
        plot_legend(panels[0].series) + "<div class=\"row\">" + charts + "</div>",
        figure_name(data, "Figure 5") + "Pd along the vertical of " + object.title +
            ", averaged along the horizontal. Both plates have one material, so the curves should "
            "be level. Light that bounced between the plates raises them towards the edge until it "
            "is taken out.");
}

// Measurable shares over the number of lamps, and where they stand.
std::string selection_charts(const SelectionReport& selection) {
    Plot plot;
    plot.title = "Measurable texels";
    plot.x_axis = {"lamps, in the order of choice"};
    plot.y_axis = {"share of the seen texels [%]", AxisScale::linear, 0, 100};
    PlotSeries diffuse{"diffuse", {0}, {0}, 2, false, true};
    PlotSeries specular{"specular", {0}, {0}, 1, false, true};
    for (std::size_t i = 0; i < selection.shares.size(); ++i) {
        diffuse.x.push_back(double(i + 1));
        diffuse.y.push_back(100 * selection.shares[i].first);
        specular.x.push_back(double(i + 1));
        specular.y.push_back(100 * selection.shares[i].second);
    }
    const auto with_all = [&](const PlotSeries& series, double share) {
        const double level = 100 * share;
        return PlotSeries{series.label + ", all candidates",
                          {0, series.x.back()},
                          {level, level},
                          series.color,
                          true};
    };
    plot.series = {diffuse,
                   specular,
                   with_all(diffuse, selection.share_with_all.first),
                   with_all(specular, selection.share_with_all.second)};
    return plot_legend(plot.series) + "<div class=\"row\">" + svg_plot(plot) + lamp_map(selection) +
           "</div>";
}

std::string selection_table(const ReportData& data) {
    HtmlTable table;
    table.columns = {"Object",
                     "diffuse measurable",
                     "with all",
                     "specular measurable",
                     "with all",
                     "lamps (for diffuse)",
                     "candidates"};
    for (const ObjectReport& object : data.objects) {
        if (!object.selection) continue;
        const SelectionReport& s = *object.selection;
        const auto reached = s.shares.empty() ? std::pair(0.0, 0.0) : s.shares.back();
        table.rows.push_back({{capitalized(object.title),
                               format_percent(reached.first),
                               format_percent(s.share_with_all.first),
                               format_percent(reached.second),
                               format_percent(s.share_with_all.second),
                               fmt::format("{} ({})", s.chosen.size(), s.chosen_for_diffuse.size()),
                               fmt::format("{}", s.candidates.size())}});
    }
    return html_table(table);
}

// The turns of one loop, and the method that ran it.
struct LoopLog {
    std::string stage;
    std::vector<IterationLog> turns;
};

// Each loop once, from the method of its own name where there is one.
std::vector<LoopLog> loops_of(const ObjectReport& object) {
    std::vector<LoopLog> loops;
    const auto find = [&](const std::string& stage) {
        return std::find_if(
            loops.begin(), loops.end(), [&](const LoopLog& loop) { return loop.stage == stage; });
    };
    for (const MethodReport& method : object.methods) {
        std::vector<LoopLog> own;
        for (const IterationLog& turn : method.iterations) {
            if (own.empty() || own.back().stage != turn.stage) own.push_back({turn.stage, {}});
            own.back().turns.push_back(turn);
        }
        for (LoopLog& loop : own) {
            const auto there = find(loop.stage);
            if (there == loops.end()) {
                loops.push_back(std::move(loop));
            } else if (loop.stage == method.method) {
                *there = std::move(loop);
            }
        }
    }
    return loops;
}

std::string convergence_table(const ObjectReport& object, const std::vector<LoopLog>& loops) {
    HtmlTable table;
    table.columns = {
        "Loop", "turns", "final E", "last change", "λ", "damping ω", "traced", "converged"};
    for (const LoopLog& loop : loops) {
        const IterationLog& last = loop.turns.back();
        const MethodReport* method = find_method(object, loop.stage);
        const auto traced = std::count_if(loop.turns.begin(),
                                          loop.turns.end(),
                                          [](const IterationLog& turn) { return turn.retraced; });
        table.rows.push_back(
            {{method_label(loop.stage),
              fmt::format("{}", loop.turns.size()),
              format_number(last.error),
              format_number(last.change, 2),
              last.spectral_radius > 0 ? format_number(last.spectral_radius) : "\u2013",
              format_number(last.damping),
              fmt::format("{}", traced),
              method == nullptr   ? "\u2013"
              : method->converged ? "yes"
                                  : "no"}});
    }
    return html_table(table);
}

std::string convergence_figure(const ObjectReport& object) {
    std::vector<LoopLog> loops = loops_of(object);
    if (loops.empty()) return "";
    Plot error;
    error.title = "Error E of equation (5)";
    error.x_axis = {"turn"};
    error.y_axis = {"E [radiance²]", AxisScale::logarithmic};
    Plot change;
    change.title = "Change of the maps";
    change.x_axis = {"turn"};
    change.y_axis = {"relative change [-]", AxisScale::logarithmic};
    for (const LoopLog& loop : loops) {
        if (loop.turns.size() < 2) continue;
        PlotSeries series{method_label(loop.stage), {}, {}, method_color(loop.stage), false, true};
        for (std::size_t i = 0; i < loop.turns.size(); ++i) {
            series.x.push_back(double(i + 1));
            series.y.push_back(loop.turns[i].error);
        }
        error.series.push_back(series);
        for (std::size_t i = 0; i < loop.turns.size(); ++i) series.y[i] = loop.turns[i].change;
        change.series.push_back(series);
    }
    std::string html = object_heading(object);
    std::string body = convergence_table(object, loops);
    if (!error.series.empty()) {
        body = plot_legend(error.series) + "<div class=\"row\">" + svg_plot(error) +
               svg_plot(change) + "</div>" + body;
    }
    return html +
           html_figure(body,
                       "E is the mean squared difference between the images and what the maps "
                       "predict. \u03bb is the share of bounced light that bounces again: the "
                       "closer to 1, the more turns are needed. Traced: turns before which "
                       "the photons were traced anew.");
}

}  // namespace

std::string profile_section(const ReportData& data) {
    std::string html;
    for (const ObjectReport& object : data.objects) {
        if (object.profile_edge) html += profile_figure(data, object);
    }
    return html;
}

std::string selection_section(const ReportData& data) {
    std::string figures;
    for (const ObjectReport& object : data.objects) {
        if (!object.selection || object.selection->candidates.empty()) continue;
        figures += object_heading(object);
        figures += html_figure(
            selection_charts(*object.selection),
            "Left: what the lamps chosen so far make measurable. Right: the candidates as seen "
            "from "
            "the object, numbered in the order of choice; the blue ones alone suffice for the "
            "diffuse component.");
        figures += lamp_rule_table(object.selection->rules, object.selection->chosen.size());
        figures += lamp_rule_charts(object.selection->rules, object.selection->chosen.size());
    }
    if (figures.empty()) return "";
    return html_figure(
               selection_table(data),
               figure_name(data, "Figure 4(d)") +
                   "Share of the seen texels at which each component "
                   "can be measured with the chosen lamps and with all candidates, and the number "
                   "of lamps; in brackets those that suffice for the diffuse component. Diffuse "
                   "needs one lamp away from the highlight, specular two near it.") +
           figures;
}

std::string convergence_section(const ReportData& data) {
    std::string html;
    for (const ObjectReport& object : data.objects) html += convergence_figure(object);
    return html;
}

}  // namespace patina
