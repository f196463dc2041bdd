// Lamps: point lights with an optional fall-off, and directional lights.
#pragma once

#include "patina/math/types.h"
#include "patina/scene/camera.h"

#include <limits>
#include <optional>
#include <string>

namespace patina {

enum class LightType { point, directional };

struct Light {
    std::string id;
    LightType type = LightType::point;
    Vec3 position = Vec3::Zero();  // [length], point
    Rgb intensity = Rgb::Zero();   // [radiance x length^2], point
    // Unit. point: the way in which it shines; directional: TOWARDS it.
    std::optional<Vec3> direction;
    double falloff = 0;            // mu of max(0, cos)^mu about direction, point
    Rgb irradiance = Rgb::Zero();  // [radiance x sr] on a plane facing it, directional
    FrameOfReference frame = FrameOfReference::world;
    double position_stddev = 0;   // [length]
    double direction_stddev = 0;  // [rad]
    double intensity_stddev = 0;  // relative [-]
};

// What arrives at a point when nothing is in the way.
struct LightSample {
    Vec3 w_i = Vec3::UnitZ();  // unit, from the point towards the light
    double distance = std::numeric_limits<double>::infinity();  // [length]
    Rgb irradiance = Rgb::Zero();  // on a plane facing the light [radiance x sr]
};

// Unit direction from a point towards the light at azimuth 0; +z at the light itself.
[[nodiscard]] Vec3 direction_to(const Light& light, const Vec3& p_world);

// azimuth [rad]: where the scanner stands, for lights that turn with it; ignored by the others.
[[nodiscard]] LightSample sample_light(const Light& light, const Vec3& p_world, double azimuth);

}  // namespace patina
