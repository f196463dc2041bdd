#include "patina/capture/description_parts.h"

#include <Eigen/SVD>
#include <fmt/format.h>

#include <algorithm>

namespace patina {
namespace {

// How far a pose may be from a rigid one, per element; from the format.
constexpr double kRigidTolerance = 1e-4;
// Rotations and directions nearer than this to exact ones are kept as they are, so that a
// description that was written reads back to the same bits. Some hundred times the rounding of
// double.
constexpr double kExactTolerance = 1e-13;

Vec3 read_vector(const JsonField& field) {
    const std::vector<double> values = field.numbers(3);
    return {values[0], values[1], values[2]};
}

Vec3 read_direction(const JsonField& field) {
    const Vec3 direction = read_vector(field);
    // stableNorm: a direction of 1e-200 is as good as any other.
    const double norm = direction.stableNorm();
    if (norm == 0) field.fail("is the zero vector", "a direction");
    if (std::abs(norm - 1) <= kExactTolerance) return direction;
    return direction.stableNormalized();
}

Rgb read_rgb(const JsonField& field) {
    Rgb rgb = Rgb::Zero();
    int channel = 0;
    static_cast<void>(field.numbers(3));
    for (const JsonField& item : field.list()) rgb[channel++] = item.number_not_below_zero();
    return rgb;
}

// The rotation nearest to a nearly orthonormal matrix.
Mat3 nearest_rotation(const Mat3& matrix) {
    const Mat3 deviation = matrix.transpose() * matrix - Mat3::Identity();
    if (deviation.cwiseAbs().maxCoeff() <= kExactTolerance) return matrix;
    const Eigen::JacobiSVD<Mat3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    return svd.matrixU() * svd.matrixV().transpose();
}

RigidTransform read_pose(const JsonField& field) {
    const std::vector<double> values = field.numbers(16);
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix(values.data());
    const std::string expected = "a rigid pose: 4 x 4, row by row, last row 0 0 0 1";
    const Eigen::RowVector4d last_row(0, 0, 0, 1);
    if ((matrix.row(3) - last_row).cwiseAbs().maxCoeff() > kRigidTolerance) {
        field.fail(fmt::format("has the last row {} {} {} {}",
                               matrix(3, 0),
                               matrix(3, 1),
                               matrix(3, 2),
                               matrix(3, 3)),
                   expected);
    }
    const Mat3 rotation = matrix.topLeftCorner<3, 3>();
    const double deviation =
        (rotation.transpose() * rotation - Mat3::Identity()).cwiseAbs().maxCoeff();
    if (!(deviation <= kRigidTolerance)) field.fail("stretches or shears", expected);
    if (rotation.determinant() < 0) field.fail("mirrors", expected);
    return {nearest_rotation(rotation), matrix.topRightCorner<3, 1>()};
}

FrameOfReference read_frame(const JsonField& field) {
    if (!field.present()) return FrameOfReference::world;
    return field.word<FrameOfReference>(
        {{"world", FrameOfReference::world}, {"scanner", FrameOfReference::scanner}});
}

// Reads "id" and fails when one of `taken` has it.
std::string read_new_id(const JsonField& field, const std::vector<std::string>& taken) {
    const std::string expected = "an id of its own";
    const std::string id = field.text(expected);
    if (id.empty()) field.fail("is \"\"", expected);
    if (std::find(taken.begin(), taken.end(), id) != taken.end()) {
        field.fail("is " + quote(id) + " for the second time", expected);
    }
    return id;
}

void read_image_size_fields(const JsonField& field, Camera& camera) {
    camera.width = field["width"].integer(1, kMaxImageSide);
    camera.height = field["height"].integer(1, kMaxImageSide);
    camera.world_from_camera = read_pose(field["world_from_camera"]);
}

void read_pinhole(const JsonField& field, Camera& camera) {
    field.allow_only({"id",
                      "model",
                      "width",
                      "height",
                      "fx",
                      "fy",
                      "cx",
                      "cy",
                      "distortion",
                      "world_from_camera"});
    read_image_size_fields(field, camera);
    camera.fx = field["fx"].number_above_zero();
    camera.fy = field["fy"].number_above_zero();
    camera.cx = field["cx"].number();
    camera.cy = field["cy"].number();
    if (field["distortion"].present()) {
        const std::vector<double> values = field["distortion"].numbers(camera.distortion.size());
        std::copy(values.begin(), values.end(), camera.distortion.begin());
    }
}

Camera read_camera(const JsonField& field) {
    Camera camera;
    camera.model = field["model"].word<CameraModel>({{"pinhole", CameraModel::pinhole},
                                                     {"orthographic", CameraModel::orthographic},
                                                     {"registered", CameraModel::registered}});
    switch (camera.model) {
        case CameraModel::pinhole:
            read_pinhole(field, camera);
            break;
        case CameraModel::orthographic:
            field.allow_only({"id", "model", "width", "height", "pixel_size", "world_from_camera"});
            read_image_size_fields(field, camera);
            camera.pixel_size = field["pixel_size"].number_above_zero();
            break;
        case CameraModel::registered:
            field.allow_only({"id", "model", "position", "frame"});
            camera.position = read_vector(field["position"]);
            camera.frame = read_frame(field["frame"]);
            break;
    }
    return camera;
}

void read_point_light(const JsonField& field, Light& light) {
    field.allow_only({"id",
                      "type",
                      "position",
                      "intensity",
                      "direction",
                      "falloff",
                      "frame",
                      "position_stddev",
                      "direction_stddev",
                      "intensity_stddev"});
    light.position = read_vector(field["position"]);
    light.intensity = read_rgb(field["intensity"]);
    if (!field["direction"].present() && !field["falloff"].present()) return;
    light.direction = read_direction(field["direction"]);
    light.falloff = field["falloff"].number_not_below_zero();
}

double read_stddev(const JsonField& field) {
    return field.present() ? field.number_not_below_zero() : 0;
}

Light read_light(const JsonField& field) {
    Light light;
    light.type = field["type"].word<LightType>(
        {{"point", LightType::point}, {"directional", LightType::directional}});
    if (light.type == LightType::point) {
        read_point_light(field, light);
    } else {
        field.allow_only({"id",
                          "type",
                          "direction",
                          "irradiance",
                          "frame",
                          "position_stddev",
                          "direction_stddev",
                          "intensity_stddev"});
        light.direction = read_direction(field["direction"]);
        light.irradiance = read_rgb(field["irradiance"]);
    }
    light.frame = read_frame(field["frame"]);
    light.position_stddev = read_stddev(field["position_stddev"]);
    light.direction_stddev = radians(read_stddev(field["direction_stddev"]));
    light.intensity_stddev = read_stddev(field["intensity_stddev"]);
    return light;
}

// A list of at least one item with an id each.
template <typename Item>
std::vector<Item> read_items(const JsonField& field,
                             const std::string& what,
                             Item (*read_item)(const JsonField&)) {
    const std::string expected = "a list of " + what;
    const std::vector<JsonField> fields = field.list(expected);
    if (fields.empty()) field.fail("is empty", expected);
    std::vector<Item> items;
    std::vector<std::string> ids;
    for (const JsonField& item_field : fields) {
        Item item = read_item(item_field);
        item.id = read_new_id(item_field["id"], ids);
        ids.push_back(item.id);
        items.push_back(item);
    }
    return items;
}

}  // namespace

std::vector<Camera> read_cameras(const JsonField& field) {
    return read_items<Camera>(field, "cameras", read_camera);
}

std::vector<Light> read_lights(const JsonField& field) {
    return read_items<Light>(field, "lights", read_light);
}

}  // namespace patina
