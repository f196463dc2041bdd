#include "patina/pipeline/plan_output.h"

#include "patina/base/output_file.h"
#include "patina/export/html_page.h"
#include "patina/export/lamp_map.h"
#include "patina/export/lamp_rules.h"
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

std::vector<LampRule> lamp_rules(const LampStudy& study) {
    std::vector<LampRule> rules;
    for (const RuleCurve& curve : study.curves) {
        LampRule& rule = rules.emplace_back();
        rule.rule = curve.rule;
        for (const PlanWorth& worth : curve.worth) {
            rule.known.push_back(worth.known);
            rule.specular.push_back(worth.share.specular);
            rule.diffuse.push_back(worth.share.diffuse);
        }
    }
    return rules;
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

std::string map_html(const SelectionReport& selection) {
    return html_figure(lamp_map(selection),
                       "The candidates as seen from the object, numbered in the order of choice; "
                       "the blue ones alone suffice for the diffuse component.");
}

}  // namespace

SelectionReport selection_report(const Capture& capture, const LampStudy& study) {
    const LightPlan& plan = study.plan;
    SelectionReport selection;
    selection.lamps = capture.description.lights;
    selection.chosen = plan.chosen;
    selection.chosen_for_diffuse = plan.chosen_for_diffuse;
    selection.candidates = plan.candidates;
    for (const MeasurableShare& share : plan.shares) {
        selection.shares.emplace_back(share.diffuse, share.specular);
    }
    selection.share_with_all = {plan.share_with_all.diffuse, plan.share_with_all.specular};
    selection.object_center = bounds_of(capture.mesh).center();
    selection.length_unit = length_unit_name(capture.description.length_unit);
    selection.rules = lamp_rules(study);
    return selection;
}

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
    const SelectionReport selection = selection_report(capture, study);
    const std::string name = capture.description.name;
    const std::string title = name.empty() ? "Lamp plan" : "Lamp plan of " + name;
    return html_document(title,
                         "<h1>" + escape_html(title) + "</h1>",
                         {{"curves",
                           "Lamps and what they show",
                           lamp_rule_charts(selection.rules, selection.chosen.size())},
                          {"lamps", "Chosen lamps", table_html(capture, study)},
                          {"map", "Where they stand", map_html(selection)}});
}

void write_plan(const Capture& capture, const LampStudy& study, const fs::path& folder) {
    write_rig(capture, study.plan, folder);
    write_file(folder / "chosen.lp", lamp_directions_text(capture, study.plan));
    write_file(folder / "plan.html", plan_page(capture, study));
}

}  // namespace patina
