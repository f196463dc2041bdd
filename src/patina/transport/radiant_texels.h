// The maps as sweeps of light over the gather graph read them.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/reflectance/lobe.h"
#include "patina/scene/atlas.h"

#include <span>
#include <vector>

namespace patina {

// The lobe of a texel, as what is met on the way to another sees it.
struct GlossyLobe {
    float minus_half_precision = 0;  // -1 / (2 sigma^2) [1/rad^2]
    float specular = 0;              // Ps / pi [1/sr]
};

class RadiantTexels {
  public:
    // left_out: per texel, the share of the images of lamps in its lobe that reaches others in
    // another way, in [0, 1]; empty: none.
    RadiantTexels(const TexelAtlas& atlas,
                  std::span<const Reflectance> maps,
                  bool with_specular,
                  std::span<const float> left_out = {});

    struct Material {
        Vec3f normal = Vec3f::UnitZ();
        Rgbf diffuse = Rgbf::Zero();  // Pd / pi [1/sr]
        float specular = 0;           // Ps / pi, but for what is left out [1/sr]
        Rgbf onward = Rgbf::Zero();   // (Pd + Ps A) / pi, for light sent to second rays [1/sr]
    };
    [[nodiscard]] const Material& operator[](TexelId texel) const { return materials_[texel]; }
    // -1 / (2 sigma^2) of every texel; 0 where its lobe sends no image of a lamp [1/rad^2]. By
    // itself, as every hit reads it and all of it fits into a cache.
    [[nodiscard]] const LargeVector<float>& minus_half_precision() const { return precision_; }
    // Nothing is left out of these.
    [[nodiscard]] const LargeVector<GlossyLobe>& lobes() const { return lobes_; }

  private:
    std::vector<Material> materials_;
    LargeVector<float> precision_;
    LargeVector<GlossyLobe> lobes_;
};

}  // namespace patina
