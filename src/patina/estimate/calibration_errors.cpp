#include "patina/estimate/calibration_errors.h"

#include <algorithm>
#include <array>
#include <set>
#include <vector>

namespace patina {
namespace {

// The looks at one texel, and what each would show if something stood elsewhere.
class Looks {
  public:
    Looks(const Capture& capture,
          const SceneView& scene,
          const Observations& observations,
          std::size_t texel,
          std::span<const FitRow> rows,
          const Reflectance& fitted)
        : capture_(capture),
          scene_(scene),
          observations_(observations),
          index_(texel),
          texel_(capture.atlas.texels[texel]),
          rows_(rows),
          fitted_(fitted),
          change_(rows.size()) {
        for (const Observation& look : observations.of(texel)) {
            for (const std::size_t light : lamps(look).indices) {
                if (is_lit(light)) lights_.insert(light);
            }
        }
    }

    // Lamps that light the texel in some look; indices into the capture's.
    [[nodiscard]] const std::set<std::size_t>& lights() const { return lights_; }

    // Row by row, the radiance with `moved` in the place of one lamp, less the present one.
    std::span<const Rgb> with_lamp(std::size_t light, const Light& moved) {
        const Vec3& normal = texel_.point.normal;
        const LightSample before = sample(capture_.description.lights[light]);
        const LightSample after = sample(moved);
        for_rows([&](const Observation& look, const FitRow&) -> Rgb {
            if (!uses(look, light)) return Rgb::Zero();
            const Vec3 w_v = view(look);
            return radiance(after, normal, w_v) - radiance(before, normal, w_v);
        });
        return change_;
    }

    // The lamp shines brighter by a share, and so does the indirect light that is its own.
    std::span<const Rgb> with_intensity(std::size_t light, double share) {
        const LightSample own = sample(capture_.description.lights[light]);
        for_rows([&](const Observation& look, const FitRow& row) -> Rgb {
            if (!uses(look, light)) return Rgb::Zero();
            Rgb direct = Rgb::Zero();
            for (const LampTerm& lamp : row.lamps) direct += lamp.irradiance.cast<double>();
            const Rgb part = own.irradiance * std::max(0.0, texel_.point.normal.dot(own.w_i)) /
                             direct.max(1e-300);
            return share * part.min(1.0) * predict(row, fitted_);
        });
        return change_;
    }

    std::span<const Rgb> with_normal(const Vec3& normal) {
        for_rows([&](const Observation& look, const FitRow&) {
            Rgb change = Rgb::Zero();
            const Vec3 w_v = view(look);
            for (const std::size_t light : lamps(look).indices) {
                if (!is_lit(light)) continue;
                const LightSample own = sample(capture_.description.lights[light]);
                change += radiance(own, normal, w_v) - radiance(own, texel_.point.normal, w_v);
            }
            return change;
        });
        return change_;
    }

    // The images of one camera shifted along an axis (0: x, 1: y) of theirs. pixels: how far.
    std::span<const Rgb> with_shift(std::size_t camera, std::size_t axis, double pixels) {
        const std::size_t first = observations_.begin[index_];
        std::size_t k = 0;
        for_rows([&](const Observation& look, const FitRow&) -> Rgb {
            const std::size_t row = first + k++;
            if (scene_.camera_of_shot[look.shot] != camera) return Rgb::Zero();
            return pixels * observations_.gradients[row][axis].cast<double>();
        });
        return change_;
    }

  private:
    template <typename Change>
    void for_rows(const Change& change) {
        const std::span<const Observation> looks = observations_.of(index_);
        for (std::size_t j = 0; j < rows_.size(); ++j) change_[j] = change(looks[j], rows_[j]);
    }
    [[nodiscard]] const LampSet& lamps(const Observation& look) const {
        return scene_.lamp_sets[scene_.lamp_set_of_shot[look.shot]];
    }
    [[nodiscard]] bool is_lit(std::size_t light) const {
        return scene_.direct[light][index_].irradiance.maxCoeff() > 0;
    }
    [[nodiscard]] bool uses(const Observation& look, std::size_t light) const {
        const std::vector<std::size_t>& indices = lamps(look).indices;
        return std::find(indices.begin(), indices.end(), light) != indices.end();
    }
    [[nodiscard]] Vec3 view(const Observation& look) const {
        return scene_.views[scene_.camera_of_shot[look.shot]][index_]
            .w_v.cast<double>()
            .normalized();
    }
    [[nodiscard]] LightSample sample(const Light& light) const {
        return sample_light(light, texel_.point.position, texel_.azimuth);
    }
    [[nodiscard]] Rgb radiance(const LightSample& light,
                               const Vec3& normal,
                               const Vec3& w_v) const {
        const double cos_i = normal.dot(light.w_i);
        return cos_i > 0 ? Rgb(light.irradiance * cos_i * evaluate(fitted_, normal, light.w_i, w_v))
                         : Rgb(Rgb::Zero());
    }

    const Capture& capture_;
    const SceneView& scene_;
    const Observations& observations_;
    std::size_t index_;
    const Texel& texel_;
    std::span<const FitRow> rows_;
    const Reflectance& fitted_;
    std::set<std::size_t> lights_;
    std::vector<Rgb> change_;
};

// Normals that come from differences over two texels, or that are interpolated, are off by about a
// sixth of their second difference (the remainder of the central difference quotient). The part of
// it that tilts the normal [rad].
Vec3 normal_remainder(const TexelAtlas& atlas, std::size_t texel) {
    constexpr double kRemainder = 1.0 / 6;
    const std::uint32_t begin = atlas.neighbor_begin[texel];
    const std::uint32_t end = atlas.neighbor_begin[texel + 1];
    if (end - begin < 4) return Vec3::Zero();
    const Vec3& normal = atlas.texels[texel].point.normal;
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t k = begin; k < end; ++k) {
        sum += atlas.texels[atlas.neighbors[k]].point.normal - normal;
    }
    const Vec3 remainder = kRemainder * 4 / double(end - begin) * sum;
    return remainder - normal.dot(remainder) * normal;
}

// The lamp turned about an axis across its direction.
Light turned(const Light& light, std::size_t axis) {
    Light moved = light;
    const Vec3 first = light.direction->unitOrthogonal();
    const Vec3 across = axis == 0 ? first : Vec3(light.direction->cross(first));
    moved.direction = (*light.direction + std::tan(light.direction_stddev) * across).normalized();
    return moved;
}

}  // namespace

void CalibrationErrors::visit(std::size_t texel,
                              std::span<const FitRow> rows,
                              const Reflectance& fitted,
                              const std::function<void(std::span<const Rgb>)>& visit) const {
    Looks looks(capture_, scene_, observations_, texel, rows, fitted);
    for (const std::size_t index : looks.lights()) {
        const Light& light = capture_.description.lights[index];
        if (light.position_stddev > 0 && light.type == LightType::point) {
            for (int axis = 0; axis < 3; ++axis) {
                Light moved = light;
                moved.position[axis] += light.position_stddev;
                visit(looks.with_lamp(index, moved));
            }
        }
        if (light.direction_stddev > 0 && light.direction) {
            for (const std::size_t axis : {0, 1}) {
                visit(looks.with_lamp(index, turned(light, axis)));
            }
        }
        if (light.intensity_stddev > 0) {
            visit(looks.with_intensity(index, light.intensity_stddev));
        }
    }
    const GeometrySource& geometry = capture_.description.geometry;
    const Vec3& normal = capture_.atlas.texels[texel].point.normal;
    const Vec3 remainder = normal_remainder(capture_.atlas, texel);
    if (remainder != Vec3::Zero()) visit(looks.with_normal((normal + remainder).normalized()));
    if (geometry.normal_stddev > 0) {
        const Vec3 first = normal.unitOrthogonal();
        for (const Vec3& axis : {first, Vec3(normal.cross(first))}) {
            const Vec3 tilted = (normal + std::tan(geometry.normal_stddev) * axis).normalized();
            visit(looks.with_normal(tilted));
        }
    }
    if (geometry.registration_stddev > 0) {
        for (std::size_t camera = 0; camera < scene_.views.size(); ++camera) {
            for (const std::size_t axis : {0, 1}) {
                visit(looks.with_shift(camera, axis, geometry.registration_stddev));
            }
        }
    }
}

}  // namespace patina
