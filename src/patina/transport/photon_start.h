// Where the photons of one set of lamps fall on the surface first: texels in proportion to the
// light they send on, by stratified inversion; where photons count for exact columns, in proportion
// to what they reflect, as a texel may be lit from another column than its own.
#pragma once

#include "patina/scene/light_lanes.h"
#include "patina/transport/photon_numbers.h"
#include "patina/transport/photon_paths.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patina {

class PhotonStart {
  public:
    // Pairs of random numbers that a start takes at most.
    static constexpr std::uint32_t kNumPairs = 2;

    // Does not own what it is given.
    PhotonStart(const PhotonScene& scene,
                const LampSet& lamps,
                const PhotonOptions& options,
                const PhotonNumbers& numbers);

    [[nodiscard]] bool has_light() const { return total_ > 0; }

    // Goes through the texels in their order, for one block of photons.
    class Cursor {
      public:
        // photon: the first that will be asked for; even.
        Cursor(const PhotonStart& start, std::uint64_t photon);

      private:
        friend class PhotonStart;
        std::array<std::size_t, 2> texel_{};  // per half
    };

    // Fills the lanes with the photons first_photon (even) to first_photon + count - 1, not below
    // those that the cursor was asked for before. Photons that face no lamp are not active. Whether
    // anything lies between a photon and a lamp that turns is left to be asked.
    void fill(std::uint64_t first_photon,
              std::size_t count,
              Cursor& cursor,
              PhotonLanes& lanes) const;
    // For PhotonOptions::exact_columns: as if the lamp had stood at lanes.azimuth when they were
    // filled in.
    void turn_lamp(PhotonLanes& lanes) const;
    // What a photon carries that was filled in [radiance x sr x length^2].
    [[nodiscard]] Rgbf power(const PhotonLanes& lanes, std::size_t lane) const;

  private:
    [[nodiscard]] std::vector<double> importance() const;
    void accumulate(std::vector<double> importance);
    void share_lamps();
    // Of total_, between one photon of a half and the next.
    [[nodiscard]] double light_per_photon(std::uint64_t half) const;
    void choose_texels(std::uint64_t first_photon, Cursor& cursor, PhotonLanes& lanes) const;
    void fixed_lamps(PhotonLanes& lanes) const;
    void sample_azimuths(PhotonLanes& lanes) const;
    void choose_teeth(PhotonLanes& lanes) const;
    void turning_lamps(PhotonLanes& lanes) const;

    const PhotonScene& scene_;
    const LampSet& lamps_;
    const PhotonOptions& options_;
    const PhotonNumbers& numbers_;
    double total_ = 0;
    // Per texel: sums up to and with it; from the last texel with light on infinite.
    std::vector<double> cumulative_;
    std::vector<float> area_per_photon_;  // area / (probability x photons) [length^2]
    // Several lamps that stand still: per texel and lamp, share of the light up to and with it.
    std::vector<float> lamp_shares_;
    // Lamps that turn.
    std::vector<LaneLight> turning_;
};

}  // namespace patina
