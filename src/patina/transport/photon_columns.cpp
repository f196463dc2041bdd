#include "patina/transport/photon_columns.h"

#include "patina/transport/lane_directions.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

constexpr auto kTurn = float(2 * kPi);

}  // namespace

PhotonColumns::PhotonColumns(const PhotonScene& scene, const Light& lamp)
    : scene_(scene), lamp_(lane_light(lamp)) {
    for (std::size_t k = 0; k < kTeeth; ++k) {
        offsets_[k] = (float(k) + 0.5f - 0.5f * kTeeth) * (kTurn / kTeeth);
        probabilities_[k] = (1 - kNearShare) / kTeeth;
    }
    for (std::size_t k = (kTeeth - kNearTeeth) / 2; k < (kTeeth + kNearTeeth) / 2; ++k) {
        probabilities_[k] += kNearShare / kNearTeeth;
    }
}

float PhotonColumns::offset(float u, float v) {
    const auto count = float(u < kNearShare ? kNearTeeth : kTeeth);
    const float tooth = std::min(std::floor(v * count), count - 1);
    return (tooth + 0.5f - 0.5f * count) * (kTurn / kTeeth);
}

float PhotonColumns::density(const PhotonTexel& texel, const Vec3f& w_o) const {
    const Vec3f p = texel.origin - scene_.offset_length() * texel.geometric_normal;
    const LaneDirection normal = {texel.normal.x(), texel.normal.y(), texel.normal.z()};
    const LaneDirection geometric = {
        texel.geometric_normal.x(), texel.geometric_normal.y(), texel.geometric_normal.z()};
    const LaneDirection to = {w_o.x(), w_o.y(), w_o.z()};
    const float px = p.x(), py = p.y(), pz = p.z();
    const float azimuth = texel.azimuth;
    const float concentration = texel.concentration;
    const LaneLight lamp = lamp_;
    std::array<float, kTeeth> densities;
    for (std::size_t k = 0; k < kTeeth; ++k) {
        const float turns = (azimuth + offsets_[k]) * (1 / kTurn);
        const LaneLightSample sample =
            sample_lane_light(lamp, px, py, pz, turns - std::floor(turns));
        const LaneDirection w_i = {sample.x, sample.y, sample.z};
        const float cos_i = lane_dot(normal, w_i);
        const float arriving = lane_dot(geometric, w_i);
        const float chord_squared = lane_chord_squared(lane_mirror(normal, w_i, cos_i), to);
        const float density = probabilities_[k] * lane_lobe_density(concentration, chord_squared);
        const float facing = std::min(cos_i, arriving) > 0 ? density : 0.0f;
        densities[k] = sample.strength > 0 ? facing : 0.0f;
    }
    float sum = 0;
    for (const float density : densities) sum += density;
    return sum;
}

}  // namespace patina
