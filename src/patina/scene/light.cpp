#include "patina/scene/light.h"

#include "patina/base/check.h"
#include "patina/scene/light_lanes.h"

#include <algorithm>
#include <cmath>

namespace patina {

Vec3 direction_to(const Light& light, const Vec3& p_world) {
    return sample_light(light, p_world, 0).w_i;
}

LightSample sample_light(const Light& light, const Vec3& p_world, double azimuth) {
    const auto in_world = [&](const Vec3& v) {
        return light.frame == FrameOfReference::scanner ? rotate_about_y(azimuth, v) : v;
    };
    LightSample sample;
    if (light.type == LightType::directional) {
        PATINA_CHECK(light.direction.has_value());
        sample.w_i = in_world(*light.direction);
        sample.irradiance = light.irradiance;
        return sample;
    }
    const Vec3 to_light = in_world(light.position) - p_world;
    sample.distance = to_light.norm();
    // At the lamp itself there is no direction and no finite irradiance.
    if (sample.distance == 0) return sample;
    sample.w_i = to_light / sample.distance;
    sample.irradiance = light.intensity / square(sample.distance);
    if (light.direction) {
        const double cosine = std::max(0.0, -in_world(*light.direction).dot(sample.w_i));
        // A lamp of falloff 0 shines alike into the half space before it, and not behind.
        sample.irradiance *= cosine > 0 ? std::pow(cosine, light.falloff) : 0.0;
    }
    return sample;
}

LaneLight lane_light(const Light& light) {
    LaneLight lane;
    const bool is_point = light.type == LightType::point;
    PATINA_CHECK(is_point || light.direction.has_value());
    const Vec3f place = (is_point ? light.position : *light.direction).cast<float>();
    lane.x = place.x();
    lane.y = place.y();
    lane.z = place.z();
    lane.is_point = is_point ? 1.0f : 0.0f;
    lane.turns = light.frame == FrameOfReference::scanner ? 1.0f : 0.0f;
    if (!is_point || !light.direction) return lane;
    lane.axis_x = float(light.direction->x());
    lane.axis_y = float(light.direction->y());
    lane.axis_z = float(light.direction->z());
    lane.has_axis = 1;
    lane.falloff = float(light.falloff);
    return lane;
}

}  // namespace patina
