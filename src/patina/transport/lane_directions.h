// Directions about an axis in single precision, without branches and without calls into the
// mathematical library: a loop over them runs in SIMD lanes, with the same bytes for any lane
// width.
//
// As Frame, square_to_cosine_hemisphere() and square_to_von_mises_fisher() of math/warp.h.
#pragma once

#include "patina/math/lane_math.h"
#include "patina/reflectance/lobe_lanes.h"
#include "patina/transport/photon_lanes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patina {

struct LaneDirection {
    float x, y, z;
};

[[nodiscard]] inline LaneDirection lane_at(const Lane3& lane, std::size_t i) {
    return {lane.x[i], lane.y[i], lane.z[i]};
}

// Of w about the normal, both unit; cosine: between them [-].
[[nodiscard]] inline LaneDirection lane_mirror(const LaneDirection& normal,
                                               const LaneDirection& w,
                                               float cosine) {
    return {2 * cosine * normal.x - w.x, 2 * cosine * normal.y - w.y, 2 * cosine * normal.z - w.z};
}

// Of the chord between the tips of two unit vectors [-].
[[nodiscard]] inline float lane_chord_squared(const LaneDirection& a, const LaneDirection& b) {
    const float dx = a.x - b.x;
    const float dy = a.y - b.y;
    const float dz = a.z - b.z;
    return dx * dx + dy * dy + dz * dz;
}

[[nodiscard]] inline float lane_dot(const LaneDirection& a, const LaneDirection& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// is_lobe: of the von Mises-Fisher distribution about the axis, else of the density cos/pi. axis:
// unit. u, v: in [0, 1). concentration: kappa of the distribution [-].
[[nodiscard]] inline LaneDirection lane_direction(
    bool is_lobe, const LaneDirection& axis, float concentration, float u, float v) {
    const float decay = exp_of_negative(-2 * concentration);
    const float versine = std::min(2.0f, -lane_log(u + (1 - u) * decay) / concentration);
    const float radius_squared = is_lobe ? versine * (2 - versine) : u;
    const float z = is_lobe ? 1 - versine : std::sqrt(1 - u);
    const float radius = std::sqrt(std::max(radius_squared, 0.0f));
    const SinCos phi = lane_sin_cos(v);
    const float x = radius * phi.cos;
    const float y = radius * phi.sin;
    const float sign = std::copysign(1.0f, axis.z);
    const float a = -1.0f / (sign + axis.z);
    const float b = axis.x * axis.y * a;
    return {x * (1 + sign * axis.x * axis.x * a) + y * b + z * axis.x,
            x * sign * b + y * (sign + axis.y * axis.y * a) + z * axis.y,
            -x * sign * axis.x - y * axis.y + z * axis.z};
}

// Density of the von Mises-Fisher distribution [1/sr] where the chord to its axis has this square.
[[nodiscard]] inline float lane_lobe_density(float concentration, float chord_squared) {
    constexpr float kHalfInversePi = float(0.5 * std::numbers::inv_pi);
    return kHalfInversePi * concentration * exp_of_negative(-0.5f * concentration * chord_squared) /
           (1 - exp_of_negative(-2 * concentration));
}

}  // namespace patina
