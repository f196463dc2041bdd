#include "patina/estimate/lobe_spread.h"

#include "patina/base/parallel.h"
#include "patina/scene/grid_neighbors.h"

#include <array>
#include <optional>
#include <span>

namespace patina {
namespace {

constexpr double kPixelMoment = 1.0 / 12;
constexpr double kBilinearMoment = 1.0 / 6;
// Neighbours whose normals lie further apart than this belong to another face: no pixel mixes them
// without being left out [-].
constexpr double kSameFace = 0.7;

// How far the view lies from the mirror direction, as a chord [-].
Vec3 chord(const Vec3& normal, const Vec3& w_i, const Vec3& w_v) {
    return w_v + w_i - 2 * normal.dot(w_i) * normal;
}

// A texel and its neighbours on the grid: to the left and right, above and below.
constexpr std::size_t kPlaces = 5;
using Views = std::array<Vec3, kPlaces>;  // from each towards one camera

class Footprints {
  public:
    Footprints(const Capture& capture, const SceneView& scene)
        : capture_(capture), scene_(scene), moments_(footprint_moments(capture, scene)) {}

    void spread(std::size_t texel, Observations& observations) const {
        const GridNeighbors near = grid_neighbors(capture_.atlas, texel);
        const double azimuth = capture_.atlas.texels[texel].azimuth;
        std::array<TexelId, kPlaces> places;
        places[0] = TexelId(texel);
        for (std::size_t side = 0; side < near.size(); ++side) {
            const bool is_near = near[side] != kNoTexel && same_face(near[side], texel);
            places[1 + side] = is_near ? near[side] : kNoTexel;
        }
        Views views;
        const Camera* camera = nullptr;
        for (const Observation& look : observations.of(texel)) {
            const Shot& shot = capture_.description.shots[scene_.shots[look.shot]];
            if (camera != &capture_.description.cameras[shot.camera]) {
                camera = &capture_.description.cameras[shot.camera];
                views = views_from(places, *camera, azimuth);
            }
            const double moment = moments_[scene_.camera_of_shot[look.shot]];
            std::size_t term = look.first_term;
            for (const std::size_t light :
                 scene_.lamp_sets[scene_.lamp_set_of_shot[look.shot]].indices) {
                if (scene_.direct[light][texel].irradiance.maxCoeff() <= 0) continue;
                const Light& lamp = capture_.description.lights[light];
                spread_term(places, views, lamp, azimuth, moment, observations.terms[term++]);
            }
        }
    }

  private:
    [[nodiscard]] bool same_face(TexelId a, std::size_t b) const {
        const std::span<const Texel> texels = capture_.atlas.texels;
        return texels[a].point.normal.dot(texels[b].point.normal) > kSameFace;
    }
    // While the scanner stands as for `azimuth`.
    [[nodiscard]] Views views_from(const std::array<TexelId, kPlaces>& places,
                                   const Camera& camera,
                                   double azimuth) const {
        Views views;
        for (std::size_t k = 0; k < kPlaces; ++k) {
            if (places[k] == kNoTexel) continue;
            views[k] =
                camera.direction_from(capture_.atlas.texels[places[k]].point.position, azimuth);
        }
        return views;
    }

    void spread_term(const std::array<TexelId, kPlaces>& places,
                     const Views& views,
                     const Light& light,
                     double azimuth,
                     double moment,
                     LampTerm& term) const {
        const auto chord_at = [&](std::size_t place) {
            const SurfacePoint& point = capture_.atlas.texels[places[place]].point;
            return chord(
                point.normal, sample_light(light, point.position, azimuth).w_i, views[place]);
        };
        const Vec3 center = chord_at(0);
        const double length = center.norm();
        double along = 0;
        double total = 0;
        for (const std::size_t axis : {1, 3}) {
            // The smaller of both differences: the larger one may reach over an edge.
            std::optional<Vec3> step;
            for (const std::size_t side : {axis, axis + 1}) {
                if (places[side] == kNoTexel) continue;
                const Vec3 difference = chord_at(side) - center;
                if (!step || difference.squaredNorm() < step->squaredNorm()) step = difference;
            }
            if (!step) continue;
            total += step->squaredNorm();
            if (length > 0) along += square(step->dot(center) / length);
        }
        // At the lobe's very middle every direction is alike.
        if (length == 0) along = 0.5 * total;
        term.spread_along = float(moment * along);
        term.spread_across = float(moment * (total - along));
    }

    const Capture& capture_;
    const SceneView& scene_;
    std::vector<double> moments_;
};

}  // namespace

std::vector<double> footprint_moments(const Capture& capture, const SceneView& scene) {
    std::vector<double> moments(scene.views.size(), kPixelMoment);
    for (std::size_t shot = 0; shot < scene.shots.size(); ++shot) {
        const std::size_t view = scene.camera_of_shot[shot];
        const Camera& camera =
            capture.description.cameras[capture.description.shots[scene.shots[shot]].camera];
        if (camera.model == CameraModel::registered) continue;
        moments[view] = square(pixel_over_texel(capture.atlas, camera, scene.views[view])) *
                        (kPixelMoment + kBilinearMoment);
    }
    return moments;
}

void spread_over_footprints(const Capture& capture,
                            const SceneView& scene,
                            Observations& observations) {
    const Footprints footprints(capture, scene);
    parallel_for(capture.atlas.texels.size(),
                 [&](std::size_t texel) { footprints.spread(texel, observations); });
}

}  // namespace patina
