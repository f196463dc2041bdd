#include "patina/estimate/profile.h"

#include "patina/base/check.h"
#include "patina/math/types.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace patina {
namespace {

// Trials on the arms of a parabola rest when the maps move by less, relative: a tenth of what they
// move by between them, where a tenth of the light is bounced [-].
constexpr double kTrialTolerance = 1e-3;

struct OneWay {
    double variance = 0;   // squared sums of the clusters' scores, corrected for few clusters
    int num_clusters = 0;  // that have scores other than 0
};

// cluster: of each score, below num_clusters.
template <typename Cluster>
OneWay one_way(const std::vector<double>& scores,
               std::size_t num_clusters,
               const Cluster& cluster) {
    std::vector<double> sums(num_clusters, 0.0);
    std::vector<std::uint8_t> speaks(num_clusters, 0);
    for (std::size_t i = 0; i < scores.size(); ++i) {
        sums[cluster(i)] += scores[i];
        if (scores[i] != 0) speaks[cluster(i)] = 1;
    }
    OneWay result;
    for (std::size_t k = 0; k < num_clusters; ++k) {
        result.variance += square(sums[k]);
        result.num_clusters += speaks[k];
    }
    const double count = result.num_clusters;
    if (count > 1) result.variance *= count / (count - 1);
    return result;
}

}  // namespace

double ProfileTrial::total() const { return std::accumulate(costs.begin(), costs.end(), 0.0); }

Vertex vertex_at(ProfileTrials& trials, double x, double arm, std::size_t num_lamp_sets) {
    const ProfileTrial middle = trials.try_at(x, kTrialTolerance);
    const ProfileTrial low = trials.try_at(x - arm, kTrialTolerance);
    const ProfileTrial high = trials.try_at(x + arm, kTrialTolerance);
    const std::size_t num_cells = middle.costs.size();
    std::vector<double> slopes(num_cells);
    std::vector<double> bends(num_cells);
    for (std::size_t i = 0; i < num_cells; ++i) {
        slopes[i] = (high.costs[i] - low.costs[i]) / (2 * arm);
        bends[i] = (high.costs[i] - 2 * middle.costs[i] + low.costs[i]) / square(arm);
    }
    const double slope = std::accumulate(slopes.begin(), slopes.end(), 0.0);
    const double bend = std::accumulate(bends.begin(), bends.end(), 0.0);
    Vertex vertex;
    vertex.exists = bend > 0;
    vertex.clamped_share = middle.clamped_share;
    if (!vertex.exists) return vertex;
    vertex.offset = -slope / bend;
    for (std::size_t i = 0; i < num_cells; ++i) slopes[i] += vertex.offset * bends[i];
    // Noise alone leaves as much: the costs are chi-squares, which one deviation raises by 1. Where
    // hardly anything depends on x, clusters may agree by chance on what rounding makes of it.
    const double by_noise = std::sqrt(2 / bend);
    vertex.standard_error = std::max(by_noise, clustered_deviation(slopes, num_lamp_sets) / bend);
    return vertex;
}

double clustered_deviation(const std::vector<double>& scores, std::size_t num_lamp_sets) {
    PATINA_CHECK_EQ(scores.size() % num_lamp_sets, 0u);
    const OneWay blocks = one_way(
        scores, scores.size() / num_lamp_sets, [&](std::size_t i) { return i / num_lamp_sets; });
    const OneWay sets =
        one_way(scores, num_lamp_sets, [&](std::size_t i) { return i % num_lamp_sets; });
    const OneWay cells = one_way(scores, scores.size(), [](std::size_t i) { return i; });
    // A single block has nothing to compare it with.
    if (blocks.num_clusters < 2) return std::numeric_limits<double>::infinity();
    const double both = blocks.variance + sets.variance - cells.variance;
    return std::sqrt(std::max({blocks.variance, sets.variance, both}));
}

}  // namespace patina
