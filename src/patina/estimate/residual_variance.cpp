#include "patina/estimate/residual_variance.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/estimate/ring_sums.h"
#include "patina/math/statistics.h"

#include <utility>

namespace patina {
namespace {

// Moments are taken over so many rings of neighbours, and count against those of the whole surface
// as so many degrees of freedom, or texels.
constexpr int kRings = 2;
constexpr double kPriorFreedom = 10.0;
constexpr double kPriorTexels = 10.0;

// What residuals did to each parameter against what they should have done; both over the variance
// that is supposed.
struct Influence {
    Parameters found = Parameters::Zero();
    Parameters expected = Parameters::Zero();

    Influence& operator+=(const Influence& other) {
        found += other.found;
        expected += other.expected;
        return *this;
    }
};

// The median over the surface, as moments with so many degrees of freedom.
ResidualMoments typical_moments(std::span<const ResidualMoments> moments) {
    std::vector<double> own;
    std::vector<double> shared;
    for (const ResidualMoments& texel : moments) {
        if (texel.freedom <= 0) continue;
        own.push_back(texel.own_variance());
        shared.push_back(texel.shared_variance());
    }
    ResidualMoments typical{kPriorFreedom, 0, kPriorFreedom};
    if (own.empty()) return typical;
    const double typical_shared = median(std::move(shared));
    typical.own = kPriorFreedom * (median(std::move(own)) + typical_shared);
    typical.shared = 2 * kPriorFreedom * typical_shared;
    return typical;
}

Influence influence_of(const ResidualEvidence& evidence,
                       const ResidualMoments& moments,
                       const Parameters& supposed) {
    Influence influence;
    const Parameters expected = moments.own_variance() * evidence.influence.by_own +
                                moments.shared_variance() * evidence.influence.by_shared;
    for (int k = 0; k < kNumParameters; ++k) {
        if (!(supposed[k] > 0) || !(expected[k] > 0)) continue;
        influence.found[k] = evidence.influence.found[k] / supposed[k];
        influence.expected[k] = expected[k] / supposed[k];
    }
    return influence;
}

// Per parameter, the median over the surface of found over expected; 1 where nothing is known.
Parameters typical_factor(std::span<const Influence> influences) {
    Parameters typical = Parameters::Ones();
    for (int k = 0; k < kNumParameters; ++k) {
        std::vector<double> ratios;
        for (const Influence& influence : influences) {
            if (influence.expected[k] > 0) {
                ratios.push_back(influence.found[k] / influence.expected[k]);
            }
        }
        if (!ratios.empty()) typical[k] = median(std::move(ratios));
    }
    return typical;
}

}  // namespace

ResidualEvidence residual_evidence(const ErrorPropagation& propagation) {
    return {propagation.moments(),
            propagation.influence(),
            propagation.own_variance(),
            propagation.shared_variance()};
}

ResidualVariance residual_variance(const TexelAtlas& atlas,
                                   std::span<const ResidualEvidence> evidence) {
    PATINA_CHECK_EQ(evidence.size(), atlas.texels.size());
    LargeVector<ResidualMoments> moments(evidence.size());
    for (std::size_t i = 0; i < moments.size(); ++i) {
        if (evidence[i].moments.freedom > 0) moments[i] = evidence[i].moments;
    }
    sum_over_rings(atlas, kRings, moments);
    const ResidualMoments typical = typical_moments(moments);
    ResidualVariance result;
    result.own = typical.own_variance();
    result.shared = typical.shared_variance();
    result.variance.resize(evidence.size());
    LargeVector<Influence> influences(evidence.size());
    parallel_for(evidence.size(), [&](std::size_t i) {
        moments[i] += typical;
        Parameters& supposed = result.variance[i];
        supposed = moments[i].own_variance() * evidence[i].own +
                   moments[i].shared_variance() * evidence[i].shared;
        influences[i] = influence_of(evidence[i], moments[i], supposed);
    });
    sum_over_rings(atlas, kRings, influences);
    const Parameters factor = typical_factor(influences);
    parallel_for(evidence.size(), [&](std::size_t i) {
        const Influence& around = influences[i];
        result.variance[i].array() *= (around.found + kPriorTexels * factor).array() /
                                      (around.expected.array() + kPriorTexels);
    });
    return result;
}

}  // namespace patina
