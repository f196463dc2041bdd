// What photons meet, laid out for them: a record per triangle and two per texel, in single
// precision, so that a bounce touches few cache lines and derives nothing anew.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/transport/surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// Corners and differences along the two edges: value = corner + u edge1 + v edge2.
struct alignas(128) PhotonTriangle {
    Vec3f position, position_edge1, position_edge2;  // [length]
    Vec3f geometric_normal;                          // unit
    Vec2f cell;                                      // position in the atlas [cells], rows down
    Vec2f cell_edge1, cell_edge2;                    // second cache line
    Vec3f normal, normal_edge1, normal_edge2;        // smooth normal before it is made unit
};

// A texel where photons start, and how they are reflected there.
struct alignas(64) PhotonTexel {
    Vec3f origin;  // the centre, moved off the surface by Tracer::offset_length() [length]
    Vec3f geometric_normal, normal;  // unit
    float area = 0;                  // [length^2]
    float azimuth = 0;               // of the column [rad]
    float mean_albedo = 0;           // what the guide reflects at most, mean of all channels [-]
    float diffuse = 0;               // largest channel of Pd [-]
    float lobe = 0;                  // 2 sigma^2 Ps, the lobe's albedo before the horizon cuts it
    float concentration = 0;         // kappa = 1 / sigma^2 of the lobe's sampler [-]
};
static_assert(sizeof(PhotonTexel) == 64);

// What photons that arrive need to know of a texel, apart from it: they arrive anywhere, and four
// of these share a cache line.
struct alignas(16) PhotonReceiver {
    float diffuse = 0, lobe = 0, concentration = 0;  // as in PhotonTexel
    std::uint32_t roughness_row = 0;                 // of the survival table
};

class PhotonScene {
  public:
    // Does not own surface and atlas. guide: per texel, what directions and survival are drawn
    // from.
    PhotonScene(const Surface& surface,
                const TexelAtlas& atlas,
                std::span<const Reflectance> guide);

    [[nodiscard]] const Tracer& tracer() const { return *surface_.tracer; }
    [[nodiscard]] const PhotonTriangle& triangle(std::uint32_t index) const {
        return triangles_[index];
    }
    [[nodiscard]] std::size_t num_texels() const { return texels_.size(); }
    [[nodiscard]] const PhotonTexel& texel(TexelId texel) const { return texels_[texel]; }
    [[nodiscard]] const PhotonReceiver& receiver(TexelId texel) const { return receivers_[texel]; }
    [[nodiscard]] float offset_length() const { return float(tracer().offset_length()); }
    // The cell at a position in the atlas [cells], and the texel that it belongs to.
    [[nodiscard]] std::size_t cell_at(const Vec2f& position) const {
        const int x = std::clamp(int(std::floor(position.x())), 0, atlas_.width - 1);
        const int y = std::clamp(int(std::floor(position.y())), 0, atlas_.height - 1);
        return std::size_t(y) * std::size_t(atlas_.width) + std::size_t(x);
    }
    [[nodiscard]] const TexelId& texel_of_cell(std::size_t cell) const {
        return atlas_.cell_owner[cell];
    }
    // Probability with which a photon that falls in at cos_i > 0 is let live: about the albedo.
    [[nodiscard]] float survival(const PhotonReceiver& receiver, float cos_i) const;

  private:
    void fill_triangles();
    void fill_texels(std::span<const Reflectance> guide);

    Surface surface_;
    const TexelAtlas& atlas_;
    LargeVector<PhotonTriangle> triangles_;
    LargeVector<PhotonTexel> texels_;
    LargeVector<PhotonReceiver> receivers_;
    std::vector<float> albedo_;  // of the lobe over 2 sigma^2; rows: sigma, columns: cos_i
};

}  // namespace patina
