// sample_light() in single precision, without branches and without calls into the mathematical
// library: a loop over points runs in SIMD lanes, with the same bytes for any lane width.
#pragma once

#include "patina/math/lane_math.h"
#include "patina/reflectance/lobe_lanes.h"
#include "patina/scene/light.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

// A lamp as lanes read it.
struct LaneLight {
    float x = 0, y = 0, z = 0;                 // position [length]; directional: unit, towards it
    float is_point = 1;                        // 0: directional
    float turns = 0;                           // 1: with the scanner
    float axis_x = 0, axis_y = 0, axis_z = 0;  // unit, in which it shines; point with fall-off
    float has_axis = 0;
    float falloff = 0;  // [-]
};
[[nodiscard]] LaneLight lane_light(const Light& light);

// What arrives when nothing is in the way.
struct LaneLightSample {
    float x, y, z;   // unit, towards the light; zero at the light itself
    float distance;  // [length]
    // Irradiance on a plane facing the light over Light::intensity [1/length^2] or
    // Light::irradiance [-].
    float strength;
};

// turn: where the scanner stands, in whole turns, in [0, 1].
[[nodiscard]] inline LaneLightSample sample_lane_light(
    const LaneLight& light, float p_x, float p_y, float p_z, float turn) {
    const SinCos azimuth = lane_sin_cos(turn);
    const float sine = light.turns * azimuth.sin;
    const float cosine = 1 + light.turns * (azimuth.cos - 1);
    const float to_x = cosine * light.x + sine * light.z - light.is_point * p_x;
    const float to_y = light.y - light.is_point * p_y;
    const float to_z = cosine * light.z - sine * light.x - light.is_point * p_z;
    const float distance_squared =
        std::max(to_x * to_x + to_y * to_y + to_z * to_z, std::numeric_limits<float>::min());
    const float distance = std::sqrt(distance_squared);
    const float w_x = to_x / distance;
    const float w_y = to_y / distance;
    const float w_z = to_z / distance;

    const float axis_x = cosine * light.axis_x + sine * light.axis_z;
    const float axis_z = cosine * light.axis_z - sine * light.axis_x;
    const float off_axis = -(axis_x * w_x + light.axis_y * w_y + axis_z * w_z);
    const float power = exp_of_negative(
        light.falloff *
        std::min(0.0f, lane_log(std::max(off_axis, std::numeric_limits<float>::min()))));
    const float shining = off_axis > 0 ? power : 0.0f;
    const float strength = light.has_axis > 0 ? shining : 1.0f;
    const bool is_point = light.is_point > 0;
    return {w_x,
            w_y,
            w_z,
            is_point ? distance : std::numeric_limits<float>::infinity(),
            is_point ? strength / distance_squared : 1.0f};
}

}  // namespace patina
