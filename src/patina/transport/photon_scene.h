// What photons meet, laid out for them: a record per triangle and one per texel, in single
// precision, so that a bounce touches few cache lines and derives nothing anew.
#pragma once

#include "patina/transport/surface.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// Corners and differences along the two edges: value = corner + u edge1 + v edge2.
struct alignas(128) PhotonTriangle {
    Vec3f position, position_edge1, position_edge2;  // [length]
    Vec3f geometric_normal;                          // unit
    Vec3f normal, normal_edge1, normal_edge2;        // smooth normal before it is made unit
    Vec2f cell, cell_edge1, cell_edge2;              // position in the atlas [cells], rows down
};

// How photons are reflected at a texel and survive there.
struct GuideTexel {
    float diffuse = 0;                // largest channel of Pd [-]
    float lobe = 0;                   // 2 sigma^2 Ps, the lobe's albedo before the horizon cuts it
    float concentration = 0;          // kappa = 1 / sigma^2 of the lobe's sampler [-]
    std::uint32_t roughness_row = 0;  // of the survival table
};

class PhotonScene {
  public:
    // Does not own what it points to. guide: one per texel of the atlas.
    PhotonScene(const Surface& surface,
                const TexelAtlas& atlas,
                std::span<const Reflectance> guide);

    [[nodiscard]] const Tracer& tracer() const { return *surface_.tracer; }
    [[nodiscard]] const PhotonTriangle& triangle(std::uint32_t index) const {
        return triangles_[index];
    }
    [[nodiscard]] const GuideTexel& guide(TexelId texel) const { return guides_[texel]; }
    // The texel at a position in the atlas [cells].
    [[nodiscard]] TexelId texel_at(const Vec2f& cell) const {
        const int x = std::clamp(int(std::floor(cell.x())), 0, atlas_.width - 1);
        const int y = std::clamp(int(std::floor(cell.y())), 0, atlas_.height - 1);
        return atlas_.cell_owner[std::size_t(y) * std::size_t(atlas_.width) + std::size_t(x)];
    }
    // Probability with which a photon that falls in at cos_i > 0 is let live: about the albedo.
    [[nodiscard]] float survival(const GuideTexel& guide, float cos_i) const;

  private:
    void fill_triangles();
    void fill_guides(std::span<const Reflectance> guide);

    Surface surface_;
    const TexelAtlas& atlas_;
    std::vector<PhotonTriangle> triangles_;
    std::vector<GuideTexel> guides_;
    std::vector<float> albedo_;  // of the lobe over 2 sigma^2; rows: sigma, columns: cos_i
};

}  // namespace patina
