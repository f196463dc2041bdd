// The state of a wave of photons, side by side as SIMD lanes read it.
//
// One struct, so that the compiler knows without a check at run time that no lane overlaps another.
#pragma once

#include "patina/math/types.h"
#include "patina/raytrace/tracer.h"
#include "patina/scene/atlas.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace patina {

// Photons in a wave: few enough that their lanes stay in the second-level cache. Even.
inline constexpr std::size_t kWaveSize = 1024;

// A cache line more than the photons need: lanes 4096 bytes apart would all lie in the same few
// lines of the first-level cache.
template <typename Value>
using Lane = std::array<Value, kWaveSize + 16>;

struct alignas(64) Lane3 {
    Lane<float> x, y, z;
    void set(std::size_t i, const Vec3f& v) {
        x[i] = v.x();
        y[i] = v.y();
        z[i] = v.z();
    }
    [[nodiscard]] Vec3f at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    [[nodiscard]] std::array<std::span<const float>, 3> first(std::size_t count) const {
        return {std::span(x).first(count), std::span(y).first(count), std::span(z).first(count)};
    }
};

struct PhotonLanes {
    // Photons at the surface, about to be reflected: the first `size` lanes.
    std::size_t size = 0;
    Lane<std::uint32_t> photon;  // number in the wave; its parity is the half that it belongs to
    Lane<std::int32_t> active;   // -1; 0: goes no further
    Lane<TexelId> texel;
    Lane3 origin;  // off the surface by Tracer::offset_length() [length]
    Lane3 geometric_normal, normal, w_i;
    Lane<float> diffuse, lobe, concentration;  // as in PhotonTexel
    Lane<float> survival;                      // probability with which it came so far [-]
    Lane<float> choice;  // random number that chooses between the diffuse part and the lobe

    // Where they are reflected to, and what they hit.
    Lane<float> u, v;                     // random numbers
    Lane3 w_o;                            // goes on from the first hit
    Lane<float> cos_i, cos_o, departing;  // of w_i and w_o to the normal, of w_o to the geometric
    Lane<float> chord_squared;            // from the mirror direction of w_i to w_o
    Lane<float> share;                    // probability of the lobe [-]
    Lane<std::uint32_t> hit_triangle;
    Lane<float> hit_u, hit_v;

    // Of photons that were just started, by number; azimuth as long as the wave lasts.
    Lane<std::int32_t> lamp;
    Lane<float> weight;    // power over the lamp's light, see PhotonStart::power()
    Lane<float> azimuth;   // of the lamp, where lamps turn [rad]
    Lane<float> distance;  // to the lamp, where lamps turn [length]
};

}  // namespace patina
