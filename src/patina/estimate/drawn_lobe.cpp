#include "patina/estimate/drawn_lobe.h"

#include "patina/base/parallel.h"
#include "patina/estimate/lobe_variogram.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {
namespace {

// Lobes that never differ are still not alike beyond this [-].
constexpr double kLeastSpread = 1e-6;
// Lobes further apart than so many standard deviations lie across a border of materials.
constexpr double kUnlike = 2.0;
constexpr std::size_t kBlock = 256;

bool has_lobe(const TexelFit& fit) {
    return fit.observed && fit.roughness_measured && fit.reflectance.specular > 0;
}

// Of a pair of texels side by side, from the mean squared differences at one texel and at two. What
// they have in common from one texel on is error; where differences grow, texels differ.
double between_neighbors(double at_one, double at_two, double own) {
    return std::max({0.0, at_one - own, std::min(at_one, at_two - at_one)});
}

// As a texel's own looks have it.
struct OwnLobe {
    LogLobe value = LogLobe::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    bool is_known = false;
};

LargeVector<OwnLobe> own_lobes(std::span<const TexelFit> fits) {
    LargeVector<OwnLobe> lobes(fits.size());
    parallel_for(lobes.size(), [&](std::size_t i) {
        if (!has_lobe(fits[i])) return;
        lobes[i].value = log_lobe(fits[i].reflectance);
        lobes[i].covariance = fits[i].lobe_information.cast<double>().inverse();
        lobes[i].is_known = lobes[i].covariance.allFinite();
    });
    return lobes;
}

struct Near {
    TexelId texel = kNoTexel;
    double distance = 0;  // over links [texels], each as long as it is weak
};

// The texels of two rings.
void find_near(const TexelAtlas& atlas,
               std::span<const float> links,
               TexelId texel,
               std::vector<Near>& near) {
    near.clear();
    const auto add = [&](TexelId from, double before) {
        for (std::uint32_t k = atlas.neighbor_begin[from]; k < atlas.neighbor_begin[from + 1];
             ++k) {
            const TexelId to = atlas.neighbors[k];
            if (to == texel) continue;
            const double distance = before + 1 / std::sqrt(double(links[k]));
            const auto known = std::find_if(
                near.begin(), near.end(), [to](const Near& other) { return other.texel == to; });
            if (known == near.end()) {
                near.push_back({to, distance});
            } else {
                known->distance = std::min(known->distance, distance);
            }
        }
    };
    add(texel, 0);
    const std::size_t ring = near.size();
    for (std::size_t k = 0; k < ring; ++k) add(near[k].texel, near[k].distance);
}

// 1, or less for another lobe that differs by more than the errors of both allow. covariance: of
// the other one as an estimate of this.
double likeness(const OwnLobe& lobe, const LogLobe& other, const Eigen::Matrix2d& covariance) {
    const LogLobe difference = other - lobe.value;
    const Eigen::Matrix2d expected = lobe.covariance + covariance;
    return std::min(1.0, square(kUnlike) / difference.dot(expected.inverse() * difference));
}

}  // namespace

LobeSpread neighbor_spread(const TexelAtlas& atlas, std::span<const TexelFit> fits) {
    std::vector<Reflectance> maps(fits.size());
    std::vector<Reflectance> errors(fits.size());
    std::vector<std::uint8_t> measured(fits.size());
    parallel_for(fits.size(), [&](std::size_t i) {
        maps[i] = fits[i].reflectance;
        errors[i].specular = fits[i].specular_error;
        errors[i].roughness = fits[i].roughness_error;
        measured[i] = has_lobe(fits[i]);
    });
    const LobeVariogram variogram(atlas, maps, errors, measured);
    const LobeDifferences one = variogram.at(1);
    const LobeDifferences two = variogram.at(2);
    if (!LobeVariogram::tells(one) || !LobeVariogram::tells(two)) {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        return {kInfinity, kInfinity};
    }
    return {
        std::sqrt(between_neighbors(
            one.whole.specular_albedo, two.whole.specular_albedo, one.own.specular_albedo)),
        std::sqrt(between_neighbors(one.whole.roughness, two.whole.roughness, one.own.roughness))};
}

LargeVector<LobePrior> neighbor_priors(const TexelAtlas& atlas,
                                       std::span<const float> links,
                                       std::span<const TexelFit> fits,
                                       const LobeSpread& between) {
    LargeVector<LobePrior> priors(fits.size());
    if (!std::isfinite(between.specular_albedo) || !std::isfinite(between.roughness)) return priors;
    const LargeVector<OwnLobe> lobes = own_lobes(fits);
    const Eigen::Matrix2d apart = LogLobe(square(std::max(between.specular_albedo, kLeastSpread)),
                                          square(std::max(between.roughness, kLeastSpread)))
                                      .asDiagonal();
    parallel_blocks(priors.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<Near> near;
        for (std::size_t i = begin; i < end; ++i) {
            if (!lobes[i].is_known) continue;
            find_near(atlas, links, TexelId(i), near);
            for (const Near& other : near) {
                const OwnLobe& lobe = lobes[other.texel];
                if (!lobe.is_known) continue;
                const Eigen::Matrix2d covariance = lobe.covariance + square(other.distance) * apart;
                const Eigen::Matrix2d precision =
                    likeness(lobes[i], lobe.value, covariance) * covariance.inverse();
                priors[i].precision += precision;
                priors[i].pull += precision * lobe.value;
            }
        }
    });
    return priors;
}

LogLobe drawn_lobe(const LogLobe& own, const Eigen::Matrix2d& information, const LobePrior& prior) {
    return (information + prior.precision).inverse() * (information * own + prior.pull);
}

}  // namespace patina
