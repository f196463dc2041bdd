#include "patina/transport/gather_light.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace patina {
namespace {

// Round to nearest, ties to even; finite and not negative.
std::uint16_t to_upper_half(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return std::uint16_t((bits + 0x7fffu + ((bits >> 16) & 1u)) >> 16);
}

// A component of a unit vector.
std::int16_t to_direction(float component) {
    return std::int16_t(std::lround(LitTexels::kDirection * std::clamp(component, -1.0f, 1.0f)));
}

}  // namespace

Rgb lamp_color(const Light& light) {
    return light.type == LightType::point ? light.intensity : light.irradiance;
}

LitTexels lit_texels(const TexelAtlas& atlas, const LampBlock& lamps) {
    PATINA_CHECK(lamps.size() <= kLampLanes);
    LitTexels lit;
    lit.irradiance.resize(atlas.texels.size());
    lit.mirror.resize(atlas.texels.size());
    parallel_for(atlas.texels.size(), [&](std::size_t i) {
        LitTexels::Mirror& mirror = lit.mirror[i];
        for (std::size_t lamp = 0; lamp < lamps.size(); ++lamp) {
            const DirectLight& direct = (*lamps.direct[lamp])[i];
            const double color = lamp_color(*lamps.lights[lamp]).maxCoeff();
            if (!(color > 0) || !(direct.irradiance > 0).any()) continue;
            const auto irradiance = float(double(direct.irradiance.maxCoeff()) / color);
            lit.irradiance[i][lamp] = irradiance;
            mirror.over_cosine[lamp] =
                to_upper_half(irradiance / std::max(direct.cos_i, float(kCosineFloor)));
            mirror.x[lamp] = to_direction(direct.w_i.x());
            mirror.y[lamp] = to_direction(direct.w_i.y());
            mirror.z[lamp] = to_direction(direct.w_i.z());
        }
    });
    return lit;
}

std::vector<CompactLanes> hit_lanes(const Surface& surface,
                                    const TexelAtlas& atlas,
                                    const LampBlock& lamps,
                                    const GatherRows& rows) {
    PATINA_CHECK(lamps.size() <= kLampLanes);
    std::vector<CompactLanes> lanes(rows.hits.size());
    parallel_for(atlas.texels.size(), [&](std::size_t i) {
        for (std::size_t k = rows.begin[i]; k < rows.begin[i + 1]; ++k) {
            const GatherHit& hit = rows.hits[k];
            const SurfacePoint& point = atlas.texels[hit.to].point;
            const Vec3 w_o = -hit.w.cast<double>();
            for (std::size_t lamp = 0; lamp < lamps.size(); ++lamp) {
                const Light& light = *lamps.lights[lamp];
                const LightSample sample =
                    sample_light(light, point.position, atlas.texels[i].azimuth);
                const double color = lamp_color(light).maxCoeff();
                const double cos_i = point.normal.dot(sample.w_i);
                if (!(color > 0) || !(sample.irradiance > 0).any() ||
                    !is_lit(surface, point, sample)) {
                    continue;
                }
                const double irradiance = sample.irradiance.maxCoeff() / color * cos_i;
                const double mirror_cosine =
                    2 * cos_i * point.normal.dot(w_o) - sample.w_i.dot(w_o);
                lanes[k].irradiance[lamp] = to_upper_half(float(irradiance));
                lanes[k].over_cosine[lamp] =
                    to_upper_half(float(irradiance / std::max(cos_i, kCosineFloor)));
                lanes[k].versine[lamp] = to_upper_half(float(std::max(0.0, 1 - mirror_cosine)));
            }
        }
    });
    return lanes;
}

}  // namespace patina
