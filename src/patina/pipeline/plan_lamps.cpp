#include "patina/pipeline/plan_lamps.h"

#include "patina/base/output_file.h"
#include "patina/capture/result_folder.h"
#include "patina/pipeline/plan_given.h"
#include "patina/pipeline/plan_output.h"
#include "patina/pipeline/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

// JSON has no infinity; null stands for it.
Json finite_json(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json errors_json(const ErrorSummary& errors) {
    Json json = Json::object();
    json.set("diffuse", finite_json(errors.diffuse));
    json.set("specular", finite_json(errors.specular));
    json.set("roughness", finite_json(errors.roughness));
    return json;
}

Json chosen_json(const std::vector<Light>& lights, const LampStudy& study) {
    Json chosen = Json::list();
    for (std::size_t i = 0; i < study.plan.chosen.size(); ++i) {
        const Light& light = lights[study.plan.chosen[i]];
        Json item = Json::object();
        item.set("light", Json(light.id));
        item.set(light.type == LightType::point ? "position" : "direction", position_json(light));
        item.set("measurable", share_json(study.plan.shares[i]));
        item.set("known", Json(study.worth[i + 1].known));
        item.set("error_drop", Json(study.drops[i]));
        chosen.push(std::move(item));
    }
    return chosen;
}

// worth[n] of each rule, as lists over n.
Json curves_json(const std::vector<RuleCurve>& curves) {
    Json json = Json::list();
    for (const RuleCurve& curve : curves) {
        Json known = Json::list();
        Json diffuse = Json::list();
        Json specular = Json::list();
        for (const PlanWorth& worth : curve.worth) {
            known.push(Json(worth.known));
            diffuse.push(Json(worth.share.diffuse));
            specular.push(Json(worth.share.specular));
        }
        Json item = Json::object();
        item.set("rule", Json(curve.rule));
        item.set("known", std::move(known));
        item.set("diffuse", std::move(diffuse));
        item.set("specular", std::move(specular));
        json.push(std::move(item));
    }
    return json;
}

Json next_looks_json(const PlanScene& scene, const LampStudy& study) {
    Json json = Json::list();
    for (const NextLook& look : study.next) {
        const std::string& id = look.is_camera ? scene.new_cameras[look.index].id
                                               : scene.capture.description.lights[look.index].id;
        Json item = Json::object();
        item.set(look.is_camera ? "camera" : "light", Json(id));
        item.set("gain", Json(look.gain));
        item.set("errors", errors_json(look.errors));
        item.set("known", Json(look.known));
        json.push(std::move(item));
    }
    return json;
}

Json plan_json(const PlanScene& scene, const LampStudy& study, const PlanOptions& options) {
    const std::vector<Light>& lights = scene.capture.description.lights;
    const LightPlan& plan = study.plan;
    Json for_diffuse = Json::list();
    for (const std::size_t light : plan.chosen_for_diffuse) {
        for_diffuse.push(Json(lights[light].id));
    }
    Json json = Json::object();
    json.set("name", Json(scene.capture.description.name));
    json.set("rule", Json(choice_name(plan_rules(), options.study.rule)));
    json.set("candidates", Json(std::int64_t(plan.candidates.size())));
    json.set("seen_texels", Json(std::int64_t(plan.num_seen)));
    json.set("chosen", chosen_json(lights, study));
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
    json.set("known_before", Json(study.worth.front().known));
    json.set("known", Json(study.worth.back().known));
    json.set("known_with_all", Json(study.worth_with_all.known));
    json.set("errors_before", errors_json(study.errors_before));
    json.set("errors", errors_json(study.errors));
    json.set("plan_texels", Json(std::int64_t(study.num_texels)));
    json.set("read_stddev", Json(study.read_stddev));
    json.set("curves", curves_json(study.curves));
    if (!options.given.empty()) json.set("next_looks", next_looks_json(scene, study));
    return json;
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

// The maps of a result, at the texels of the capture's atlas.
std::vector<Reflectance> read_maps(const fs::path& path, const Capture& capture) {
    const ReflectanceMaps maps = read_result(path).maps;
    const TexelAtlas& atlas = capture.atlas;
    if (maps.diffuse.width != atlas.width || maps.diffuse.height != atlas.height) {
        throw Error("--maps",
                    "",
                    fmt::format("{} has {} x {} texels",
                                quote(path.string()),
                                maps.diffuse.width,
                                maps.diffuse.height),
                    fmt::format("{} x {}", atlas.width, atlas.height));
    }
    std::vector<Reflectance> reflectances;
    for (const Texel& texel : atlas.texels) {
        const std::size_t i = maps.specular.index(texel.column, texel.row);
        Reflectance reflectance;
        for (std::size_t c = 0; c < 3; ++c) {
            reflectance.diffuse[Eigen::Index(c)] = double(maps.diffuse.data[3 * i + c]);
        }
        reflectance.specular = double(maps.specular.data[i]);
        reflectance.roughness = std::max(double(maps.roughness.data[i]), kMinRoughness);
        reflectances.push_back(reflectance);
    }
    return reflectances;
}

std::string percent_text(const Json& share) {
    return share.kind == JsonKind::null ? "-" : fmt::format("{:.1f} %", 100 * share.number);
}

std::string chosen_text(const Json& plan) {
    TextTable table({"lamp", "where", " diffuse", " specular", " Ps to 10 %"});
    const auto add = [&](const std::string& lamp,
                         const std::string& where,
                         const Json& share,
                         const std::string& known) {
        table.add({lamp,
                   where,
                   percent_text(*share.find("diffuse")),
                   percent_text(*share.find("specular")),
                   known});
    };
    for (const Json& light : plan.find("chosen")->items) {
        add(light.find("light")->text,
            position_text(light),
            *light.find("measurable"),
            percent_text(*light.find("known")));
    }
    add("all candidates",
        "",
        *plan.find("measurable_with_all"),
        percent_text(*plan.find("known_with_all")));
    if (const Json* const next = plan.find("next")) {
        add("next best: " + next->find("light")->text, "", *next->find("measurable"), "");
    }
    return table.text();
}

// The rules at the number of lamps that was chosen, or as far as each goes.
std::string rules_text(const Json& plan) {
    TextTable table({"rule", " lamps", " diffuse", " specular", " Ps to 10 %"});
    const std::size_t num_chosen = plan.find("chosen")->items.size();
    for (const Json& curve : plan.find("curves")->items) {
        const std::size_t n = std::min(num_chosen, curve.find("known")->items.size() - 1);
        table.add({curve.find("rule")->text,
                   fmt::format("{}", n),
                   percent_text(curve.find("diffuse")->items[n]),
                   percent_text(curve.find("specular")->items[n]),
                   percent_text(curve.find("known")->items[n])});
    }
    return table.text();
}

std::string next_looks_text(const Json& plan) {
    TextTable table({"one more", " sd(Pd)", " sd(Ps)", " sd(sigma)", " Ps to 10 %"});
    const auto add = [&](const std::string& name, const Json& errors, const Json& known) {
        table.add({name,
                   percent_text(*errors.find("diffuse")),
                   percent_text(*errors.find("specular")),
                   percent_text(*errors.find("roughness")),
                   percent_text(known)});
    };
    add("(as it is)", *plan.find("errors_before"), *plan.find("known_before"));
    for (const Json& look : plan.find("next_looks")->items) {
        const Json* const camera = look.find("camera");
        add(camera != nullptr ? "camera " + camera->text : "lamp " + look.find("light")->text,
            *look.find("errors"),
            *look.find("known"));
    }
    return table.text();
}

}  // namespace

Json plan_lamps(const fs::path& path, const PlanOptions& options, Progress& progress) {
    if (!options.given.empty() && !options.taken.empty()) {
        throw Error("--taken", "", "is given besides --given", "one of the two");
    }
    std::optional<OutputFolder> folder;
    if (!options.output.empty()) folder.emplace(options.output, "-o");
    progress.begin_stage("read geometry");
    const PlanScene scene = read_plan_scene(path, options.stand, options.given);
    progress.end_stage(fmt::format("{} texels", scene.capture.atlas.texels.size()));
    StudyOptions study_options = options.study;
    study_options.shots_are_taken = !options.given.empty();
    if (options.given.empty()) study_options.num_next = 0;
    study_options.cover.taken = options.given.empty()
                                    ? lights_named(options.taken, scene.capture.description.lights)
                                    : scene.taken;
    if (!options.maps.empty()) study_options.maps = read_maps(options.maps, scene.capture);
    const LampStudy study = study_lamps(scene.capture, scene.new_cameras, study_options, progress);
    if (folder) {
        write_plan(scene.capture, study, folder->path());
        folder->commit();
    }
    return plan_json(scene, study, options);
}

std::string plan_text(const Json& plan) {
    std::string text = fmt::format(
        "{} of {} lamps by {}, {} of them for the diffuse component alone;\n"
        "share of {} seen texels that is measurable after each, and with Ps known to 10 %:\n\n",
        plan.find("chosen")->items.size(),
        plan.find("candidates")->integer,
        plan.find("rule")->text,
        plan.find("chosen_for_diffuse")->items.size(),
        plan.find("seen_texels")->integer);
    text += chosen_text(plan) + "\nthe rules at equal number:\n\n" + rules_text(plan);
    if (plan.find("next_looks") != nullptr) {
        text +=
            "\nmedian standard errors with one more lamp or camera:\n\n" + next_looks_text(plan);
    }
    return text;
}

}  // namespace patina
