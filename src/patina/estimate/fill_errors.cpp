#include "patina/estimate/fill_errors.h"

#include "patina/base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace patina {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Distances of the variogram: 1, 2, 4 ... texels.
constexpr std::size_t kNumLags = 8;
// Pairs whose Pd differs by more than this share say nothing of one material.
constexpr double kLikeDiffuse = 0.2;
constexpr double kFewestPairs = 20;

struct Differences {
    double specular_albedo = 0;  // sums of squares
    double roughness = 0;
    double count = 0;
    Differences& operator+=(const Differences& other) {
        specular_albedo += other.specular_albedo;
        roughness += other.roughness;
        count += other.count;
        return *this;
    }
};

// Variances of the logarithms of a measured texel.
LobeSpread own_variance(const Reflectance& map, const Reflectance& error) {
    const double roughness = square(error.roughness / map.roughness);
    // Errors of Ps and sigma go against each other, so their product is known better than this.
    return {square(error.specular / map.specular), roughness};
}

class Variogram {
  public:
    Variogram(const TexelAtlas& atlas,
              std::span<const Reflectance> maps,
              std::span<const Reflectance> errors,
              std::span<const std::uint8_t> measured)
        : atlas_(atlas), maps_(maps), errors_(errors), measured_(measured) {
        for (std::size_t k = 0; k < kNumLags; ++k) {
            const Differences sums = ordered_reduce(
                maps.size(), Differences(), [&](std::size_t i) { return pairs_of(i, 1 << k); });
            if (sums.count < kFewestPairs) continue;
            lags_.push_back(std::log2(double(1 << k)));
            variances_.push_back({std::max(0.0, sums.specular_albedo / sums.count),
                                  std::max(0.0, sums.roughness / sums.count)});
            if (variances_.size() < 2) continue;
            // What is further away is not known better.
            const LobeSpread& nearer = variances_[variances_.size() - 2];
            LobeSpread& last = variances_.back();
            last.specular_albedo = std::max(last.specular_albedo, nearer.specular_albedo);
            last.roughness = std::max(last.roughness, nearer.roughness);
        }
    }

    // Standard errors at a distance in texels.
    [[nodiscard]] LobeSpread at(double distance) const {
        if (lags_.empty()) return {kInfinity, kInfinity};
        const double lag = std::clamp(std::log2(distance), lags_.front(), lags_.back());
        std::size_t k = 0;
        while (k + 2 < lags_.size() && lags_[k + 1] < lag) ++k;
        const std::size_t next = std::min(k + 1, lags_.size() - 1);
        const double t = next == k ? 0 : (lag - lags_[k]) / (lags_[next] - lags_[k]);
        const auto between = [t](double a, double b) { return std::sqrt(a + t * (b - a)); };
        return {between(variances_[k].specular_albedo, variances_[next].specular_albedo),
                between(variances_[k].roughness, variances_[next].roughness)};
    }

  private:
    [[nodiscard]] Differences pairs_of(std::size_t i, int lag) const {
        Differences sums;
        if (measured_[i] == 0) return sums;
        const Texel& texel = atlas_.texels[i];
        const int right = texel.column + lag;
        const int column = atlas_.wraps_around ? right % atlas_.width : right;
        add_pair(i, column, texel.row, sums);
        add_pair(i, texel.column, texel.row + lag, sums);
        return sums;
    }

    void add_pair(std::size_t i, int column, int row, Differences& sums) const {
        if (column >= atlas_.width || row >= atlas_.height) return;
        const TexelId other =
            atlas_.cell_texel[std::size_t(row) * std::size_t(atlas_.width) + std::size_t(column)];
        if (other == kNoTexel || measured_[other] == 0) return;
        const Reflectance& a = maps_[i];
        const Reflectance& b = maps_[other];
        if (!((a.diffuse - b.diffuse).abs() <= kLikeDiffuse * a.diffuse.max(b.diffuse)).all())
            return;
        const LobeSpread noise_a = own_variance(a, errors_[i]);
        const LobeSpread noise_b = own_variance(b, errors_[other]);
        const double roughness = std::log(a.roughness / b.roughness);
        const double albedo = std::log(a.specular / b.specular) + 2 * roughness;
        sums += {square(albedo) - noise_a.specular_albedo - noise_b.specular_albedo,
                 square(roughness) - noise_a.roughness - noise_b.roughness,
                 1.0};
    }

    const TexelAtlas& atlas_;
    std::span<const Reflectance> maps_;
    std::span<const Reflectance> errors_;
    std::span<const std::uint8_t> measured_;
    std::vector<double> lags_;  // log2 of texels
    std::vector<LobeSpread> variances_;
};

// The nearest measured texel over the surface.
struct Source {
    TexelId texel = kNoTexel;
    int distance = 0;  // in steps from texel to texel
};

std::vector<Source> nearest_measured(const TexelAtlas& atlas,
                                     std::span<const std::uint8_t> measured) {
    std::vector<Source> sources(measured.size());
    std::vector<TexelId> ring;
    for (std::size_t i = 0; i < measured.size(); ++i) {
        if (measured[i] == 0) continue;
        sources[i] = {TexelId(i), 0};
        ring.push_back(TexelId(i));
    }
    while (!ring.empty()) {
        std::vector<TexelId> next;
        for (const TexelId i : ring) {
            for (std::uint32_t k = atlas.neighbor_begin[i]; k < atlas.neighbor_begin[i + 1]; ++k) {
                Source& other = sources[atlas.neighbors[k]];
                if (other.texel != kNoTexel) continue;
                other = {sources[i].texel, sources[i].distance + 1};
                next.push_back(atlas.neighbors[k]);
            }
        }
        ring = std::move(next);
    }
    return sources;
}

}  // namespace

std::vector<LobeSpread> fill_errors(const TexelAtlas& atlas,
                                    std::span<const Reflectance> maps,
                                    std::span<const Reflectance> errors,
                                    std::span<const std::uint8_t> measured) {
    const Variogram variogram(atlas, maps, errors, measured);
    const std::vector<Source> sources = nearest_measured(atlas, measured);
    std::vector<LobeSpread> result(maps.size(), {0, 0});
    for (std::size_t i = 0; i < result.size(); ++i) {
        if (measured[i] != 0) continue;
        const Source& source = sources[i];
        if (source.texel == kNoTexel) {
            result[i] = {kInfinity, kInfinity};
            continue;
        }
        const LobeSpread there = variogram.at(source.distance);
        const LobeSpread own = own_variance(maps[source.texel], errors[source.texel]);
        result[i] = {std::sqrt(square(there.specular_albedo) + own.specular_albedo),
                     std::sqrt(square(there.roughness) + own.roughness)};
    }
    return result;
}

}  // namespace patina
