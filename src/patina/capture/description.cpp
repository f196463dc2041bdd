#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/capture/capture.h"
#include "patina/capture/description_parts.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScannerNeeds = "a cylindrical range image";

void read_shot_lights(const JsonField& field, const std::vector<std::string>& ids, Shot& shot) {
    const bool one = field["light"].present();
    if (one && field["lights"].present()) {
        field.fail("has both \"light\" and \"lights\"", "one of them");
    }
    if (!one && !field["lights"].present()) {
        field.fail("has neither \"light\" nor \"lights\"", "one of them");
    }
    if (one) {
        shot.lights = {read_id_field(field["light"], ids, "light")};
        return;
    }
    const std::vector<JsonField> items = field["lights"].list("a list of ids of lights");
    if (items.empty()) field["lights"].fail("is empty", "at least one id of a light");
    for (const JsonField& item : items) {
        const std::size_t light = read_id_field(item, ids, "light");
        if (std::find(shot.lights.begin(), shot.lights.end(), light) != shot.lights.end()) {
            item.fail("is " + quote(ids[light]) + " for the second time", "each light once");
        }
        shot.lights.push_back(light);
    }
    std::sort(shot.lights.begin(), shot.lights.end());
}

void check_shot_frames(const JsonField& field,
                       const CaptureDescription& description,
                       const Shot& shot) {
    const Camera& camera = description.cameras[shot.camera];
    if (camera.frame == FrameOfReference::scanner) return;
    for (const std::size_t light : shot.lights) {
        if (description.lights[light].frame != FrameOfReference::scanner) continue;
        field["camera"].fail(quote(camera.id) + " stands still while light " +
                                 quote(description.lights[light].id) + " turns with the scanner",
                             "a registered camera with \"frame\": \"scanner\"");
    }
}

Shot read_shot(const JsonField& field, const CaptureDescription& description) {
    field.allow_only({"image", "camera", "light", "lights", "exposure", "mask", "dark", "heldout"});
    Shot shot;
    shot.camera = read_id_field(field["camera"], ids_of(description.cameras), "camera");
    read_shot_lights(field, ids_of(description.lights), shot);
    check_shot_frames(field, description, shot);
    const Camera& camera = description.cameras[shot.camera];
    const std::string owner =
        camera.model == CameraModel::registered ? "the texel domain" : "camera " + quote(camera.id);
    const auto read_name = [&](const char* name) {
        const JsonField file = field[name];
        check_image_field(file, description.folder, camera.width, camera.height, owner);
        return file.text();
    };
    shot.image = read_name("image");
    if (field["mask"].present()) shot.mask = read_name("mask");
    if (field["dark"].present()) shot.dark = read_name("dark");
    if (field["exposure"].present()) shot.exposure = field["exposure"].number_above_zero();
    if (field["heldout"].present()) shot.heldout = field["heldout"].boolean();
    return shot;
}

void read_response(const JsonField& field, Radiometry& radiometry) {
    if (field.is_object()) {
        field.allow_only({"gamma"});
        radiometry.response = ResponseKind::gamma;
        radiometry.gamma = field["gamma"].number_above_zero();
        return;
    }
    const std::string expected = "\"linear\" or \"srgb\" or {\"gamma\": g}";
    const std::string word = field.text(expected);
    if (word != "linear" && word != "srgb") field.fail("is " + quote(word), expected);
    radiometry.response = word == "linear" ? ResponseKind::linear : ResponseKind::srgb;
}

Radiometry read_radiometry(const JsonField& field) {
    field.allow_only({"response", "saturation", "noise", "scale"});
    Radiometry radiometry;
    read_response(field["response"], radiometry);
    if (field["saturation"].present()) {
        radiometry.saturation = field["saturation"].number_above_zero();
    }
    if (field["noise"].present()) {
        const JsonField noise = field["noise"];
        noise.allow_only({"read", "gain"});
        radiometry.has_noise = true;
        radiometry.noise_read = noise["read"].number_not_below_zero();
        radiometry.noise_gain = noise["gain"].number_not_below_zero();
    }
    if (field["scale"].present()) {
        radiometry.scale_unknown =
            field["scale"].word<bool>({{"absolute", false}, {"unknown", true}});
    }
    return radiometry;
}

Truth read_truth(const JsonField& field, const CaptureDescription& description) {
    field.allow_only({"diffuse", "specular", "roughness", "mask"});
    const GeometrySource& geometry = description.geometry;
    const auto read_name = [&](const char* name) {
        const JsonField file = field[name];
        check_image_field(file,
                          description.folder,
                          geometry.texel_width,
                          geometry.texel_height,
                          "the texel domain");
        return file.text();
    };
    Truth truth;
    truth.diffuse = read_name("diffuse");
    truth.specular = read_name("specular");
    truth.roughness = read_name("roughness");
    if (field["mask"].present()) truth.mask = read_name("mask");
    return truth;
}

// Scanner frames are only understood where azimuths are: on a cylindrical range image.
template <typename Item>
void check_scanner_frames(const JsonField& field, const std::vector<Item>& items) {
    const std::vector<JsonField> fields = field.list();
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (items[i].frame == FrameOfReference::scanner) {
            fields[i]["frame"].fail("is \"scanner\"", kScannerNeeds);
        }
    }
}

void read_scene(const JsonField& root, CaptureDescription& description) {
    description.length_unit = root["length_unit"].word<LengthUnit>(
        {{"m", LengthUnit::meter}, {"cm", LengthUnit::centimeter}, {"mm", LengthUnit::millimeter}});
    description.cameras = read_cameras(root["cameras"]);
    description.geometry = read_geometry(root["geometry"], description.folder, description.cameras);
    const GeometrySource& geometry = description.geometry;
    for (Camera& camera : description.cameras) {
        if (camera.model != CameraModel::registered) continue;
        camera.width = geometry.texel_width;
        camera.height = geometry.texel_height;
    }
    description.lights = read_lights(root["lights"]);
    const bool cylindrical = !geometry.range_file.empty() &&
                             geometry.range_frame.projection == RangeProjection::cylindrical;
    if (cylindrical) return;
    check_scanner_frames(root["cameras"], description.cameras);
    check_scanner_frames(root["lights"], description.lights);
}

void read_shots(const JsonField& field, CaptureDescription& description) {
    const std::string expected = "a list of at least one shot";
    const std::vector<JsonField> fields = field.list(expected);
    if (fields.empty()) field.fail("is empty", expected);
    description.shots.reserve(fields.size());
    for (const JsonField& shot : fields) description.shots.push_back(read_shot(shot, description));
}

// The JSON file that `path` means: itself, or the one of that name in it.
fs::path json_file(const fs::path& path, const std::string& name) {
    if (!fs::exists(path)) {
        throw Error(path.string(), "", "does not exist", "a folder with a " + name);
    }
    return fs::is_directory(path) ? path / name : path;
}

CaptureDescription begin_description(const fs::path& file) {
    CaptureDescription description;
    description.file = file;
    description.folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
    return description;
}

void check_format(const JsonField& root, const std::string& format) {
    static_cast<void>(root["format"].word<bool>({{format, true}}));
    static_cast<void>(root["version"].integer(1, 1));
}

}  // namespace

CaptureDescription read_capture_description(const fs::path& path) {
    CaptureDescription description = begin_description(json_file(path, "capture.json"));
    const std::string place = description.file.string();
    const Json document = parse_json(read_file(description.file), place);
    const JsonField root(&document, place, "");
    check_format(root, "patina-capture");
    root.allow_only({"format",
                     "version",
                     "name",
                     "length_unit",
                     "geometry",
                     "cameras",
                     "lights",
                     "shots",
                     "radiometry",
                     "truth"});
    description.name = root["name"].text();
    description.radiometry = read_radiometry(root["radiometry"]);
    read_scene(root, description);
    read_shots(root["shots"], description);
    if (root["truth"].present()) description.truth = read_truth(root["truth"], description);
    return description;
}

CaptureDescription read_rig_description(const fs::path& path) {
    CaptureDescription description = begin_description(json_file(path, "rig.json"));
    const std::string place = description.file.string();
    const Json document = parse_json(read_file(description.file), place);
    const JsonField root(&document, place, "");
    check_format(root, "patina-rig");
    root.allow_only({"format", "version", "name", "length_unit", "geometry", "cameras", "lights"});
    if (root["name"].present()) description.name = root["name"].text();
    read_scene(root, description);
    return description;
}

}  // namespace patina
