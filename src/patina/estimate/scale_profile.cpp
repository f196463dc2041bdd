#include "patina/estimate/scale_profile.h"

#include "patina/base/check.h"
#include "patina/math/bracket.h"
#include "patina/math/types.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>

namespace patina {
namespace {

// First step of the search, and how far from its start it goes either way: from an object of median
// albedo 0.5 to a black one of 0.02, and beyond white [log].
constexpr double kFirstStep = 0.5;
constexpr double kSearchRange = 3.4;
// The search ends when the next point is this close; the local parabola does the rest [log].
constexpr double kSearchTolerance = 0.1;
constexpr int kMaxSearchSteps = 8;
// Arms of the parabola that the minimum and its error are read from. Within them the cost is nearly
// a parabola, and its rise is far above what the trials' tolerance leaves [log].
constexpr double kArm = 0.1;
constexpr int kMaxRounds = 3;
// Trials rest when the maps move by less, relative: a tenth of what they move by between trials of
// the search, and of those on the arms, where a tenth of the light is bounced [-].
constexpr double kSearchTrialTolerance = 2e-2;
constexpr double kTrialTolerance = 1e-3;
// Factors under which more of the texels than this would have to reflect more than they get are out
// of the question.
constexpr double kMaxClampedShare = 0.05;

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

// The lowest point, roughly; nothing if the cost falls up to an end of the range.
std::optional<double> search(ScaleTrials& trials, double start) {
    const auto cost = [&trials](double x) {
        return trials.try_factor(x, kSearchTrialTolerance).total();
    };
    // Downhill until the cost rises again.
    double x = start + kFirstStep;
    Bracket bracket{start - kFirstStep, start, x, 0, cost(start), cost(x)};
    const bool up = bracket.cost_high < bracket.cost_middle;
    if (up) {
        bracket.cost_low = bracket.cost_middle;
    } else {
        bracket.cost_low = cost(bracket.low);
    }
    while (bracket.cost_middle > std::min(bracket.cost_low, bracket.cost_high)) {
        x = up ? bracket.high + kFirstStep : bracket.low - kFirstStep;
        if (std::abs(x - start) > kSearchRange) return std::nullopt;
        bracket = up ? Bracket{bracket.middle,
                               bracket.high,
                               x,
                               bracket.cost_middle,
                               bracket.cost_high,
                               cost(x)}
                     : Bracket{x,
                               bracket.low,
                               bracket.middle,
                               cost(x),
                               bracket.cost_low,
                               bracket.cost_middle};
    }
    for (int i = 0; i < kMaxSearchSteps; ++i) {
        x = bracket.next();
        if (std::abs(x - bracket.middle) < kSearchTolerance) return x;
        bracket.insert(x, cost(x));
    }
    return bracket.middle;
}

// The parabola through three trials about x, and its vertex.
struct Vertex {
    double offset = 0;          // of the vertex from x [log]
    double standard_error = 0;  // of the vertex [log]
    bool exists = false;
    double clamped_share = 0;
};

Vertex vertex_at(ScaleTrials& trials, double x, std::size_t num_lamp_sets) {
    const ScaleTrial middle = trials.try_factor(x, kTrialTolerance);
    const ScaleTrial low = trials.try_factor(x - kArm, kTrialTolerance);
    const ScaleTrial high = trials.try_factor(x + kArm, kTrialTolerance);
    const std::size_t num_cells = middle.costs.size();
    std::vector<double> slopes(num_cells);
    std::vector<double> bends(num_cells);
    for (std::size_t i = 0; i < num_cells; ++i) {
        slopes[i] = (high.costs[i] - low.costs[i]) / (2 * kArm);
        bends[i] = (high.costs[i] - 2 * middle.costs[i] + low.costs[i]) / square(kArm);
    }
    const double slope = std::accumulate(slopes.begin(), slopes.end(), 0.0);
    const double bend = std::accumulate(bends.begin(), bends.end(), 0.0);
    Vertex vertex;
    vertex.exists = bend > 0;
    vertex.clamped_share = middle.clamped_share;
    if (!vertex.exists) return vertex;
    vertex.offset = -slope / bend;
    for (std::size_t i = 0; i < num_cells; ++i) slopes[i] += vertex.offset * bends[i];
    vertex.standard_error = clustered_deviation(slopes, num_lamp_sets) / bend;
    return vertex;
}

}  // namespace

double ScaleTrial::total() const { return std::accumulate(costs.begin(), costs.end(), 0.0); }

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

std::string untold_note(const ScaleEstimate& scale) {
    return "note: the absolute scale is not told: " + scale.reason +
           "; the lamps are taken as stated, and Pd and Ps are known up to a common factor";
}

ScaleEstimate find_scale(ScaleTrials& trials, double start, std::size_t num_lamp_sets) {
    ScaleEstimate estimate;
    estimate.reason = "no factor of the lamps fits best";
    trials.settle(start);
    const std::optional<double> found = search(trials, start);
    if (!found) return estimate;
    double x = *found;
    Vertex vertex;
    bool rests = false;
    for (int round = 0; round < kMaxRounds && !rests; ++round) {
        trials.settle(x);
        vertex = vertex_at(trials, x, num_lamp_sets);
        if (!vertex.exists) return estimate;
        x += std::clamp(vertex.offset, -2 * kArm, 2 * kArm);
        rests = std::abs(vertex.offset) <= kArm / 2;
        if (!(vertex.standard_error <= kLargestScaleError)) break;
    }
    estimate.best_factor = std::exp(x);
    estimate.standard_error = vertex.standard_error;
    const std::string best =
        fmt::format("the factor that fits best, {:.3g},", estimate.best_factor);
    if (!(vertex.standard_error <= kLargestScaleError)) {
        estimate.reason =
            fmt::format("{} has a standard error of {:.0f} % (expected {:.0f} % or less)",
                        best,
                        100 * vertex.standard_error,
                        100 * kLargestScaleError);
    } else if (vertex.clamped_share > kMaxClampedShare) {
        estimate.reason =
            fmt::format("under {} {:.0f} % of the texels would reflect more light than they get",
                        best,
                        100 * vertex.clamped_share);
    } else if (!rests) {
        estimate.reason = best + " changes with the weights of the looks that it decides";
    } else {
        estimate.told = true;
        estimate.factor = estimate.best_factor;
        estimate.reason.clear();
    }
    return estimate;
}

}  // namespace patina
