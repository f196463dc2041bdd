#include "patina/estimate/lobe_spread.h"

#include "patina/base/parallel.h"
#include "patina/scene/grid_neighbors.h"

#include <optional>

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

class Footprints {
  public:
    Footprints(const Capture& capture, const SceneView& scene)
        : capture_(capture), scene_(scene), moments_(footprint_moments(capture, scene)) {}

    void spread(std::size_t texel, const Observation& look, std::span<LampTerm> terms) const {
        const GridNeighbors near = grid_neighbors(capture_.atlas, texel);
        const std::size_t view = scene_.camera_of_shot[look.shot];
        const Camera& camera =
            capture_.description
                .cameras[capture_.description.shots[scene_.shots[look.shot]].camera];
        std::size_t term = 0;
        for (const std::size_t light :
             scene_.lamp_sets[scene_.lamp_set_of_shot[look.shot]].indices) {
            if (scene_.direct[light][texel].irradiance.maxCoeff() <= 0) continue;
            spread_term(texel, near, camera, light, moments_[view], terms[term++]);
        }
    }

  private:
    [[nodiscard]] bool same_face(TexelId a, std::size_t b) const {
        const std::vector<Texel>& texels = capture_.atlas.texels;
        return texels[a].point.normal.dot(texels[b].point.normal) > kSameFace;
    }
    // The chord at a texel's point while scanner and lamp stand as for `azimuth`.
    [[nodiscard]] Vec3 chord_at(TexelId texel,
                                const Camera& camera,
                                std::size_t light,
                                double azimuth) const {
        const SurfacePoint& point = capture_.atlas.texels[texel].point;
        return chord(point.normal,
                     sample_light(capture_.description.lights[light], point.position, azimuth).w_i,
                     camera.direction_from(point.position, azimuth));
    }

    void spread_term(std::size_t texel,
                     const GridNeighbors& near,
                     const Camera& camera,
                     std::size_t light,
                     double moment,
                     LampTerm& term) const {
        const double azimuth = capture_.atlas.texels[texel].azimuth;
        const Vec3 center = chord_at(TexelId(texel), camera, light, azimuth);
        const double length = center.norm();
        double along = 0;
        double total = 0;
        for (const std::size_t axis : {0, 2}) {
            // The smaller of both differences: the larger one may reach over an edge.
            std::optional<Vec3> step;
            for (const std::size_t side : {axis, axis + 1}) {
                if (near[side] == kNoTexel || !same_face(near[side], texel)) continue;
                const Vec3 difference = chord_at(near[side], camera, light, azimuth) - center;
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
    parallel_for(capture.atlas.texels.size(), [&](std::size_t texel) {
        for (const Observation& look : observations.of(texel)) {
            footprints.spread(
                texel,
                look,
                std::span(observations.terms).subspan(look.first_term, look.num_terms));
        }
    });
}

}  // namespace patina
