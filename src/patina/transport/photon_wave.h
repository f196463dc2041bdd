// A wave of photons: followed together, one reflection after the other, so that random numbers and
// directions are computed in SIMD lanes, rays are sent in packets, and what the photons hit is
// asked of memory before it is needed.
//
// The photons are those that would be followed one by one: every number depends on the photon and
// the reflection alone.
#pragma once

#include "patina/base/piece_store.h"
#include "patina/transport/photon_columns.h"
#include "patina/transport/photon_join.h"
#include "patina/transport/photon_lanes.h"
#include "patina/transport/photon_numbers.h"
#include "patina/transport/photon_start.h"

#include <cstdint>
#include <vector>

namespace patina {

class PhotonWave {
  public:
    // Does not own what it is given. columns: null unless PhotonOptions::exact_columns.
    PhotonWave(const PhotonScene& scene,
               const PhotonStart& start,
               const PhotonNumbers& numbers,
               const PhotonOptions& options,
               bool turns_with_scanner,
               const PhotonColumns* columns);

    // Follows count <= kWaveSize photons from first_photon (even) on to their ends. Returns what
    // they did, photon by photon, kept by the wave as long as it lives. cursor: as for
    // PhotonStart::fill().
    [[nodiscard]] PhotonBlock follow(std::uint64_t first_photon,
                                     std::size_t count,
                                     PhotonStart::Cursor& cursor);

  private:
    // A photon that hit something, on its way to the record of an arrival.
    struct Hit {
        Vec3f normal;            // smooth, unit
        Vec3f position;          // [length]
        std::size_t cell = 0;    // of the atlas
        std::uint32_t lane = 0;  // that it came from
        TexelId texel = kNoTexel;
        float shading = 0;   // cosine to the smooth normal [-]
        float arriving = 0;  // cosine to the geometric normal [-]
    };
    struct Arrival {
        PhotonBounce bounce;
        Vec3f w_back;
        Vec3f position;
        std::uint32_t photon;
    };

    void sample_directions();
    void send_rays();
    void collect_hits();
    void turn_to_columns();
    void drop_unlit();
    void name_hits();
    void ask_for_triangle(std::size_t hit) const;
    void locate_hits();
    void find_texel(std::size_t number);
    void weigh_directions();
    void weigh_over_teeth();
    void keep_powers();
    void arrive(std::size_t hit);
    void reflect(std::size_t hit, float survival);
    [[nodiscard]] Vec3f w_back(const Hit& hit) const { return -lanes_.w_o.at(hit.lane); }
    [[nodiscard]] PhotonBlock block();

    const PhotonScene& scene_;
    const PhotonStart& start_;
    const PhotonNumbers& numbers_;
    const PhotonOptions& options_;
    bool turns_with_scanner_;
    const PhotonColumns* columns_;

    PhotonLanes lanes_;
    // By number of the hit.
    std::size_t num_hits_ = 0;
    std::vector<Hit> hits_;
    struct {
        Lane<std::uint32_t> lane, photon;
        // Of the directions that hit, as in PhotonLanes.
        Lane<float> cos_i, cos_o, departing, chord_squared, concentration, share, survival;
        Lane<float> theta_r_squared, lobe_cosines, geometry;
        Lane<float> choice, roulette;  // random numbers
        Lane3 origin, w_i;             // towards the lamp, before it is known to shine there
        Lane<float> distance;          // to the lamp [length]
        Lane<std::int32_t> lit;        // -1 or 0
    } hit_lanes_;
    // By number of the photon.
    Lane<std::uint32_t> num_bounces_;
    Lane<Rgbf> power_;               // [radiance x sr x length^2]; of those that hit something
    std::vector<Arrival> arrivals_;  // reflection by reflection
    std::size_t num_paths_ = 0;      // photons that arrived
    std::uint64_t num_rays_ = 0;

    // What the blocks refer to.
    PieceStore<PhotonPaths::Path> kept_paths_;
    PieceStore<PhotonArrival> kept_arrivals_;
    PieceStore<Vec3f> kept_positions_;
};

}  // namespace patina
