#include "patina/capture/description_parts.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {
namespace {

constexpr double kFullTurn = 360;  // [degrees]

void check_texel_count(const JsonField& field, const GeometrySource& source) {
    if (source.texel_width <= kMaxTexels / source.texel_height) return;
    field.fail(fmt::format("makes {} x {} texels", source.texel_width, source.texel_height),
               fmt::format("at most {}", kMaxTexels));
}

void read_mesh_source(const JsonField& field,
                      const std::filesystem::path& folder,
                      GeometrySource& source) {
    field.allow_only({"mesh", "texels", "unwrap", "normal_stddev", "registration_stddev"});
    source.mesh_file = read_file_field(field["mesh"], folder);
    const std::string expected = "a list of 2 integers";
    const std::vector<JsonField> texels = field["texels"].list(expected);
    if (texels.size() != 2) {
        field["texels"].fail(fmt::format("is a list of {}", texels.size()), expected);
    }
    source.texel_width = texels[0].integer(1, kMaxTexelSide);
    source.texel_height = texels[1].integer(1, kMaxTexelSide);
    check_texel_count(field["texels"], source);
    if (field["unwrap"].present()) source.unwrap = field["unwrap"].boolean();
}

void read_range_size(const JsonField& field,
                     const std::filesystem::path& folder,
                     GeometrySource& source) {
    source.range_file = read_file_field(field, folder);
    const ImageSize size = read_image_size(folder / source.range_file, field.path());
    if (size.channels != 1) {
        field.fail(fmt::format("{} has {} channels", quote(source.range_file), size.channels),
                   "1 channel");
    }
    if (std::max(size.width, size.height) > kMaxTexelSide) {
        field.fail(
            fmt::format("{} has {} x {} pixels", quote(source.range_file), size.width, size.height),
            fmt::format("at most {} to a side", kMaxTexelSide));
    }
    source.texel_width = size.width;
    source.texel_height = size.height;
    check_texel_count(field, source);
}

void read_cylinder(const JsonField& field, RangeFrame& frame) {
    field.allow_only({"range",
                      "projection",
                      "azimuth",
                      "height",
                      "max_step",
                      "normal_stddev",
                      "registration_stddev"});
    if (field["azimuth"].present()) {
        const std::vector<double> azimuth = field["azimuth"].numbers(2);
        if (azimuth[1] <= azimuth[0] || azimuth[1] - azimuth[0] > kFullTurn) {
            field["azimuth"].fail(fmt::format("is [{}, {}]", azimuth[0], azimuth[1]),
                                  "[a0, a1] with a0 < a1, at most a full turn, in degrees");
        }
        frame.azimuth_begin = radians(azimuth[0]);
        frame.azimuth_end = radians(azimuth[1]);
    }
    const std::vector<double> height = field["height"].numbers(2);
    if (height[1] <= height[0]) {
        field["height"].fail(fmt::format("is [{}, {}]", height[0], height[1]),
                             "[y0, y1] with y0 < y1");
    }
    frame.height_begin = height[0];
    frame.height_end = height[1];
}

void read_range_camera(const JsonField& field,
                       const std::vector<Camera>& cameras,
                       GeometrySource& source) {
    field.allow_only(
        {"range", "projection", "camera", "max_step", "normal_stddev", "registration_stddev"});
    const Camera& camera = cameras[read_id_field(field["camera"], ids_of(cameras), "camera")];
    if (camera.model == CameraModel::registered) {
        field["camera"].fail(quote(camera.id) + " is a registered camera",
                             "a pinhole or orthographic camera");
    }
    if (camera.width != source.texel_width || camera.height != source.texel_height) {
        field["range"].fail(
            fmt::format("{} has {} x {} pixels",
                        quote(source.range_file),
                        source.texel_width,
                        source.texel_height),
            fmt::format(
                "{} x {}, the size of camera {}", camera.width, camera.height, quote(camera.id)));
    }
    source.range_camera = camera.id;
    source.range_frame.camera = camera;
}

void read_range_source(const JsonField& field,
                       const std::filesystem::path& folder,
                       const std::vector<Camera>& cameras,
                       GeometrySource& source) {
    RangeFrame& frame = source.range_frame;
    frame.projection = field["projection"].word<RangeProjection>(
        {{"cylindrical", RangeProjection::cylindrical}, {"camera", RangeProjection::camera}});
    read_range_size(field["range"], folder, source);
    if (frame.projection == RangeProjection::cylindrical) {
        read_cylinder(field, frame);
    } else {
        read_range_camera(field, cameras, source);
    }
    if (field["max_step"].present()) frame.max_step = field["max_step"].number_above_zero();
}

}  // namespace

GeometrySource read_geometry(const JsonField& field,
                             const std::filesystem::path& folder,
                             const std::vector<Camera>& cameras) {
    const bool mesh = field["mesh"].present();
    const bool range = field["range"].present();
    const std::string expected = "either \"mesh\" or \"range\"";
    if (mesh && range) field.fail("has both \"mesh\" and \"range\"", expected);
    if (!mesh && !range) field.fail("has neither \"mesh\" nor \"range\"", expected);
    GeometrySource source;
    if (mesh) {
        read_mesh_source(field, folder, source);
    } else {
        read_range_source(field, folder, cameras, source);
    }
    if (field["normal_stddev"].present()) {
        source.normal_stddev = radians(field["normal_stddev"].number_not_below_zero());
    }
    if (field["registration_stddev"].present()) {
        source.registration_stddev = field["registration_stddev"].number_not_below_zero();
    }
    return source;
}

}  // namespace patina
