#include "patina/estimate/mean_specular.h"

#include "patina/estimate/ring_sums.h"

namespace patina {
namespace {

constexpr int kLobeRings = 4;

}  // namespace

std::vector<double> mean_over_own_specular(const TexelAtlas& atlas,
                                           std::span<const Reflectance> maps,
                                           std::span<const TexelFit> fits) {
    struct Sum {
        double specular = 0;
        double count = 0;
        Sum& operator+=(const Sum& other) {
            specular += other.specular;
            count += other.count;
            return *this;
        }
    };
    const auto counts = [&](std::size_t i) {
        return fits[i].observed && fits[i].roughness_measured && maps[i].specular > 0;
    };
    LargeVector<Sum> sums(maps.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (counts(i)) sums[i] = {maps[i].specular, 1.0};
    }
    sum_over_rings(atlas, kLobeRings, sums);
    std::vector<double> ratios(maps.size(), 1.0);
    for (std::size_t i = 0; i < ratios.size(); ++i) {
        if (counts(i)) ratios[i] = sums[i].specular / sums[i].count / maps[i].specular;
    }
    return ratios;
}

}  // namespace patina
