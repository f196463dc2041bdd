#include "patina/transport/gather_light.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/reflectance/lobe_lanes.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// Texels that the unit of a lamp's light is judged by. Compact numbers reach further by many powers
// of two to either side.
constexpr std::size_t kJudgedTexels = 1024;

// The normal of a texel and the directions from it to the lamps, by component.
struct alignas(64) LampDirections {
    std::array<Lanes, 3> w{};
    Vec3f normal = Vec3f::UnitZ();
};

}  // namespace

Rgb lamp_color(const Light& light) {
    return light.type == LightType::point ? light.intensity : light.irradiance;
}

Lanes light_units(const TexelAtlas& atlas, const LampBlock& lamps) {
    PATINA_CHECK(lamps.size() <= kLampLanes);
    const std::size_t step = std::max<std::size_t>(1, atlas.texels.size() / kJudgedTexels);
    Lanes units = Lanes{} + 1.0f;
    for (std::size_t lamp = 0; lamp < lamps.size(); ++lamp) {
        const Light& light = *lamps.lights[lamp];
        const double color = lamp_color(light).maxCoeff();
        double peak = 0;
        for (std::size_t i = 0; color > 0 && i < atlas.texels.size(); i += step) {
            const Texel& texel = atlas.texels[i];
            const LightSample sample = sample_light(light, texel.point.position, texel.azimuth);
            peak = std::max(peak, sample.irradiance.maxCoeff() / color);
        }
        if (peak > 0) units[lamp] = float(std::exp2(std::floor(std::log2(peak))));
    }
    return units;
}

std::vector<LitTexel> lit_texels(const TexelAtlas& atlas,
                                 const LampBlock& lamps,
                                 const Lanes& units) {
    std::vector<LitTexel> lit(atlas.texels.size());
    parallel_for(lit.size(), [&](std::size_t i) {
        for (std::size_t lamp = 0; lamp < lamps.size(); ++lamp) {
            const DirectLight& direct = (*lamps.direct[lamp])[i];
            const double color = lamp_color(*lamps.lights[lamp]).maxCoeff();
            if (!(color > 0) || !(direct.irradiance > 0).any()) continue;
            const auto irradiance = float(double(direct.irradiance.maxCoeff()) / color);
            lit[i].irradiance[lamp] = irradiance / units[lamp];
            lit[i].over_cosine[lamp] =
                lit[i].irradiance[lamp] / std::max(direct.cos_i, float(kCosineFloor));
        }
    });
    return lit;
}

LargeVector<StandingHit> standing_hits(const TexelAtlas& atlas,
                                       const LampBlock& lamps,
                                       const GatherRows& rows) {
    LargeVector<LampDirections> directions(atlas.texels.size());
    parallel_for(directions.size(), [&](std::size_t i) {
        directions[i].normal = atlas.texels[i].point.normal.cast<float>();
        for (std::size_t lamp = 0; lamp < lamps.size(); ++lamp) {
            const Vec3f& w = (*lamps.direct[lamp])[i].w_i;
            for (std::size_t c = 0; c < 3; ++c) directions[i].w[c][lamp] = w[Eigen::Index(c)];
        }
    });
    LargeVector<StandingHit> hits(rows.hits.size());
    parallel_for(hits.size(), [&](std::size_t k) {
        const LampDirections& at = directions[rows.hits[k].to];
        const Vec3f& w = rows.hits[k].w;
        const float cos_o = -at.normal.dot(w);
        hits[k].over_cosine = to_compact(1 / std::max(cos_o, float(kCosineFloor)));
        const Vec3f mirror = 2 * cos_o * at.normal + w;
        const Lanes versine =
            1.0f - (mirror.x() * at.w[0] + mirror.y() * at.w[1] + mirror.z() * at.w[2]);
        hits[k].theta_squared = to_compact(squared_angle(versine < 0.0f ? Lanes{} : versine));
    });
    return hits;
}

LargeVector<TurningHit> turning_hits(const Surface& surface,
                                     const TexelAtlas& atlas,
                                     const LampBlock& lamps,
                                     const Lanes& units,
                                     const GatherRows& rows) {
    LargeVector<TurningHit> hits(rows.hits.size());
    parallel_for(atlas.texels.size(), [&](std::size_t i) {
        for (std::size_t k = rows.begin[i]; k < rows.begin[i + 1]; ++k) {
            const GatherHit& hit = rows.hits[k];
            const SurfacePoint& point = atlas.texels[hit.to].point;
            const Vec3 w_o = -hit.w.cast<double>();
            const double cos_o = point.normal.dot(w_o);
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
                const double irradiance =
                    sample.irradiance.maxCoeff() / color * cos_i / double(units[lamp]);
                const double mirror_cosine = 2 * cos_i * cos_o - sample.w_i.dot(w_o);
                hits[k].irradiance[lamp] = to_compact(float(irradiance));
                hits[k].over_cosine[lamp] = to_compact(float(
                    irradiance / (std::max(cos_i, kCosineFloor) * std::max(cos_o, kCosineFloor))));
                hits[k].theta_squared[lamp] =
                    to_compact(squared_angle(float(std::max(0.0, 1 - mirror_cosine))));
            }
        }
    });
    return hits;
}

}  // namespace patina
