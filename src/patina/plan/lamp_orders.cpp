#include "patina/plan/lamp_orders.h"

#include "patina/base/random.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <utility>

namespace patina {
namespace {

// A candidate with the gain that it had when `num_taken` were taken: a bound on what it has now.
struct Bound {
    double gain = 0;
    std::size_t candidate = 0;
    std::size_t num_taken = 0;

    // The best one is on top of the heap, ties to the lower position.
    bool operator<(const Bound& other) const {
        return gain != other.gain ? gain < other.gain : candidate > other.candidate;
    }
};

std::vector<Vec3> places_of(std::span<const Light> lamps, const Vec3& center) {
    const bool are_points = std::all_of(lamps.begin(), lamps.end(), [](const Light& lamp) {
        return lamp.type == LightType::point;
    });
    std::vector<Vec3> places;
    for (const Light& lamp : lamps) {
        places.push_back(are_points ? lamp.position : direction_to(lamp, center));
    }
    return places;
}

}  // namespace

GreedyPicks choose_by_information(Knowledge known,
                                  std::span<const LookGradients> candidates,
                                  const GreedyOptions& options) {
    GreedyPicks result;
    std::priority_queue<Bound> bounds;
    for (std::size_t i = 0; i < candidates.size(); ++i) bounds.push({known.gain(candidates[i]), i});
    result.num_evaluations = candidates.size();
    while (!bounds.empty()) {
        Bound best = bounds.top();
        bounds.pop();
        if (best.num_taken < result.picks.size()) {
            best.gain = known.gain(candidates[best.candidate]);
            best.num_taken = result.picks.size();
            ++result.num_evaluations;
            bounds.push(best);
            continue;
        }
        const bool is_small =
            best.gain < options.min_gain && result.picks.size() >= options.min_picks;
        if (result.picks.size() == options.max_picks || best.gain <= 0 || is_small) {
            result.next = best.candidate;
            break;
        }
        known.add(candidates[best.candidate]);
        result.picks.push_back(best.candidate);
        result.gains.push_back(best.gain);
    }
    return result;
}

std::vector<std::size_t> uniform_order(std::span<const Light> lamps, const Vec3& center) {
    const std::vector<Vec3> places = places_of(lamps, center);
    Vec3 middle = Vec3::Zero();
    for (const Vec3& place : places) middle += place / double(places.size());
    // Squared distance to the nearest lamp taken; before the first, closeness to the middle.
    std::vector<double> distances;
    for (const Vec3& place : places) distances.push_back(-(place - middle).squaredNorm());
    std::vector<std::size_t> order;
    while (order.size() < places.size()) {
        const auto best = std::max_element(distances.begin(), distances.end());
        const auto pick = std::size_t(best - distances.begin());
        for (std::size_t i = 0; i < places.size(); ++i) {
            const double distance = (places[i] - places[pick]).squaredNorm();
            distances[i] = order.empty() ? distance : std::min(distances[i], distance);
        }
        order.push_back(pick);
        for (const std::size_t taken : order) distances[taken] = -1;
    }
    return order;
}

std::vector<std::size_t> random_order(std::size_t count, std::uint64_t seed, std::uint64_t draw) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t(0));
    Rng rng(seed, Pass::plan_draws, draw);
    for (std::size_t i = 0; i + 1 < count; ++i) {
        const auto other = i + std::size_t(rng.uniform() * double(count - i));
        std::swap(order[i], order[other]);
    }
    return order;
}

}  // namespace patina
