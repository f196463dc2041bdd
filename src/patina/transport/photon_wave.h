// A wave of photons: followed together, one reflection after the other, so that random numbers and
// directions are computed in SIMD lanes and the rays are sent off in one go.
//
// The photons are those that would be followed one by one: every number depends on the photon and
// the reflection alone.
#pragma once

#include "patina/math/lane_math.h"
#include "patina/transport/photon_paths.h"
#include "patina/transport/photon_scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patina {

// What one thread collects for one block of photons.
struct PhotonBlock {
    std::vector<PhotonPaths::Path> paths;  // first_bounce counts within the block
    std::vector<PhotonBounce> bounces;
    std::vector<Vec3f> directions;  // per bounce, from the arrival back along the photon's way
    std::vector<Vec3f> positions;   // per bounce, of the arrival; empty unless wanted
    std::uint64_t rays = 0;
};

class PhotonWave {
  public:
    // Photons in a wave: few enough that their lanes stay in the second-level cache. Even.
    static constexpr std::size_t kSize = 1024;

    // A photon that falls on the surface.
    struct Start {
        std::size_t number = 0;  // in the wave; its parity is the half that the photon belongs to
        TexelId texel = kNoTexel;
        Vec3f w_i = Vec3f::UnitZ();
        Rgbf power = Rgbf::Zero();  // [radiance x sr x length^2]
        double azimuth = 0;         // of the lamp, where lamps turn [rad]
    };

    // element_hashes: of the random numbers of the two halves. num_lamp_pairs: pairs of random
    // numbers that the photons took before. Does not own what it is given by reference.
    PhotonWave(const PhotonScene& scene,
               const TexelAtlas& atlas,
               const PhotonOptions& options,
               bool turns_with_scanner,
               const std::array<std::uint32_t, 2>& element_hashes,
               std::uint32_t num_lamp_pairs);

    // first_sample: number of the wave's first photon within its half.
    void clear(std::uint32_t first_sample);
    // In ascending order of start.number, which is below kSize; the texel faces w_i.
    void add(const Start& start);
    // Follows all photons to their ends and appends what they did, photon by photon.
    void follow(PhotonBlock& block);

  private:
    template <typename Value>
    using Lane = std::array<Value, kSize>;
    struct alignas(64) Lane3 {
        Lane<float> x, y, z;
        void set(std::size_t i, const Vec3f& v) {
            x[i] = v.x();
            y[i] = v.y();
            z[i] = v.z();
        }
        [[nodiscard]] Vec3f at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    };
    struct Arrival {
        PhotonBounce bounce;
        Vec3f w_back;
        Vec3f position;
        std::uint32_t photon;
    };

    void draw(std::uint32_t pair, Lane<float>& first, Lane<float>& second) const;
    void sample_directions();
    void weigh_directions();
    void send_rays();
    void arrive(std::size_t ray, std::size_t lane);
    void set_guide(std::size_t lane, TexelId texel, float survival);
    void append_to(PhotonBlock& block);

    const PhotonScene& scene_;
    const TexelAtlas& atlas_;
    const PhotonOptions& options_;
    bool turns_with_scanner_;
    std::array<std::uint32_t, 2> element_hashes_;
    std::uint32_t num_lamp_pairs_;

    // Photons at the surface, about to be reflected; the living ones come first.
    std::size_t size_ = 0;
    Lane3 position_, geometric_normal_, normal_, w_i_;
    Lane<float> diffuse_, lobe_, concentration_, survival_;
    Lane<float> choice_;  // random number that chooses between the diffuse part and the lobe
    Lane<std::uint32_t> element_hash_, sample_;
    Lane<TexelId> texel_;
    Lane<std::uint32_t> photon_;
    // Where they are reflected to.
    Lane3 w_o_, mirror_, origin_;
    Lane<float> u_, v_;  // random numbers of the direction
    Lane<float> share_, theta_r_squared_, lobe_cosines_, geometry_;
    Lane<std::uint32_t> leaves_;  // 1 where the direction leaves the surface
    Lane<float> next_choice_, next_roulette_;
    Lane<std::uint32_t> lane_of_ray_;
    std::vector<TraceRay> rays_;
    std::vector<TriangleHit> hits_;
    std::size_t num_next_ = 0;  // photons that live on, already in their lanes
    // Per photon of the wave.
    std::uint32_t first_sample_ = 0;
    Lane<Rgbf> power_;
    Lane<double> azimuth_;
    Lane<std::uint32_t> num_bounces_;
    std::vector<Arrival> arrivals_;  // reflection by reflection
    std::uint64_t num_rays_ = 0;
};

}  // namespace patina
