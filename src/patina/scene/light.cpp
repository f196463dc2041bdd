#include "patina/scene/light.h"

#include "patina/base/check.h"

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

}  // namespace patina
