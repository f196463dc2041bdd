#include "patina/pipeline/estimate_capture.h"

#include "patina/base/check.h"
#include "patina/base/output_file.h"
#include "patina/base/parallel.h"
#include "patina/base/process_memory.h"
#include "patina/pipeline/text_table.h"
#include "patina/pipeline/version.h"
#include "patina/transport/gather_graph_file.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace patina {
namespace {

namespace fs = std::filesystem;

// Stores one number of every texel where the texel lies.
class MapWriter {
  public:
    MapWriter(const TexelAtlas& atlas, std::size_t texel)
        : column_(atlas.texels[texel].column), row_(atlas.texels[texel].row) {}

    void store(Image& map, double value) const { map.at(column_, row_) = float(value); }
    void store(Image& map, const Rgb& value) const {
        for (int channel = 0; channel < 3; ++channel) {
            map.at(column_, row_, channel) = float(value[channel]);
        }
    }

  private:
    int column_;
    int row_;
};

ReflectanceMaps make_maps(const TexelAtlas& atlas, const Estimate& estimate) {
    const std::size_t num_texels = atlas.texels.size();
    PATINA_CHECK_EQ(estimate.maps.size(), num_texels);
    PATINA_CHECK_EQ(estimate.errors.size(), num_texels);
    PATINA_CHECK_EQ(estimate.status.size(), num_texels);
    PATINA_CHECK_EQ(estimate.measurability.size(), num_texels);
    const Image three(atlas.width, atlas.height, 3);
    const Image one(atlas.width, atlas.height, 1);
    ReflectanceMaps maps{three, one, one, three, one, one, one, three, one};
    parallel_for(num_texels, [&](std::size_t i) {
        const MapWriter texel(atlas, i);
        texel.store(maps.diffuse, estimate.maps[i].diffuse);
        texel.store(maps.specular, estimate.maps[i].specular);
        texel.store(maps.roughness, estimate.maps[i].roughness);
        texel.store(maps.diffuse_stderr, estimate.errors[i].diffuse);
        texel.store(maps.specular_stderr, estimate.errors[i].specular);
        texel.store(maps.roughness_stderr, estimate.errors[i].roughness);
        texel.store(maps.status, double(estimate.status[i]));
        const ExpectedErrors& expected = estimate.measurability[i].errors;
        texel.store(maps.measurability,
                    Rgb(expected.diffuse, expected.specular, expected.roughness));
        texel.store(maps.reason, double(estimate.measurability[i].reason));
    });
    return maps;
}

Json iterations_json(const std::vector<IterationLog>& iterations) {
    Json list = Json::list();
    for (const IterationLog& turn : iterations) {
        Json item = Json::object();
        item.set("stage", Json(turn.stage));
        item.set("error", Json(turn.error));
        item.set("change", Json(turn.change));
        item.set("lambda", Json(turn.spectral_radius));
        item.set("damping", Json(turn.damping));
        item.set("retraced", Json(turn.retraced));
        list.push(std::move(item));
    }
    return list;
}

// How many texels there are of every reason but that of being off the surface.
Json reasons_json(const std::vector<TexelMeasurability>& measurability) {
    std::array<std::int64_t, kLobeReasons.size()> counts = {};
    for (const TexelMeasurability& texel : measurability) ++counts[std::size_t(texel.reason)];
    Json json = Json::object();
    for (const LobeReason reason : kLobeReasons) {
        if (reason == LobeReason::off_surface) continue;
        json.set(lobe_reason_name(reason), Json(counts[std::size_t(reason)]));
    }
    return json;
}

Json texels_json(const TexelAtlas& atlas, const Estimate& estimate) {
    std::array<std::int64_t, 4> by_status = {};
    const auto num_cells = std::int64_t(atlas.width) * std::int64_t(atlas.height);
    by_status[0] = num_cells - std::int64_t(atlas.texels.size());
    std::int64_t num_seen = 0;
    std::int64_t num_seen_measured = 0;
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        ++by_status[std::size_t(estimate.status[i])];
        if (estimate.seen[i] == 0) continue;
        ++num_seen;
        const bool is_measured = estimate.status[i] == TexelStatus::measured ||
                                 estimate.status[i] == TexelStatus::diffuse_measured;
        if (is_measured) ++num_seen_measured;
    }
    Json counts = Json::object();
    for (std::size_t status = 0; status < by_status.size(); ++status) {
        counts.set(fmt::format("{}", status), Json(by_status[status]));
    }
    Json texels = Json::object();
    texels.set("width", Json(atlas.width));
    texels.set("height", Json(atlas.height));
    texels.set("by_status", std::move(counts));
    texels.set("by_reason", reasons_json(estimate.measurability));
    texels.set("seen", Json(num_seen));
    texels.set("seen_measured_share",
               Json(num_seen > 0 ? double(num_seen_measured) / double(num_seen) : 0.0));
    texels.set("clamped", Json(std::int64_t(estimate.num_clamped)));
    return texels;
}

Json timing_json(const Progress& progress, const Estimate& estimate) {
    Json stages = Json::object();
    double total = 0;
    for (const StageTime& time : progress.stage_times()) {
        stages.set(time.stage, Json(time.seconds));
        total += time.seconds;
    }
    Json timing = Json::object();
    timing.set("stages_s", std::move(stages));
    timing.set("total_s", Json(total));
    timing.set("peak_memory_bytes", Json(peak_memory_bytes()));
    if (estimate.reckoned_memory) {
        timing.set("reckoned_memory_bytes", Json(std::int64_t(*estimate.reckoned_memory)));
    }
    return timing;
}

// Where no factor fits best, there is no standard error either.
Json scale_json(const ScaleEstimate& scale) {
    Json json = Json::object();
    json.set("told", Json(scale.told));
    json.set("factor", Json(scale.factor));
    if (std::isfinite(scale.standard_error)) {
        json.set("best_factor", Json(scale.best_factor));
        json.set("standard_error", Json(scale.standard_error));
    }
    if (!scale.told) {
        json.set("reason", Json(scale.reason));
        json.set("maps_up_to_common_factor", Json(true));
    }
    return json;
}

Json shared_lobe_json(const SharedLobe& lobe) {
    Json json = Json::object();
    json.set("specular_albedo", Json(lobe.specular_albedo));
    if (std::isfinite(lobe.standard_error)) {
        json.set("standard_error", Json(lobe.standard_error));
    }
    return json;
}

const char* error_name(SharedErrorKind kind) {
    switch (kind) {
        case SharedErrorKind::lamp_position:
            return "lamp position";
        case SharedErrorKind::lamp_direction:
            return "lamp direction";
        case SharedErrorKind::lamp_intensity:
            return "lamp intensity";
        case SharedErrorKind::image_shift:
            return "image shift";
    }
    return "";
}

Json calibration_json(std::span<const FoundError> errors) {
    Json list = Json::list();
    for (const FoundError& error : errors) {
        Json entry = Json::object();
        entry.set("error", Json(error_name(error.kind)));
        entry.set("id", Json(error.id));
        entry.set("axis", Json(std::int64_t(error.axis)));
        entry.set("stated", Json(error.stated));
        entry.set("value", Json(error.value));
        entry.set("standard_error", Json(error.standard_error));
        list.push(std::move(entry));
    }
    return list;
}

// Lamps: the root mean square over the lamps of what was found, and of what is still unknown, in
// stated standard deviations. Images: every shift.
void add_calibration_rows(const Json& calibration, TextTable& table) {
    double found = 0;
    double unknown = 0;
    double num_lamps = 0;
    std::map<std::string, std::vector<const Json*>> shifts;
    for (const Json& entry : calibration.items) {
        if (entry.find("error")->text == error_name(SharedErrorKind::image_shift)) {
            shifts[entry.find("id")->text].push_back(&entry);
            continue;
        }
        const double stated = entry.find("stated")->number;
        found += square(entry.find("value")->number / stated);
        unknown += square(entry.find("standard_error")->number / stated);
        num_lamps += 1;
    }
    if (num_lamps > 0) {
        table.add({"lamps put right by",
                   fmt::format("{:.2g} of their stated errors, known to {:.2g}",
                               std::sqrt(found / num_lamps),
                               std::sqrt(unknown / num_lamps))});
    }
    for (const auto& [camera, axes] : shifts) {
        table.add({"images of " + camera,
                   fmt::format("lie on the geometry when moved by {:.2f}, {:.2f} pixels "
                               "(+- {:.2f}, {:.2f})",
                               axes[0]->find("value")->number,
                               axes[1]->find("value")->number,
                               axes[0]->find("standard_error")->number,
                               axes[1]->find("standard_error")->number)});
    }
}

std::string scale_words(const Json& scale) {
    if (!scale.find("told")->boolean) return "not told: " + scale.find("reason")->text;
    return fmt::format("lamps {:.4g} times as strong as stated, standard error {:.1f} %",
                       scale.find("factor")->number,
                       100 * scale.find("standard_error")->number);
}

// The result's folder is replaced as a whole, with all that lies in it.
void check_graph_file(const fs::path& file, const fs::path& result) {
    const fs::path inside = fs::weakly_canonical(fs::absolute(file))
                                .lexically_relative(fs::weakly_canonical(fs::absolute(result)));
    if (inside.empty() || *inside.begin() != "..") {
        throw Error("--graph", "", "lies in the result's folder", "a place beside it");
    }
    check_gather_graph_file(file);
}

Json make_json(const Capture& capture, const EstimateOptions& options, const Estimate& estimate) {
    EstimateOptions copy = options;
    Json json = Json::object();
    json.set("format", Json("patina-result"));
    json.set("version", Json(1));
    json.set("name", Json(capture.description.name));
    json.set("program_version", Json(program_version()));
    json.set("method", Json(method_name(options.method)));
    json.set("seed", Json(std::int64_t(options.photons.seed)));
    json.set("settings", settings_of(estimate_option_table(copy)));
    json.set("converged", Json(estimate.converged));
    json.set("lambda",
             Json(estimate.iterations.empty() ? 0.0 : estimate.iterations.back().spectral_radius));
    json.set("noise_scale", Json(estimate.noise_scale));
    json.set("noise_own", Json(estimate.noise_own));
    json.set("noise_shared", Json(estimate.noise_shared));
    json.set("lobe_misfit", Json(estimate.lobe_misfit));
    if (!estimate.calibration.empty()) {
        json.set("calibration", calibration_json(estimate.calibration));
    }
    if (estimate.scale) json.set("scale", scale_json(*estimate.scale));
    if (estimate.shared_lobe) {
        json.set("shared_lobe", shared_lobe_json(*estimate.shared_lobe));
    }
    json.set("texels", texels_json(capture.atlas, estimate));
    json.set("iterations", iterations_json(estimate.iterations));
    return json;
}

}  // namespace

Result make_result(const Capture& capture,
                   const EstimateOptions& options,
                   const Estimate& estimate) {
    Result result;
    result.maps = make_maps(capture.atlas, estimate);
    result.mesh = capture.mesh;
    result.name = capture.description.name;
    if (estimate.scale) result.lamp_factor = estimate.scale->factor;
    result.noise = {estimate.noise_scale, estimate.noise_own, estimate.noise_shared};
    result.json = to_text(make_json(capture, options, estimate));
    return result;
}

Json estimate_capture(const fs::path& capture_path,
                      const fs::path& result_path,
                      const EstimateOptions& given,
                      Progress& progress) {
    EstimateOptions options = given;
    const bool keeps_graph = options.method == Method::gather && options.graph_file != kNoGraph;
    if (options.graph_file == kNoGraph) options.graph_file.clear();
    validate(options);
    OutputFolder folder(result_path, "-o");
    if (keeps_graph) {
        if (options.graph_file.empty()) {
            options.graph_file = folder.target();
            options.graph_file += ".graph";
        }
        check_graph_file(options.graph_file, folder.target());
    }
    progress.begin_stage("read geometry");
    const Capture capture = load_capture(capture_path);
    progress.end_stage(fmt::format("{}, {} triangles, {} texels",
                                   capture.description.name,
                                   capture.mesh.triangles.size(),
                                   capture.atlas.texels.size()));
    const Estimate estimate = estimate_reflectance(capture, options, progress);
    Json json = make_json(capture, options, estimate);
    json.set("timing", timing_json(progress, estimate));
    Result result = make_result(capture, options, estimate);
    result.json = to_text(json);
    write_result(folder.path(), result);
    folder.commit();
    return json;
}

std::string estimate_text(const Json& result) {
    const Json& texels = *result.find("texels");
    const Json& by_status = *texels.find("by_status");
    TextTable table({"", ""});
    table.add({"capture", result.find("name")->text});
    table.add({"method", result.find("method")->text});
    table.add({"converged", result.find("converged")->boolean ? "yes" : "no"});
    table.add({"turns", fmt::format("{}", result.find("iterations")->items.size())});
    table.add({"lambda", fmt::format("{:.3f}", result.find("lambda")->number)});
    if (const Json* const lobe = result.find("shared_lobe")) {
        const double albedo = lobe->find("specular_albedo")->number;
        table.add({"lobe, seen by no look",
                   albedo > 0 ? fmt::format("Ps sigma^2 = {:.3g} by bounced light", albedo)
                              : std::string("not told by bounced light")});
    }
    if (const Json* const scale = result.find("scale")) {
        table.add({"absolute scale", scale_words(*scale)});
    }
    if (const Json* const calibration = result.find("calibration")) {
        add_calibration_rows(*calibration, table);
    }
    if (const double misfit = result.find("lobe_misfit")->number; misfit > 1) {
        table.add({"lobes of another shape",
                   fmt::format("errors of Ps and sigma enlarged {:.2g} times", misfit)});
    }
    table.add({"measured (status 1)", fmt::format("{} texels", by_status.find("1")->integer)});
    table.add({"diffuse measured (2)", fmt::format("{} texels", by_status.find("2")->integer)});
    table.add({"filled (3)", fmt::format("{} texels", by_status.find("3")->integer)});
    const Json& by_reason = *texels.find("by_reason");
    for (const LobeReason reason : kLobeReasons) {
        const Json* const count = by_reason.find(lobe_reason_name(reason));
        if (count == nullptr || count->integer == 0) continue;
        table.add({fmt::format("lobe: {}", lobe_reason_words(reason)),
                   fmt::format("{} texels", count->integer)});
    }
    table.add({"seen texels measured",
               fmt::format("{:.1f} %", 100 * texels.find("seen_measured_share")->number)});
    table.add(
        {"held in the feasible set", fmt::format("{} texels", texels.find("clamped")->integer)});
    table.add({"time", fmt::format("{:.1f} s", result.find("timing")->find("total_s")->number)});
    return table.text();
}

}  // namespace patina
