#include "patina/estimate/fill_errors.h"

#include "patina/base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Distances of the variogram: 1, 2, 4 ... texels.
constexpr int kNumLags = 8;

// How far lobes are apart at any distance.
class SpreadOverDistance {
  public:
    explicit SpreadOverDistance(const LobeVariogram& variogram) {
        for (int k = 0; k < kNumLags; ++k) {
            const LobeDifferences differences = variogram.at(1 << k);
            if (!LobeVariogram::tells(differences)) continue;
            lags_.push_back(k);
            const LobeSpread& whole = differences.whole;
            const LobeSpread& own = differences.own;
            variances_.push_back({std::max(0.0, whole.specular_albedo - own.specular_albedo),
                                  std::max(0.0, whole.roughness - own.roughness)});
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
    const SpreadOverDistance spread(LobeVariogram(atlas, maps, errors, measured));
    const std::vector<Source> sources = nearest_measured(atlas, measured);
    std::vector<LobeSpread> result(maps.size(), {0, 0});
    parallel_for(result.size(), [&](std::size_t i) {
        if (measured[i] != 0) return;
        const Source& source = sources[i];
        if (source.texel == kNoTexel) {
            result[i] = {kInfinity, kInfinity};
            return;
        }
        const LobeSpread there = spread.at(source.distance);
        const LobeSpread own = own_variance(maps[source.texel], errors[source.texel]);
        result[i] = {std::sqrt(square(there.specular_albedo) + own.specular_albedo),
                     std::sqrt(square(there.roughness) + own.roughness)};
    });
    return result;
}

}  // namespace patina
