// Table 1 as text and as JSON, beside the paper's.
#include "patina/export/paper_table.h"
#include "patina/pipeline/demo.h"
#include "patina/pipeline/text_table.h"

#include <fmt/format.h>

namespace patina {
namespace {

std::string levels_text(const std::optional<LevelComparison>& levels) {
    if (!levels) return "-";
    return fmt::format("{:.2f} / {:.1f}", levels->levels_mean, levels->levels_variance);
}

std::string report_path(const DemoOptions& options) {
    return (options.output / "report.html").string();
}

Json levels_json(const LevelComparison& levels) {
    Json json = Json::object();
    json.set("levels_mean", Json(levels.levels_mean));
    json.set("levels_variance", Json(levels.levels_variance));
    json.set("relative_rmse", Json(levels.relative_rmse));
    return json;
}

Json truth_json(const TruthComparison& truth) {
    Json json = Json::object();
    json.set("mean_relative_error", Json(truth.mean_relative_error));
    json.set("median_absolute_relative_error", Json(truth.median_absolute_relative_error));
    return json;
}

}  // namespace

Json demo_json(const ReportData& report, const DemoOptions& options) {
    Json table = Json::list();
    for (const ObjectReport& object : report.objects) {
        for (const MethodReport& method : object.methods) {
            Json row = Json::object();
            row.set("object", Json(object.name));
            row.set("method", Json(method.method));
            row.set("converged", Json(method.converged));
            if (method.heldout) row.set("heldout", levels_json(*method.heldout));
            if (method.used) row.set("shots", levels_json(*method.used));
            if (method.truth_diffuse) row.set("truth_diffuse", truth_json(*method.truth_diffuse));
            table.push(std::move(row));
        }
    }
    Json json = Json::object();
    json.set("table1", std::move(table));
    json.set("report", Json(report_path(options)));
    return json;
}

std::string demo_text(const ReportData& report, const DemoOptions& options) {
    TextTable table({"object", "method", " held-out lamp", " used lamps", " paper", " Pd error"});
    for (const ObjectReport& object : report.objects) {
        for (const MethodReport& method : object.methods) {
            const auto paper = paper_table_1(object.name, method.method);
            table.add(
                {object.name,
                 method.method,
                 levels_text(method.heldout),
                 levels_text(method.used),
                 paper ? fmt::format("{} / {}", paper->levels_mean, paper->levels_variance) : "-",
                 method.truth_diffuse
                     ? fmt::format("{:.1f} %",
                                   100 * method.truth_diffuse->median_absolute_relative_error)
                     : "-"});
        }
    }
    return "Table 1: mean / variance of |real - synthetic| in 8-bit levels, the 99th percentile of "
           "the\nused images at level 230. This is our reading of the paper's table, on objects of "
           "our own; diffuse\nis its conventional method II, photon its own, gather ours. Pd "
           "error: median "
           "against the truth.\n\n" +
           table.text() + "\nreport: " + report_path(options) + "\n";
}

}  // namespace patina
