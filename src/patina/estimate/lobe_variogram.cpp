#include "patina/estimate/lobe_variogram.h"

#include "patina/base/parallel.h"

#include <cmath>

namespace patina {
namespace {

// Pairs whose Pd differs by more than this share say nothing of one material.
constexpr double kLikeDiffuse = 0.2;
constexpr double kFewestPairs = 20;

}  // namespace

LobeSpread& LobeSpread::operator+=(const LobeSpread& other) {
    specular_albedo += other.specular_albedo;
    roughness += other.roughness;
    return *this;
}

LobeDifferences& LobeDifferences::operator+=(const LobeDifferences& other) {
    whole += other.whole;
    own += other.own;
    count += other.count;
    return *this;
}

LobeSpread own_variance(const Reflectance& map, const Reflectance& error) {
    return {square(error.specular / map.specular), square(error.roughness / map.roughness)};
}

LobeVariogram::LobeVariogram(const TexelAtlas& atlas,
                             std::span<const Reflectance> maps,
                             std::span<const Reflectance> errors,
                             std::span<const std::uint8_t> measured)
    : atlas_(atlas), maps_(maps), errors_(errors), measured_(measured) {}

LobeDifferences LobeVariogram::at(int lag) const {
    LobeDifferences sums = ordered_reduce(maps_.size(), LobeDifferences(), [&](std::size_t i) {
        LobeDifferences of_texel;
        if (measured_[i] == 0) return of_texel;
        const Texel& texel = atlas_.texels[i];
        const int right = texel.column + lag;
        add_pair(i, atlas_.wraps_around ? right % atlas_.width : right, texel.row, of_texel);
        add_pair(i, texel.column, texel.row + lag, of_texel);
        return of_texel;
    });
    if (!tells(sums)) return sums;
    for (LobeSpread* mean : {&sums.whole, &sums.own}) {
        mean->specular_albedo /= sums.count;
        mean->roughness /= sums.count;
    }
    return sums;
}

bool LobeVariogram::tells(const LobeDifferences& differences) {
    return differences.count >= kFewestPairs;
}

void LobeVariogram::add_pair(std::size_t i, int column, int row, LobeDifferences& sums) const {
    if (column >= atlas_.width || row >= atlas_.height) return;
    const TexelId other =
        atlas_.cell_texel[std::size_t(row) * std::size_t(atlas_.width) + std::size_t(column)];
    if (other == kNoTexel || measured_[other] == 0) return;
    const Reflectance& a = maps_[i];
    const Reflectance& b = maps_[other];
    if (!((a.diffuse - b.diffuse).abs() <= kLikeDiffuse * a.diffuse.max(b.diffuse)).all()) return;
    const double roughness = std::log(a.roughness / b.roughness);
    const double albedo = std::log(a.specular / b.specular) + 2 * roughness;
    sums.whole += {square(albedo), square(roughness)};
    sums.own += own_variance(a, errors_[i]);
    sums.own += own_variance(b, errors_[other]);
    sums.count += 1;
}

}  // namespace patina
