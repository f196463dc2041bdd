#include "patina/pipeline/plan_lamps.h"

#include "patina/base/output_file.h"
#include "patina/pipeline/text_table.h"
#include "patina/scene/mesh_io.h"

#include <fmt/format.h>

#include <optional>

namespace patina {
namespace {

namespace fs = std::filesystem;

Json share_json(const MeasurableShare& share) {
    Json json = Json::object();
    json.set("diffuse", Json(share.diffuse));
    json.set("specular", Json(share.specular));
    return json;
}

Json position_json(const Light& light) {
    const Vec3 p =
        light.type == LightType::point ? light.position : light.direction.value_or(Vec3::Zero());
    Json json = Json::list();
    for (const double coordinate : p) json.push(Json(coordinate));
    return json;
}

std::vector<std::size_t> lights_named(const std::string& ids, const std::vector<Light>& lights) {
    std::vector<std::size_t> found;
    std::size_t begin = 0;
    while (begin < ids.size()) {
        const std::size_t end = std::min(ids.find(',', begin), ids.size());
        const std::string id = ids.substr(begin, end - begin);
        const auto light = std::find_if(
            lights.begin(), lights.end(), [&](const Light& other) { return other.id == id; });
        if (light == lights.end()) {
            throw Error("--taken", "", "names " + quote(id), "ids of lamps with commas between");
        }
        found.push_back(std::size_t(light - lights.begin()));
        begin = end + 1;
    }
    return found;
}

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

Json plan_json(const Capture& capture, const LightPlan& plan) {
    const std::vector<Light>& lights = capture.description.lights;
    Json chosen = Json::list();
    for (std::size_t i = 0; i < plan.chosen.size(); ++i) {
        const Light& light = lights[plan.chosen[i]];
        Json item = Json::object();
        item.set("light", Json(light.id));
        item.set(light.type == LightType::point ? "position" : "direction", position_json(light));
        item.set("measurable", share_json(plan.shares[i]));
        chosen.push(std::move(item));
    }
    Json for_diffuse = Json::list();
    for (const std::size_t light : plan.chosen_for_diffuse)
        for_diffuse.push(Json(lights[light].id));
    Json json = Json::object();
    json.set("name", Json(capture.description.name));
    json.set("candidates", Json(std::int64_t(plan.candidates.size())));
    json.set("seen_texels", Json(std::int64_t(plan.num_seen)));
    json.set("chosen", std::move(chosen));
    json.set("chosen_for_diffuse", std::move(for_diffuse));
    json.set("measurable_before", share_json(plan.share_before));
    json.set("measurable", share_json(plan.share()));
    json.set("measurable_with_all", share_json(plan.share_with_all));
    if (plan.next) {
        Json next = Json::object();
        next.set("light", Json(lights[plan.next->light].id));
        next.set("measurable", share_json(plan.next->share));
        json.set("next", std::move(next));
    }
    return json;
}

std::vector<std::string> share_cells(const Json& share) {
    return {fmt::format("{:.1f} %", 100 * share.find("diffuse")->number),
            fmt::format("{:.1f} %", 100 * share.find("specular")->number)};
}

std::string position_text(const Json& light) {
    const Json* const position = light.find("position");
    std::string text = position != nullptr ? "at" : "towards";
    for (const Json& coordinate :
         (position != nullptr ? *position : *light.find("direction")).items) {
        text += fmt::format(" {:.4g}", coordinate.number);
    }
    return text;
}

}  // namespace

OptionTable plan_option_table(PlanOptions& options) {
    CoverOptions& cover = options.cover;
    return {
        with_letter(path_option("output",
                                "DIR",
                                options.output,
                                "write a rig.json of the chosen lamps and the geometry there"),
                    "o"),
        text_option("taken",
                    "ID,ID",
                    options.taken,
                    "lamps that were shot already: they count and are not chosen again"),
        number_option(
            "roughness", cover.roughness, above(0), "rad", "sigma that is expected of the surface"),
        number_option("specular_reach",
                      cover.specular_reach,
                      above(0),
                      "",
                      "theta_r below this many sigma shows the highlight"),
        number_option("diffuse_reach",
                      cover.diffuse_reach,
                      above(0),
                      "",
                      "theta_r above this many sigma shows none"),
        integer_option("specular_need",
                       cover.specular_need,
                       between(1, 255),
                       "lamps that must show a texel's highlight"),
        integer_option("diffuse_need",
                       cover.diffuse_need,
                       between(1, 255),
                       "lamps that must show a texel without highlight"),
        number_option("min_gain",
                      cover.min_gain,
                      at_least(0),
                      "",
                      "stop when a lamp adds less, as a share of the seen texels"),
        number_option("enough",
                      cover.enough,
                      Range{0, 1, true},
                      "",
                      "stop at this share of what all candidates can measure"),
        angle_option("max_light_angle",
                     cover.max_light_angle,
                     between(1, 90),
                     "leave out light further from the normal"),
        angle_option("max_view_angle",
                     cover.max_view_angle,
                     between(1, 90),
                     "leave out views further from the normal"),
    };
}

CaptureDescription read_capture_or_rig(const fs::path& path) {
    const bool is_rig = path.filename() == "rig.json" ||
                        (fs::exists(path / "rig.json") && !fs::exists(path / "capture.json"));
    return is_rig ? read_rig_description(path) : read_capture_description(path);
}

Json plan_lamps(const fs::path& path, const PlanOptions& options, Progress& progress) {
    std::optional<OutputFolder> folder;
    if (!options.output.empty()) folder.emplace(options.output, "-o");
    progress.begin_stage("read geometry");
    const Capture capture = load_capture(read_capture_or_rig(path));
    progress.end_stage(fmt::format("{} texels", capture.atlas.texels.size()));
    CoverOptions cover = options.cover;
    cover.taken = lights_named(options.taken, capture.description.lights);
    const LightPlan plan = plan_lights(capture, cover, progress);
    if (folder) {
        write_rig(capture, plan, folder->path());
        folder->commit();
    }
    return plan_json(capture, plan);
}

std::string plan_text(const Json& plan) {
    TextTable table({"lamp", "where", " diffuse", " specular"});
    const auto add = [&](const std::string& lamp, const std::string& where, const Json& share) {
        const std::vector<std::string> cells = share_cells(share);
        table.add({lamp, where, cells[0], cells[1]});
    };
    for (const Json& light : plan.find("chosen")->items) {
        add(light.find("light")->text, position_text(light), *light.find("measurable"));
    }
    add("all candidates", "", *plan.find("measurable_with_all"));
    if (const Json* const next = plan.find("next")) {
        add("next best: " + next->find("light")->text, "", *next->find("measurable"));
    }
    return fmt::format(
               "{} of {} lamps, {} of them for the diffuse component alone;\n"
               "share of {} seen texels that is measurable after each:\n\n",
               plan.find("chosen")->items.size(),
               plan.find("candidates")->integer,
               plan.find("chosen_for_diffuse")->items.size(),
               plan.find("seen_texels")->integer) +
           table.text();
}

}  // namespace patina
