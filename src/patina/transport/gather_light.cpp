#include "patina/transport/gather_light.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/reflectance/lobe_lanes.h"
#include "patina/scene/light_lanes.h"

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

// What is asked of memory so many hits before it is read.
constexpr std::size_t kAhead = 8;

void expect(const LampDirections& directions) {
    for (const Lanes& component : directions.w) __builtin_prefetch(&component);
    __builtin_prefetch(&directions.normal);
}

// What the lamps of a block send to a point.
struct LampsAtPoint {
    std::array<Lanes, 3> w{};  // unit, towards the lamps
    Lanes cos_i{};
    Lanes strength{};  // see LaneLightSample; 0 where a lamp is not there or does not shine
};

// Lamps that turn with the scanner, with their shadows.
class TurningLamps {
  public:
    explicit TurningLamps(const LampBlock& lamps) {
        for (std::size_t lamp = 0; lamp < lamps.size(); ++lamp) {
            lights_[lamp] = lane_light(*lamps.lights[lamp]);
            is_on_[lamp] = lamp_color(*lamps.lights[lamp]).maxCoeff() > 0 ? 1 : 0;
        }
    }

    // azimuth: of the scanner [rad].
    [[nodiscard]] LampsAtPoint shine(const Surface& surface,
                                     const SurfacePoint& point,
                                     double azimuth) const {
        using RayArray = std::array<float, kLampLanes>;
        const double turns = azimuth / (2 * kPi);
        const auto turn = float(turns - std::floor(turns));
        const Vec3f p = point.position.cast<float>();
        const Vec3f normal = point.normal.cast<float>();
        const Vec3f geometric = point.geometric_normal.cast<float>();
        std::array<RayArray, 3> w;
        RayArray cos_i, strength, distance;
        std::array<std::int32_t, kLampLanes> lit;
        for (std::size_t l = 0; l < kLampLanes; ++l) {
            const LaneLightSample sample = sample_lane_light(lights_[l], p.x(), p.y(), p.z(), turn);
            w[0][l] = sample.x;
            w[1][l] = sample.y;
            w[2][l] = sample.z;
            cos_i[l] = normal.x() * sample.x + normal.y() * sample.y + normal.z() * sample.z;
            const float departing =
                geometric.x() * sample.x + geometric.y() * sample.y + geometric.z() * sample.z;
            strength[l] = sample.strength;
            distance[l] = sample.distance;
            lit[l] = -(is_on_[l] & std::int32_t(cos_i[l] > 0) & std::int32_t(departing > 0) &
                       std::int32_t(strength[l] > 0));
        }
        const Vec3f origin = surface.tracer->offset(point, point.geometric_normal).cast<float>();
        std::array<RayArray, 3> origins;
        for (std::size_t c = 0; c < 3; ++c) origins[c].fill(origin[Eigen::Index(c)]);
        surface.tracer->lit_lanes(
            {{origins[0], origins[1], origins[2]}, {w[0], w[1], w[2]}, lit}, distance, lit);
        LampsAtPoint at;
        for (std::size_t l = 0; l < kLampLanes; ++l) {
            for (std::size_t c = 0; c < 3; ++c) at.w[c][l] = w[c][l];
            at.cos_i[l] = lit[l] != 0 ? cos_i[l] : 0.0f;
            at.strength[l] = lit[l] != 0 ? strength[l] : 0.0f;
        }
        return at;
    }

  private:
    std::array<LaneLight, kLampLanes> lights_;
    std::array<std::int32_t, kLampLanes> is_on_{};
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

LitTexel lit_texel(const LampBlock& lamps, const Lanes& units, std::size_t texel) {
    LitTexel lit;
    for (std::size_t lamp = 0; lamp < lamps.size(); ++lamp) {
        const DirectLight& direct = (*lamps.direct[lamp])[texel];
        const double color = lamp_color(*lamps.lights[lamp]).maxCoeff();
        if (!(color > 0) || !(direct.irradiance > 0).any()) continue;
        const auto irradiance = float(double(direct.irradiance.maxCoeff()) / color);
        lit.irradiance[lamp] = irradiance / units[lamp];
        lit.over_cosine[lamp] = lit.irradiance[lamp] / std::max(direct.cos_i, float(kCosineFloor));
    }
    return lit;
}

std::vector<LitTexel> lit_texels(const TexelAtlas& atlas,
                                 const LampBlock& lamps,
                                 const Lanes& units) {
    std::vector<LitTexel> lit(atlas.texels.size());
    parallel_for(lit.size(), [&](std::size_t i) { lit[i] = lit_texel(lamps, units, i); });
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
        if (k + kAhead < hits.size()) expect(directions[rows.hits[k + kAhead].to]);
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
    const TurningLamps turning(lamps);
    LargeVector<TurningHit> hits(rows.hits.size());
    parallel_for(atlas.texels.size(), [&](std::size_t i) {
        for (std::size_t k = rows.begin[i]; k < rows.begin[i + 1]; ++k) {
            const Vec3f w_o = -rows.hits[k].w;
            const SurfacePoint& point = atlas.texels[rows.hits[k].to].point;
            const LampsAtPoint at = turning.shine(surface, point, atlas.texels[i].azimuth);
            const Vec3f normal = point.normal.cast<float>();
            const Lanes irradiance = at.strength * at.cos_i / units;
            const float cos_o = normal.dot(w_o);
            const Lanes lowest = Lanes{} + float(kCosineFloor);
            const Lanes floored = at.cos_i < lowest ? lowest : at.cos_i;
            const Lanes versine =
                1.0f - (2.0f * cos_o * at.cos_i -
                        (w_o.x() * at.w[0] + w_o.y() * at.w[1] + w_o.z() * at.w[2]));
            hits[k].irradiance = to_compact(irradiance);
            hits[k].over_cosine =
                to_compact(irradiance / (floored * std::max(cos_o, float(kCosineFloor))));
            hits[k].theta_squared = to_compact(squared_angle(versine < 0.0f ? Lanes{} : versine));
        }
    });
    return hits;
}

}  // namespace patina
