#include "patina/base/output_file.h"
#include "patina/capture/capture.h"
#include "patina/capture/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace patina {
namespace {

// The shortest number of degrees that reads back as exactly this angle [rad], where there is one.
double degrees_that_read_as(double angle) {
    const double nearest = degrees(angle);
    const double infinity = std::numeric_limits<double>::infinity();
    const double rounded = std::stod(fmt::format("{:.12g}", nearest));
    for (const double candidate : {rounded,
                                   nearest,
                                   std::nextafter(nearest, -infinity),
                                   std::nextafter(nearest, infinity)}) {
        if (radians(candidate) == angle) return candidate;
    }
    return nearest;
}

Json numbers(std::initializer_list<double> values) {
    Json list = Json::list();
    for (const double value : values) list.push(Json(value));
    return list;
}

Json vector_json(const Vec3& vector) { return numbers({vector.x(), vector.y(), vector.z()}); }

Json rgb_json(const Rgb& rgb) { return numbers({rgb[0], rgb[1], rgb[2]}); }

Json pose_json(const RigidTransform& pose) {
    Json list = Json::list();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) list.push(Json(pose.rotation(row, column)));
        list.push(Json(pose.translation[row]));
    }
    for (const double value : {0.0, 0.0, 0.0, 1.0}) list.push(Json(value));
    return list;
}

// Fields whose value is the format's default are left out.
void set_unless_zero(Json& object, const std::string& name, double value) {
    if (value != 0) object.set(name, Json(value));
}

void set_angle_unless_zero(Json& object, const std::string& name, double angle) {
    if (angle != 0) object.set(name, Json(degrees_that_read_as(angle)));
}

void set_unless_empty(Json& object, const std::string& name, const std::string& text) {
    if (!text.empty()) object.set(name, Json(text));
}

void set_frame(Json& object, FrameOfReference frame) {
    if (frame == FrameOfReference::scanner) object.set("frame", Json("scanner"));
}

Json geometry_json(const GeometrySource& source) {
    Json json = Json::object();
    const RangeFrame& frame = source.range_frame;
    if (!source.mesh_file.empty()) {
        json.set("mesh", Json(source.mesh_file));
        json.set("texels", Json::list());
        json.items.back().push(Json(source.texel_width));
        json.items.back().push(Json(source.texel_height));
        if (source.unwrap) json.set("unwrap", Json(true));
    } else if (frame.projection == RangeProjection::cylindrical) {
        json.set("range", Json(source.range_file));
        json.set("projection", Json("cylindrical"));
        json.set("azimuth",
                 numbers({degrees_that_read_as(frame.azimuth_begin),
                          degrees_that_read_as(frame.azimuth_end)}));
        json.set("height", numbers({frame.height_begin, frame.height_end}));
    } else {
        json.set("range", Json(source.range_file));
        json.set("projection", Json("camera"));
        json.set("camera", Json(source.range_camera));
    }
    if (frame.max_step) json.set("max_step", Json(*frame.max_step));
    set_angle_unless_zero(json, "normal_stddev", source.normal_stddev);
    set_unless_zero(json, "registration_stddev", source.registration_stddev);
    return json;
}

void set_image_size(Json& json, const Camera& camera) {
    json.set("width", Json(camera.width));
    json.set("height", Json(camera.height));
}

Json camera_json(const Camera& camera) {
    Json json = Json::object();
    json.set("id", Json(camera.id));
    switch (camera.model) {
        case CameraModel::pinhole:
            json.set("model", Json("pinhole"));
            set_image_size(json, camera);
            json.set("fx", Json(camera.fx));
            json.set("fy", Json(camera.fy));
            json.set("cx", Json(camera.cx));
            json.set("cy", Json(camera.cy));
            if (std::any_of(camera.distortion.begin(), camera.distortion.end(), [](double k) {
                    return k != 0;
                })) {
                const auto& k = camera.distortion;
                json.set("distortion", numbers({k[0], k[1], k[2], k[3], k[4]}));
            }
            json.set("world_from_camera", pose_json(camera.world_from_camera));
            break;
        case CameraModel::orthographic:
            json.set("model", Json("orthographic"));
            set_image_size(json, camera);
            json.set("pixel_size", Json(camera.pixel_size));
            json.set("world_from_camera", pose_json(camera.world_from_camera));
            break;
        case CameraModel::registered:
            json.set("model", Json("registered"));
            json.set("position", vector_json(camera.position));
            set_frame(json, camera.frame);
            break;
    }
    return json;
}

Json light_json(const Light& light) {
    Json json = Json::object();
    json.set("id", Json(light.id));
    if (light.type == LightType::point) {
        json.set("type", Json("point"));
        json.set("position", vector_json(light.position));
        json.set("intensity", rgb_json(light.intensity));
        if (light.direction) {
            json.set("direction", vector_json(*light.direction));
            json.set("falloff", Json(light.falloff));
        }
    } else {
        json.set("type", Json("directional"));
        json.set("direction", vector_json(light.direction.value_or(Vec3::UnitZ())));
        json.set("irradiance", rgb_json(light.irradiance));
    }
    set_frame(json, light.frame);
    set_unless_zero(json, "position_stddev", light.position_stddev);
    set_angle_unless_zero(json, "direction_stddev", light.direction_stddev);
    set_unless_zero(json, "intensity_stddev", light.intensity_stddev);
    return json;
}

Json shot_json(const Shot& shot, const CaptureDescription& description) {
    Json json = Json::object();
    json.set("image", Json(shot.image));
    json.set("camera", Json(description.cameras[shot.camera].id));
    if (shot.lights.size() == 1) {
        json.set("light", Json(description.lights[shot.lights[0]].id));
    } else {
        json.set("lights", Json::list());
        for (const std::size_t light : shot.lights) {
            json.items.back().push(Json(description.lights[light].id));
        }
    }
    json.set("exposure", Json(shot.exposure));
    set_unless_empty(json, "mask", shot.mask);
    set_unless_empty(json, "dark", shot.dark);
    if (shot.heldout) json.set("heldout", Json(true));
    return json;
}

Json radiometry_json(const Radiometry& radiometry) {
    Json json = Json::object();
    switch (radiometry.response) {
        case ResponseKind::linear:
            json.set("response", Json("linear"));
            break;
        case ResponseKind::srgb:
            json.set("response", Json("srgb"));
            break;
        case ResponseKind::gamma:
            json.set("response", Json::object());
            json.items.back().set("gamma", Json(radiometry.gamma));
            break;
    }
    if (radiometry.saturation) json.set("saturation", Json(*radiometry.saturation));
    if (radiometry.has_noise) {
        json.set("noise", Json::object());
        json.items.back().set("read", Json(radiometry.noise_read));
        json.items.back().set("gain", Json(radiometry.noise_gain));
    }
    if (radiometry.scale_unknown) json.set("scale", Json("unknown"));
    return json;
}

Json truth_json(const Truth& truth) {
    Json json = Json::object();
    json.set("diffuse", Json(truth.diffuse));
    json.set("specular", Json(truth.specular));
    json.set("roughness", Json(truth.roughness));
    set_unless_empty(json, "mask", truth.mask);
    return json;
}

}  // namespace

const char* length_unit_name(LengthUnit unit) {
    switch (unit) {
        case LengthUnit::meter:
            return "m";
        case LengthUnit::centimeter:
            return "cm";
        case LengthUnit::millimeter:
            break;
    }
    return "mm";
}

void write_capture_description(const CaptureDescription& description,
                               const std::filesystem::path& folder) {
    const bool rig = description.shots.empty();
    Json root = Json::object();
    root.set("format", Json(rig ? "patina-rig" : "patina-capture"));
    root.set("version", Json(1));
    root.set("name", Json(description.name));
    root.set("length_unit", Json(length_unit_name(description.length_unit)));
    root.set("geometry", geometry_json(description.geometry));
    Json cameras = Json::list();
    for (const Camera& camera : description.cameras) cameras.push(camera_json(camera));
    root.set("cameras", cameras);
    Json lights = Json::list();
    for (const Light& light : description.lights) lights.push(light_json(light));
    root.set("lights", lights);
    if (!rig) {
        Json shots = Json::list();
        for (const Shot& shot : description.shots) shots.push(shot_json(shot, description));
        root.set("shots", shots);
        root.set("radiometry", radiometry_json(description.radiometry));
        if (description.truth) root.set("truth", truth_json(*description.truth));
    }
    write_file(folder / (rig ? "rig.json" : "capture.json"), to_text(root));
}

}  // namespace patina
