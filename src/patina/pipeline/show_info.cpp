#include "patina/pipeline/show_info.h"

#include "patina/base/output_file.h"
#include "patina/capture/capture.h"
#include "patina/capture/result_folder.h"
#include "patina/export/picture.h"
#include "patina/math/statistics.h"
#include "patina/pipeline/pictures.h"
#include "patina/pipeline/plan_given.h"
#include "patina/pipeline/text_table.h"

#include <fmt/format.h>

namespace patina {
namespace {

namespace fs = std::filesystem;

constexpr int kSheetCell = 240;          // [pixels]
constexpr double kWhiteShare = 0.99;     // of an image's values are darker than its white
constexpr double kRoughnessWhite = 0.5;  // on the sheet of a result [rad]

const char* model_name(CameraModel model) {
    switch (model) {
        case CameraModel::pinhole:
            return "pinhole";
        case CameraModel::orthographic:
            return "orthographic";
        case CameraModel::registered:
            return "registered";
    }
    return "";
}

Json geometry_json(const Capture& capture) {
    const GeometrySource& geometry = capture.description.geometry;
    const Bounds bounds = bounds_of(capture.mesh);
    Json json = Json::object();
    json.set("file", Json(geometry.range_file.empty() ? geometry.mesh_file : geometry.range_file));
    json.set("triangles", Json(std::int64_t(capture.mesh.triangles.size())));
    Json size = Json::list();
    for (const double length : Vec3(bounds.high - bounds.low)) size.push(Json(length));
    json.set("size", std::move(size));
    Json domain = Json::list();
    domain.push(Json(capture.atlas.width));
    domain.push(Json(capture.atlas.height));
    json.set("texel_domain", std::move(domain));
    json.set("texels", Json(std::int64_t(capture.atlas.texels.size())));
    return json;
}

void add_devices(const CaptureDescription& description, Json& json) {
    Json cameras = Json::list();
    for (const Camera& camera : description.cameras) {
        cameras.push(Json(fmt::format("{}: {}, {} x {}{}",
                                      camera.id,
                                      model_name(camera.model),
                                      camera.width,
                                      camera.height,
                                      camera.frame == FrameOfReference::scanner ? ", turns" : "")));
    }
    json.set("cameras", std::move(cameras));
    Json lights = Json::list();
    for (const Light& light : description.lights) {
        lights.push(Json(fmt::format("{}: {}{}",
                                     light.id,
                                     light.type == LightType::point ? "point" : "directional",
                                     light.frame == FrameOfReference::scanner ? ", turns" : "")));
    }
    json.set("lights", std::move(lights));
}

Json capture_json(const Capture& capture) {
    const CaptureDescription& description = capture.description;
    Json json = Json::object();
    json.set("kind", Json(description.shots.empty() ? "rig" : "capture"));
    json.set("name", Json(description.name));
    json.set("length_unit", Json(length_unit_name(description.length_unit)));
    json.set("geometry", geometry_json(capture));
    add_devices(description, json);
    std::int64_t num_heldout = 0;
    for (const Shot& shot : description.shots) num_heldout += shot.heldout ? 1 : 0;
    json.set("shots", Json(std::int64_t(description.shots.size())));
    json.set("heldout", Json(num_heldout));
    json.set("noise_stated", Json(description.radiometry.has_noise));
    json.set("scale_unknown", Json(description.radiometry.scale_unknown));
    json.set("truth", Json(description.truth.has_value()));
    return json;
}

// Each image with its own brightest hundredth as white, as exposures may differ.
Image shot_picture(const CaptureDescription& description, std::size_t shot) {
    const RadianceImage image = load_radiance(description, shot);
    std::vector<double> values;
    for (std::size_t i = 0; i < image.radiance.data.size(); ++i) {
        if (image.usable[i / 3] != 0) values.push_back(double(image.radiance.data[i]));
    }
    const double white = values.empty() ? 0 : quantile(std::move(values), kWhiteShare);
    return display_image({image.radiance, image.usable}, white > 0 ? white : 1);
}

std::vector<Image> capture_pictures(const Capture& capture, Progress& progress) {
    const std::size_t num_shots = capture.description.shots.size();
    if (num_shots == 0) {
        throw Error("-o", "", "asks for a contact sheet of a rig", "a capture or a result");
    }
    progress.begin_stage("read images", num_shots, "images");
    std::vector<Image> pictures;
    for (std::size_t i = 0; i < num_shots; ++i) {
        throw_if_interrupted();
        pictures.push_back(shot_picture(capture.description, i));
        progress.advance(1);
    }
    progress.end_stage(fmt::format("{} images", num_shots));
    return pictures;
}

Json result_info(const Result& result, const std::string& place) {
    const Json document = parse_json(result.json, place);
    Json json = Json::object();
    json.set("kind", Json("result"));
    for (const std::string& name : document.names) {
        const bool is_told = name != "format" && name != "version" && name != "settings" &&
                             name != "iterations" && name != "timing";
        if (is_told) json.set(name, *document.find(name));
    }
    if (const Json* const iterations = document.find("iterations")) {
        json.set("turns", Json(std::int64_t(iterations->items.size())));
    }
    Json domain = Json::list();
    domain.push(Json(result.maps.status.width));
    domain.push(Json(result.maps.status.height));
    json.set("texel_domain", std::move(domain));
    json.set("triangles", Json(std::int64_t(result.mesh.triangles.size())));
    return json;
}

std::vector<Image> result_pictures(const Result& result) {
    const auto white_of = [](const Image& map) {
        std::vector<double> values;
        for (const float value : map.data) {
            if (value > 0) values.push_back(double(value));
        }
        return values.empty() ? 1.0 : quantile(std::move(values), kWhiteShare);
    };
    const ReflectanceMaps& maps = result.maps;
    return {display_image({maps.diffuse, {}}, 1),
            display_image({maps.specular, {}}, white_of(maps.specular)),
            display_image({maps.roughness, {}}, kRoughnessWhite),
            display_image({maps.status, {}}, double(TexelStatus::filled))};
}

void write_sheet(const std::vector<Image>& pictures, OutputFolder& folder) {
    write_png(folder.path() / "sheet.png", contact_sheet(pictures, kSheetCell));
    folder.commit();
}

// Numbers with six digits: what a reader takes in.
std::string value_text(const Json& item) {
    if (item.kind == JsonKind::text) return item.text;
    if (item.kind == JsonKind::boolean) return item.boolean ? "yes" : "no";
    if (item.kind == JsonKind::list) {
        std::string text;
        for (const Json& part : item.items) text += (text.empty() ? "" : " x ") + value_text(part);
        return text;
    }
    return item.kind == JsonKind::null ? "-" : fmt::format("{:.6g}", item.number);
}

// "name  value" lines; fields of objects and of lists are indented.
void add_lines(const Json& json, const std::string& indent, TextTable& table) {
    for (std::size_t i = 0; i < json.items.size(); ++i) {
        const Json& item = json.items[i];
        const std::string name = indent + (json.kind == JsonKind::object ? json.names[i] : "");
        const bool is_long_list = item.kind == JsonKind::list && !item.items.empty() &&
                                  item.items.front().kind == JsonKind::text;
        if (item.kind == JsonKind::object || is_long_list) {
            table.add({name, is_long_list ? fmt::format("{}", item.items.size()) : ""});
            add_lines(item, indent + "  ", table);
        } else {
            table.add({name, value_text(item)});
        }
    }
}

}  // namespace

OptionTable info_option_table(InfoOptions& options) {
    return {with_letter(
        path_option("output", "DIR", options.output, "write a contact sheet, sheet.png, there"),
        "o")};
}

Json show_info(const fs::path& path, const InfoOptions& options, Progress& progress) {
    std::optional<OutputFolder> folder;
    if (!options.output.empty()) folder.emplace(options.output, "-o");
    if (path.filename() == "result.json" || fs::exists(path / "result.json")) {
        const Result result = read_result(path);
        if (folder) write_sheet(result_pictures(result), *folder);
        return result_info(result, path.string());
    }
    progress.begin_stage("read geometry");
    const Capture capture = load_capture(read_capture_or_rig(path));
    progress.end_stage(fmt::format("{} texels", capture.atlas.texels.size()));
    if (folder) write_sheet(capture_pictures(capture, progress), *folder);
    return capture_json(capture);
}

std::string info_text(const Json& info) {
    TextTable table({"", ""});
    add_lines(info, "", table);
    return table.text();
}

}  // namespace patina
