// The sections of the report that are tables: Table 1, errors against the truth, times, and the
// few numbers to see first.
#include "patina/export/paper_table.h"
#include "patina/export/report_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>

namespace patina {
namespace {

constexpr const char* kNone = "\u2013";

// Names of the methods of all objects, in order of their first appearance.
std::vector<std::string> all_methods(const ReportData& data) {
    std::vector<std::string> methods;
    for (const ObjectReport& object : data.objects) {
        for (const MethodReport& method : object.methods) {
            if (std::find(methods.begin(), methods.end(), method.method) == methods.end()) {
                methods.push_back(method.method);
            }
        }
    }
    return methods;
}

bool has_differences(const ObjectReport& object) {
    return std::any_of(object.methods.begin(), object.methods.end(), [](const MethodReport& m) {
        return m.heldout.has_value() || m.used.has_value();
    });
}

bool has_paper_figures(const ReportData& data, const ObjectReport& object) {
    return data.paper_experiments && paper_table_1(object.name, "photon").has_value();
}

// One of the three measures of Table 1.
struct Measure {
    const char* title;
    double LevelComparison::*ours;
    double PaperDifference::*paper;  // null: the paper has none
    bool is_share;
};
constexpr std::array<Measure, 3> kMeasures = {
    {{"Mean of |difference| [levels]",
      &LevelComparison::levels_mean,
      &PaperDifference::levels_mean,
      false},
     {"Variance of |difference| [levels²]",
      &LevelComparison::levels_variance,
      &PaperDifference::levels_variance,
      false},
     {"Relative root mean square error", &LevelComparison::relative_rmse, nullptr, true}}};

std::string cell_of(const Measure& measure, const std::optional<LevelComparison>& comparison) {
    if (!comparison) return kNone;
    const double value = (*comparison).*measure.ours;
    return measure.is_share ? format_percent(value) : format_number(value);
}

std::vector<std::string> difference_cells(const ReportData& data,
                                          const Measure& measure,
                                          const std::string& method) {
    std::vector<std::string> cells = {method_label(method)};
    for (const ObjectReport& object : data.objects) {
        if (!has_differences(object)) continue;
        const MethodReport* found = find_method(object, method);
        if (has_paper_figures(data, object)) {
            const auto paper = paper_table_1(object.name, method);
            const bool has_paper = paper && measure.paper != nullptr;
            // As printed there.
            cells.push_back(has_paper ? fmt::format("{}", (*paper).*measure.paper) : kNone);
        }
        cells.push_back(found != nullptr ? cell_of(measure, found->heldout) : kNone);
        cells.push_back(found != nullptr ? cell_of(measure, found->used) : kNone);
    }
    return cells;
}

HtmlTable differences_table(const ReportData& data) {
    HtmlTable table;
    table.groups = {{"", 1}};
    table.columns = {"Method"};
    for (const ObjectReport& object : data.objects) {
        if (!has_differences(object)) continue;
        const bool has_paper = has_paper_figures(data, object);
        table.groups.emplace_back("Object " + object.name, has_paper ? 3 : 2);
        if (has_paper) table.columns.emplace_back("paper");
        table.columns.emplace_back("held-out lamp");
        table.columns.emplace_back("lamps used");
    }
    const std::vector<std::string> methods = all_methods(data);
    for (const Measure& measure : kMeasures) {
        table.rows.push_back({{measure.title}, true});
        for (const std::string& method : methods) {
            table.rows.push_back(
                {difference_cells(data, measure, method), false, method == methods.back()});
        }
    }
    return table;
}

std::string tile(const std::string& what, const std::string& number, const std::string& detail) {
    return fmt::format(
        "<div class=\"tile\"><span class=\"what\">{}</span><b>{}</b><span>{}</span></div>",
        escape_html(what),
        escape_html(number),
        escape_html(detail));
}

// How the last method compares under the held-out lamp.
std::string difference_tile(const ReportData& data, const ObjectReport& object) {
    const MethodReport& best = object.methods.back();
    if (!best.heldout) return "";
    std::string detail = "mean difference under the held-out lamp";
    const MethodReport* conventional = find_method(object, "diffuse");
    if (conventional != nullptr && conventional != &best && conventional->heldout) {
        detail += "; conventional II: " + format_number(conventional->heldout->levels_mean, 2);
    }
    if (const auto paper = paper_table_1(object.name, best.method);
        paper && data.paper_experiments) {
        detail += fmt::format("; in the paper: {}", paper->levels_mean);
    }
    return tile(
        capitalized(object.title), format_number(best.heldout->levels_mean, 2) + " levels", detail);
}

// How far the last method's Pd is from the truth.
std::string truth_tile(const ObjectReport& object) {
    const MethodReport& best = object.methods.back();
    if (!best.truth_diffuse) return "";
    const MethodReport* direct = find_method(object, "direct");
    std::string detail = "median error of Pd against the truth";
    if (direct != nullptr && direct != &best && direct->truth_diffuse) {
        detail += "; bounced light ignored: " +
                  format_percent(direct->truth_diffuse->median_absolute_relative_error);
    }
    return tile(
        object.title, format_percent(best.truth_diffuse->median_absolute_relative_error), detail);
}

// One map of one method against its truth.
struct TruthColumn {
    const char* title;
    std::optional<TruthComparison> MethodReport::*comparison;
};
constexpr std::array<TruthColumn, 3> kTruthColumns = {{{"Pd", &MethodReport::truth_diffuse},
                                                       {"Ps", &MethodReport::truth_specular},
                                                       {"σ", &MethodReport::truth_roughness}}};

void append_truth_cells(const std::optional<TruthComparison>& truth,
                        bool with_coverage,
                        std::vector<std::string>& cells) {
    cells.push_back(truth ? format_percent(truth->mean_relative_error, true) : kNone);
    cells.push_back(truth ? format_percent(truth->median_absolute_relative_error) : kNone);
    cells.push_back(truth ? format_number(truth->rmse) : kNone);
    if (!with_coverage) return;
    const bool known = truth && truth->coverage68 && truth->coverage95;
    cells.push_back(
        known ? fmt::format("{:.0f} / {:.0f}", 100 * *truth->coverage68, 100 * *truth->coverage95)
              : kNone);
}

// Whether any method of any object satisfies the condition.
bool any_method(const ReportData& data, const std::function<bool(const MethodReport&)>& condition) {
    return std::any_of(data.objects.begin(), data.objects.end(), [&](const ObjectReport& object) {
        return std::any_of(object.methods.begin(), object.methods.end(), condition);
    });
}

// Stages of one object in order of their first appearance, with the seconds of each method.
HtmlTable times_table(const ObjectReport& object) {
    HtmlTable table;
    table.columns = {"Stage"};
    std::vector<std::string> stages;
    std::vector<std::string> totals = {"Total"};
    for (const MethodReport& method : object.methods) {
        table.columns.push_back(method_label(method.method));
        double total = 0;
        for (const StageTime& time : method.times) {
            total += time.seconds;
            if (std::find(stages.begin(), stages.end(), time.stage) == stages.end()) {
                stages.push_back(time.stage);
            }
        }
        totals.push_back(format_seconds(total));
    }
    for (const std::string& stage : stages) {
        std::vector<std::string> cells = {stage};
        for (const MethodReport& method : object.methods) {
            double seconds = 0;
            bool found = false;
            for (const StageTime& time : method.times) {
                if (time.stage != stage) continue;
                seconds += time.seconds;
                found = true;
            }
            cells.push_back(found ? format_seconds(seconds) : kNone);
        }
        table.rows.push_back({std::move(cells)});
    }
    table.rows.push_back({std::move(totals), false, true});
    return table;
}

}  // namespace

std::string glance_section(const ReportData& data) {
    std::string tiles;
    for (const ObjectReport& object : data.objects) {
        if (object.methods.empty()) continue;
        const std::string difference = difference_tile(data, object);
        tiles += difference.empty() ? truth_tile(object) : difference;
    }
    return tiles.empty() ? "" : "<div class=\"tiles\">" + tiles + "</div>\n";
}

std::string differences_section(const ReportData& data) {
    if (!std::any_of(data.objects.begin(), data.objects.end(), has_differences)) return "";
    std::string caption =
        "Mean and variance of |real \u2212 synthetic| in 8-bit levels over the texels whose Pd is "
        "measured. Exposure is set so that the 99th percentile of the used images is level 230. "
        "Held-out lamp: never used for the estimate, compared with a render without sensor noise. "
        "Lamps "
        "used: "
        "the noisy images that the estimate was made from.";
    if (data.paper_experiments) {
        caption +=
            " The paper does not state its exposure or which pixels it counts: the columns beside "
            "its figures are our reading of its Table 1, on objects of our own.";
    }
    return html_figure(html_table(differences_table(data)), caption);
}

std::string truth_section(const ReportData& data) {
    const bool with_coverage = any_method(data, [](const MethodReport& m) {
        return m.truth_diffuse && m.truth_diffuse->coverage68.has_value();
    });
    HtmlTable table;
    table.groups = {{"", 1}};
    table.columns = {"Method"};
    for (const TruthColumn& column : kTruthColumns) {
        table.groups.emplace_back(column.title, with_coverage ? 4 : 3);
        for (const char* title : {"mean", "median", "rms"}) table.columns.emplace_back(title);
        if (with_coverage) table.columns.emplace_back("68 / 95 %");
    }
    for (const ObjectReport& object : data.objects) {
        const auto begin = table.rows.size();
        for (const MethodReport& method : object.methods) {
            if (!method.truth_diffuse && !method.truth_specular && !method.truth_roughness)
                continue;
            std::vector<std::string> cells = {method_label(method.method)};
            for (const TruthColumn& column : kTruthColumns) {
                append_truth_cells(method.*column.comparison, with_coverage, cells);
            }
            table.rows.push_back({std::move(cells), false, &method == &object.methods.back()});
        }
        if (table.rows.size() > begin) {
            table.rows.insert(table.rows.begin() + std::ptrdiff_t(begin),
                              {{capitalized(object.title)}, true});
        }
    }
    if (table.rows.empty()) return "";
    return html_figure(
        html_table(table),
        "Errors of the maps. Mean: mean(estimate \u2212 truth) / mean(truth), where bounced light "
        "shows as a bias. Median: of |estimate \u2212 truth| / truth. Rms: root mean square, in "
        "the "
        "map\u2019s own unit (\u03c3 in radians)." +
            std::string(with_coverage ? " 68 / 95 %: how often the stated intervals hold the truth."
                                      : "") +
            " Pd over all texels where it is measured, Ps and \u03c3 where the lobe is.");
}

std::string times_section(const ReportData& data) {
    std::string html;
    for (const ObjectReport& object : data.objects) {
        const bool has_times = std::any_of(object.methods.begin(),
                                           object.methods.end(),
                                           [](const MethodReport& m) { return !m.times.empty(); });
        if (!has_times) continue;
        html += object_heading(object);
        html += html_figure(html_table(times_table(object)), "Wall time of each stage.");
    }
    return html;
}

}  // namespace patina
