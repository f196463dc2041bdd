// Photons of a lamp that turns with the scanner, counted exactly for the column where they arrive.
//
// What a lobe sends on of the lamp to a texel depends on where the lamp stands for that texel's
// column, and in a narrow lobe the lamp's image moves by its own width within a few degrees. So a
// photon leaves as if the lamp stood at one of the teeth of a comb of azimuths about the column
// where it starts; once it has arrived, the lamp is put where it stands for the column there, and
// the photon carries that lamp's light over the density of its direction from all teeth together.
// For one reflection, by the lobe alone: docs/theory.md, "Narrow lobes".
#pragma once

#include "patina/scene/light_lanes.h"
#include "patina/transport/photon_scene.h"

#include <array>
#include <cstddef>

namespace patina {

class PhotonColumns {
  public:
    // Does not own the scene.
    PhotonColumns(const PhotonScene& scene, const Light& lamp);

    // From the column where a photon starts to the tooth that it takes [rad]. u, v: random numbers
    // in [0, 1).
    [[nodiscard]] static float offset(float u, float v);

    // Of the direction w_o (unit) of a photon from this texel's lobe, from all teeth together
    // [1/sr]; teeth at which the lamp does not light the texel, shadows aside, count for nothing.
    [[nodiscard]] float density(const PhotonTexel& texel, const Vec3f& w_o) const;

  private:
    // A tooth every 2.5 degrees all around: 1.75 sigma of the narrowest lobe that directions are
    // drawn from, so that the teeth leave no gaps between them.
    static constexpr std::size_t kTeeth = 144;
    // Those in the middle are taken more often.
    static constexpr std::size_t kNearTeeth = 20;
    static constexpr float kNearShare = 0.8f;

    const PhotonScene& scene_;
    LaneLight lamp_;
    std::array<float, kTeeth> offsets_;        // [rad]
    std::array<float, kTeeth> probabilities_;  // [-]
};

}  // namespace patina
