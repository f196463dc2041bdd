#include "patina/pipeline/plan_output.h"

#include "patina/base/output_file.h"
#include "patina/export/html_page.h"
#include "patina/export/lamp_map.h"
#include "patina/export/svg_plot.h"
#include "patina/scene/mesh_io.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {
namespace {

namespace fs = std::filesystem;

// The geometry and cameras of the capture with the chosen lamps, as a rig of its own.
void write_rig(const Capture& capture, const LightPlan& plan, const fs::path& folder) {
    CaptureDescription rig = capture.description;
    rig.shots.clear();
    rig.truth.reset();
    rig.lights.clear();
    for (const std::size_t light : plan.chosen) {
        rig.lights.push_back(capture.description.lights[light]);
    }
    GeometrySource& geometry = rig.geometry;
    if (geometry.range_file.empty()) {
        geometry.mesh_file = "geometry.ply";
        geometry.unwrap = false;
        write_ply(folder / geometry.mesh_file, capture.mesh);
    } else {
        const fs::path source = capture.description.folder / geometry.range_file;
        geometry.range_file = "range" + source.extension().string();
        write_file(folder / geometry.range_file, read_file(source));
    }
    write_capture_description(rig, folder);
}

// One value of every rule over the number of lamps.
template <typename Value>
Plot rule_plot(const LampStudy& study, const std::string& title, const Value& value) {
    Plot plot;
    plot.title = title;
    plot.x_axis = {"lamps besides those taken"};
    plot.y_axis = {"share of the seen texels [%]", AxisScale::linear, 0, 100};
    for (const RuleCurve& curve : study.curves) {
        PlotSeries series;
        series.label = curve.rule;
        for (std::size_t n = 0; n < curve.worth.size(); ++n) {
            series.x.push_back(double(n));
            series.y.push_back(100 * value(curve.worth[n]));
        }
        series.color = int(plot.series.size()) + 1;
        series.is_dashed = curve.rule == "random" || curve.rule == "uniform";
        plot.series.push_back(std::move(series));
    }
    plot.marks = {{double(study.plan.chosen.size()), "chosen"}};
    return plot;
}

std::string curves_html(const LampStudy& study) {
    const Plot known =
        rule_plot(study, "Ps known to 10 %", [](const PlanWorth& worth) { return worth.known; });
    const Plot specular = rule_plot(study, "Specular component measurable", [](const auto& worth) {
        return worth.share.specular;
    });
    const Plot diffuse = rule_plot(study, "Diffuse component measurable", [](const auto& worth) {
        return worth.share.diffuse;
    });
    return html_figure(plot_legend(known.series) + "<div class=\"row\">" + svg_plot(known) +
                           svg_plot(specular) + svg_plot(diffuse) + "</div>",
                       "Every rule at equal number of lamps. Known to 10 %: by the standard error "
                       "that the looks allow. Measurable: two lamps near the highlight, or one "
                       "away from it. Random: the median of many draws; uniform: spread evenly.");
}

std::string table_html(const Capture& capture, const LampStudy& study) {
    HtmlTable table;
    table.columns = {"Lamp",
                     "standard errors fall by",
                     "Ps known to 10 %",
                     "specular measurable",
                     "diffuse measurable"};
    const auto add = [&](const std::string& name, const std::string& drop, const PlanWorth& worth) {
        table.rows.push_back({{name,
                               drop,
                               format_percent(worth.known),
                               format_percent(worth.share.specular),
                               format_percent(worth.share.diffuse)}});
    };
    add("taken before", "", study.worth.front());
    for (std::size_t i = 0; i < study.plan.chosen.size(); ++i) {
        add(capture.description.lights[study.plan.chosen[i]].id,
            format_percent(study.drops[i]),
            study.worth[i + 1]);
    }
    add("all candidates", "", study.worth_with_all);
    return html_figure(html_table(table),
                       "In the order of choice, each with those before it. The fall is that of the "
                       "geometric mean of the standard errors of Pd, Ps and sigma.");
}

std::string map_html(const Capture& capture, const LampStudy& study) {
    SelectionReport selection;
    selection.lamps = capture.description.lights;
    selection.chosen = study.plan.chosen;
    selection.chosen_for_diffuse = study.plan.chosen_for_diffuse;
    selection.candidates = study.plan.candidates;
    selection.object_center = bounds_of(capture.mesh).center();
    selection.length_unit = length_unit_name(capture.description.length_unit);
    return html_figure(lamp_map(selection),
                       "The candidates as seen from the object, numbered in the order of choice; "
                       "the blue ones alone suffice for the diffuse component.");
}

}  // namespace

std::string lamp_directions_text(const Capture& capture, const LightPlan& plan) {
    const Vec3 center = bounds_of(capture.mesh).center();
    std::string text = fmt::format("{}\n", plan.chosen.size());
    for (const std::size_t index : plan.chosen) {
        const Light& light = capture.description.lights[index];
        const Vec3 w = direction_to(light, center);
        // The format separates fields by blanks.
        std::string name = light.id;
        std::replace(name.begin(), name.end(), ' ', '_');
        text += fmt::format("{} {:.9f} {:.9f} {:.9f}\n", name, w.x(), w.y(), w.z());
    }
    return text;
}

std::string plan_page(const Capture& capture, const LampStudy& study) {
    const std::string name = capture.description.name;
    const std::string title = name.empty() ? "Lamp plan" : "Lamp plan of " + name;
    return html_document(title,
                         "<h1>" + escape_html(title) + "</h1>",
                         {{"curves", "Lamps and what they show", curves_html(study)},
                          {"lamps", "Chosen lamps", table_html(capture, study)},
                          {"map", "Where they stand", map_html(capture, study)}});
}

void write_plan(const Capture& capture, const LampStudy& study, const fs::path& folder) {
    write_rig(capture, study.plan, folder);
    write_file(folder / "chosen.lp", lamp_directions_text(capture, study.plan));
    write_file(folder / "plan.html", plan_page(capture, study));
}

}  // namespace patina
