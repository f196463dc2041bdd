#include "patina/estimate/calibration_errors.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

namespace patina {
namespace {

// Noise of the normals makes a gradient between next neighbours noise; with so many rings a plane
// has 1/26 of its variance.
constexpr int kGradientRings = 3;

// Those within so many rings of a texel, itself included.
std::vector<TexelId> texels_around(const TexelAtlas& atlas, TexelId texel, int rings) {
    std::vector<TexelId> around = {texel};
    std::size_t begin = 0;
    for (int ring = 0; ring < rings; ++ring) {
        const std::size_t end = around.size();
        for (; begin < end; ++begin) {
            for (std::uint32_t k = atlas.neighbor_begin[around[begin]];
                 k < atlas.neighbor_begin[around[begin] + 1];
                 ++k) {
                if (std::find(around.begin(), around.end(), atlas.neighbors[k]) == around.end()) {
                    around.push_back(atlas.neighbors[k]);
                }
            }
        }
    }
    return around;
}

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

    // Row by row, how direct light under these maps changes per pixel along x and y of the image: a
    // plane through the neighbours that the same camera sees under the same lamps. Zero where they
    // do not span the image's plane.
    [[nodiscard]] std::vector<std::array<Rgb, 2>> light_gradients() {
        around_ = texels_around(capture_.atlas, TexelId(index_), kGradientRings);
        std::vector<std::array<Rgb, 2>> gradients;
        const std::span<const Observation> looks = observations_.of(index_);
        for (std::size_t j = 0; j < rows_.size(); ++j) {
            gradients.push_back(light_gradient(looks[j]));
        }
        return gradients;
    }

  private:
    [[nodiscard]] std::array<Rgb, 2> light_gradient(const Observation& look) const {
        const std::vector<TexelView>& views = scene_.views[scene_.camera_of_shot[look.shot]];
        const Shot& shot = capture_.description.shots[scene_.shots[look.shot]];
        const bool is_registered =
            capture_.description.cameras[shot.camera].model == CameraModel::registered;
        // Sums over texels of (1, step)(1, step)' and of (1, step) radiance'.
        Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
        Eigen::Matrix3d change = Eigen::Matrix3d::Zero();
        for (const TexelId neighbor : around_) {
            const std::optional<Rgb> there = direct_radiance_of(neighbor, look, views[neighbor]);
            if (!there) continue;
            Vec2 step = (views[neighbor].pixel - views[index_].pixel).cast<double>();
            if (is_registered) {
                // Those of a full turn have no first column; across a seam of the texel domain
                // they show other places.
                if (capture_.atlas.wraps_around) {
                    step.x() = std::remainder(step.x(), double(capture_.atlas.width));
                }
                if (step.norm() > kGradientRings + 0.5) continue;
            }
            const Vec3 one_and_step(1, step.x(), step.y());
            spread += one_and_step * one_and_step.transpose();
            change += one_and_step * there->matrix().transpose();
        }
        // Texels all in a row tell nothing of the other axis.
        const Eigen::FullPivLU<Eigen::Matrix3d> plane(spread);
        if (plane.rank() < 3) return {Rgb::Zero(), Rgb::Zero()};
        const Eigen::Matrix3d solution = plane.solve(change);
        return {Rgb(solution.row(1).transpose().array()), Rgb(solution.row(2).transpose().array())};
    }

    // Of a texel with this one's maps, in the same shot; nothing where it is hidden or a lamp of
    // the look does not reach it.
    [[nodiscard]] std::optional<Rgb> direct_radiance_of(std::size_t index,
                                                        const Observation& look,
                                                        const TexelView& view) const {
        if (view.state != ViewState::clear) return std::nullopt;
        const Texel& texel = capture_.atlas.texels[index];
        Rgb sum = Rgb::Zero();
        for (const std::size_t light : lamps(look).indices) {
            if (!is_lit(light)) continue;
            if (!(scene_.direct[light][index].irradiance.maxCoeff() > 0)) return std::nullopt;
            const LightSample own = sample_light(
                capture_.description.lights[light], texel.point.position, texel.azimuth);
            sum += radiance(own, texel.point.normal, view.w_v.cast<double>().normalized());
        }
        return sum;
    }

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
    std::vector<TexelId> around_;
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

CalibrationErrors::CalibrationErrors(const Capture& capture,
                                     const SceneView& scene,
                                     const Observations& observations)
    : capture_(capture), scene_(scene), observations_(observations) {
    for (std::size_t index = 0; index < scene.direct.size(); ++index) {
        if (scene.direct[index].empty()) continue;
        const Light& light = capture.description.lights[index];
        if (light.position_stddev > 0 && light.type == LightType::point) {
            add_shared(SharedErrorKind::lamp_position, index, 3);
        }
        if (light.direction_stddev > 0 && light.direction) {
            add_shared(SharedErrorKind::lamp_direction, index, 2);
        }
        if (light.intensity_stddev > 0) add_shared(SharedErrorKind::lamp_intensity, index, 1);
    }
    if (capture.description.geometry.registration_stddev > 0) {
        for (std::size_t camera = 0; camera < scene.views.size(); ++camera) {
            add_shared(SharedErrorKind::image_shift, camera, 2);
        }
    }
}

void CalibrationErrors::add_shared(SharedErrorKind kind, std::size_t index, int num_axes) {
    for (int axis = 0; axis < num_axes; ++axis) shared_.push_back({kind, index, axis});
}

FoundError CalibrationErrors::found(const SharedError& error,
                                    double value,
                                    double standard_error) const {
    FoundError found{error.kind, "", error.axis, 0, 0, 0};
    const CaptureDescription& description = capture_.description;
    if (error.kind == SharedErrorKind::image_shift) {
        const auto shot =
            std::find(scene_.camera_of_shot.begin(), scene_.camera_of_shot.end(), error.index);
        const std::size_t used = scene_.shots[std::size_t(shot - scene_.camera_of_shot.begin())];
        found.id = description.cameras[description.shots[used].camera].id;
        found.stated = description.geometry.registration_stddev;
    } else {
        const Light& light = description.lights[error.index];
        found.id = light.id;
        found.stated = error.kind == SharedErrorKind::lamp_position    ? light.position_stddev
                       : error.kind == SharedErrorKind::lamp_direction ? light.direction_stddev
                                                                       : light.intensity_stddev;
    }
    found.value = found.stated * value;
    found.standard_error = found.stated * standard_error;
    return found;
}

void CalibrationErrors::visit(std::size_t texel,
                              std::span<const FitRow> rows,
                              const Reflectance& fitted,
                              const Visit& visit) const {
    Looks looks(capture_, scene_, observations_, texel, rows, fitted);
    for (std::size_t k = 0; k < shared_.size(); ++k) {
        const auto& [kind, index, axis] = shared_[k];
        if (kind == SharedErrorKind::image_shift) {
            visit(looks.with_shift(
                      index, std::size_t(axis), capture_.description.geometry.registration_stddev),
                  k);
            continue;
        }
        if (!looks.lights().contains(index)) continue;
        const Light& light = capture_.description.lights[index];
        if (kind == SharedErrorKind::lamp_position) {
            Light moved = light;
            moved.position[axis] += light.position_stddev;
            visit(looks.with_lamp(index, moved), k);
        } else if (kind == SharedErrorKind::lamp_direction) {
            visit(looks.with_lamp(index, turned(light, std::size_t(axis))), k);
        } else {
            visit(looks.with_intensity(index, light.intensity_stddev), k);
        }
    }
    const Vec3& normal = capture_.atlas.texels[texel].point.normal;
    const Vec3 remainder = normal_remainder(capture_.atlas, texel);
    if (remainder != Vec3::Zero()) {
        visit(looks.with_normal((normal + remainder).normalized()), std::nullopt);
    }
    const double tilt = capture_.description.geometry.normal_stddev;
    if (tilt <= 0) return;
    const Vec3 first = normal.unitOrthogonal();
    for (const Vec3& axis : {first, Vec3(normal.cross(first))}) {
        visit(looks.with_normal((normal + std::tan(tilt) * axis).normalized()), std::nullopt);
    }
}

std::vector<SharedChange> CalibrationErrors::light_shifts(std::size_t texel,
                                                          std::span<const FitRow> rows,
                                                          const Reflectance& fitted) const {
    std::vector<SharedChange> changes;
    const double pixels = capture_.description.geometry.registration_stddev;
    if (!(pixels > 0)) return changes;
    Looks looks(capture_, scene_, observations_, texel, rows, fitted);
    const std::vector<std::array<Rgb, 2>> gradients = looks.light_gradients();
    const std::span<const Observation> observed = observations_.of(texel);
    for (std::size_t k = 0; k < shared_.size(); ++k) {
        if (shared_[k].kind != SharedErrorKind::image_shift) continue;
        SharedChange& change = changes.emplace_back();
        change = {k, std::vector<Rgb>(rows.size(), Rgb::Zero())};
        for (std::size_t j = 0; j < rows.size(); ++j) {
            if (scene_.camera_of_shot[observed[j].shot] != shared_[k].index) continue;
            change.radiance[j] = pixels * gradients[j][std::size_t(shared_[k].axis)];
        }
    }
    return changes;
}

}  // namespace patina
