#include "patina/estimate/scale_profile.h"

#include "patina/math/bracket.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
// Trials of the search rest when the maps move by less, relative: a tenth of what they move by
// between them, where a tenth of the light is bounced [-].
constexpr double kSearchTrialTolerance = 2e-2;
// Factors under which more of the texels than this would have to reflect more than they get are out
// of the question.
constexpr double kMaxClampedShare = 0.05;

// The lowest point, roughly; nothing if the cost falls up to an end of the range.
std::optional<double> search(ProfileTrials& trials, double start) {
    const auto cost = [&trials](double x) {
        return trials.try_at(x, kSearchTrialTolerance).total();
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

}  // namespace

std::string untold_note(const ScaleEstimate& scale) {
    return "note: the absolute scale is not told: " + scale.reason +
           "; the lamps are taken as stated, and Pd and Ps are known up to a common factor";
}

ScaleEstimate find_scale(ProfileTrials& trials, double start, std::size_t num_lamp_sets) {
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
        vertex = vertex_at(trials, x, kArm, num_lamp_sets);
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
