#include "patina/transport/radiant_texels.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

namespace patina {
namespace {

// Lobes with less albedo than this send no image of a lamp worth the sum.
constexpr double kNegligibleLobe = 1e-5;

}  // namespace

RadiantTexels::RadiantTexels(const TexelAtlas& atlas,
                             std::span<const Reflectance> maps,
                             bool with_specular,
                             std::span<const float> left_out)
    : materials_(atlas.texels.size()),
      precision_(atlas.texels.size()),
      lobes_(atlas.texels.size()) {
    PATINA_CHECK_EQ(maps.size(), atlas.texels.size());
    PATINA_CHECK(left_out.empty() || left_out.size() == maps.size());
    // A mean over directions weighted by their cosine is reached near cos_i = 2/3.
    constexpr double kMeanCosine = 2.0 / 3;
    parallel_for(materials_.size(), [&](std::size_t i) {
        const Reflectance& map = maps[i];
        Material& material = materials_[i];
        material.normal = atlas.texels[i].point.normal.cast<float>();
        material.diffuse = (map.diffuse / kPi).cast<float>();
        material.onward = material.diffuse;
        if (!with_specular) return;
        const double albedo = map.specular * lobe_albedo(kMeanCosine, map.roughness);
        material.onward += float(albedo / kPi);
        const auto minus_half_precision = float(-0.5 / square(map.roughness));
        if (albedo >= kNegligibleLobe) {
            lobes_[i] = {minus_half_precision, float(map.specular / kPi)};
        }
        const double kept = left_out.empty() ? 1.0 : 1 - double(left_out[i]);
        if (albedo * kept < kNegligibleLobe) return;
        material.specular = float(kept * map.specular / kPi);
        precision_[i] = minus_half_precision;
    });
}

}  // namespace patina
