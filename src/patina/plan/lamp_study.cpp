#include "patina/plan/lamp_study.h"

#include "patina/base/check.h"
#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/estimate/observations.h"
#include "patina/math/statistics.h"
#include "patina/plan/lamp_orders.h"
#include "patina/plan/planned_looks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace patina {
namespace {

// Curves go at least so far.
constexpr std::size_t kCurveLamps = 20;
// The bright end of the radiances, as an estimate takes it where no noise is stated.
constexpr double kBrightEnd = 0.99;
// A gain is the fall of the logarithm of the determinant of three variances: twice the fall of the
// logarithms of three standard errors.
constexpr double kGainPerError = 6;

double drop_of(double gain) { return 1 - std::exp(-gain / kGainPerError); }
double gain_of(double drop) { return -kGainPerError * std::log(1 - drop); }

template <typename Value>
std::vector<Value> values_of(const std::vector<Value>& values,
                             const std::vector<std::size_t>& positions) {
    std::vector<Value> picked;
    for (const std::size_t position : positions) picked.push_back(values[position]);
    return picked;
}

std::vector<std::size_t> shortened(std::vector<std::size_t> order, std::size_t size) {
    order.resize(std::min(order.size(), size));
    return order;
}

double median_exposure(const CaptureDescription& description) {
    std::vector<double> exposures;
    for (const Shot& shot : description.shots) {
        if (!shot.heldout) exposures.push_back(shot.exposure);
    }
    return exposures.empty() ? 1 : median(std::move(exposures));
}

SupposedSurface supposed_surface(const StudyOptions& options, const PlanTexels& texels) {
    const SurfacePrior prior{
        options.prior_diffuse, options.prior_specular_albedo, options.cover.roughness};
    if (options.maps.empty()) return SupposedSurface(prior);
    return {prior, values_at(texels.ids, options.maps)};
}

// The noise that the capture states, at its median exposure; else that of the estimate's default.
LookNoise look_noise(const CaptureDescription& description,
                     const SupposedSurface& surface,
                     const std::vector<LookTable>& looks) {
    const ObservationOptions defaults;
    const Radiometry& radiometry = description.radiometry;
    const double exposure = median_exposure(description);
    LookNoise noise;
    noise.calibration_stddev = defaults.calibration_stddev;
    if (radiometry.has_noise) {
        noise.read_variance = square(radiometry.noise_read / exposure);
        noise.gain = radiometry.noise_gain / exposure;
    } else {
        noise.read_variance =
            square(defaults.default_read_stddev * radiance_quantile(surface, looks, kBrightEnd));
    }
    return noise;
}

// Makes the choice and compares it.
class Study {
  public:
    Study(const PlannedLooks& looks, const Capture& capture, const StudyOptions& options)
        : looks_(looks),
          capture_(capture),
          options_(options),
          surface_(supposed_surface(options, looks.texels)),
          noise_(look_noise(capture.description, surface_, looks.candidates)),
          known_(surface_, looks.texels.ids.size()) {
        const auto gradients = [this](const LookTable& table) {
            return look_gradients(table, surface_, noise_);
        };
        known_.add(gradients(looks.taken));
        for (const LookTable& table : looks.candidates) lamps_.push_back(gradients(table));
        for (const LookTable& table : looks.new_cameras) cameras_.push_back(gradients(table));
    }

    LampStudy run() {
        LampStudy study;
        study.num_texels = looks_.texels.ids.size();
        study.read_stddev = std::sqrt(noise_.read_variance);
        study.errors_before = known_.errors();
        study.next = rank_next();
        const GreedyPicks greedy = choose_by_information(known_, lamps_, limits());
        Order chosen = choose(greedy, study.plan);
        Knowledge known = known_;
        for (const std::size_t pick : chosen) {
            study.drops.push_back(drop_of(known.gain(lamps_[pick])));
            known.add(lamps_[pick]);
        }
        study.errors = known.errors();
        Order all(candidates().size());
        std::iota(all.begin(), all.end(), std::size_t(0));
        study.worth_with_all = worth_of(all).back();
        study.worth = worth_of(chosen);
        study.curves = curves(greedy.picks, std::max(kCurveLamps, chosen.size()));
        return study;
    }

  private:
    using Order = std::vector<std::size_t>;  // positions among the candidates

    [[nodiscard]] const std::vector<std::size_t>& candidates() const {
        return looks_.measurability.candidates;
    }

    [[nodiscard]] std::vector<std::size_t> lights_at(const Order& order) const {
        return values_of(candidates(), order);
    }

    [[nodiscard]] Order positions_of(const std::vector<std::size_t>& lights) const {
        Order order;
        for (const std::size_t light : lights) {
            const auto found = std::lower_bound(candidates().begin(), candidates().end(), light);
            order.push_back(std::size_t(found - candidates().begin()));
        }
        return order;
    }

    // Far enough for the choice and the curves.
    [[nodiscard]] GreedyOptions limits() const {
        GreedyOptions limits;
        if (options_.max_lamps > 0) {
            limits.max_picks = std::max(kCurveLamps, std::size_t(options_.max_lamps) + 1);
        } else {
            limits.min_gain = gain_of(options_.min_drop);
            limits.min_picks = kCurveLamps;
        }
        return limits;
    }

    // The cover's order with nothing to stop it but the lack of gain.
    [[nodiscard]] LightPlan paper_plan(std::size_t max_lamps) const {
        CoverOptions cover = options_.cover;
        cover.min_gain = 0;
        cover.enough = 1;
        cover.max_lamps = max_lamps;
        return choose_lights(looks_.measurability, cover);
    }

    // Fills the plan.
    Order choose(const GreedyPicks& greedy, LightPlan& plan) const {
        const auto max_lamps = std::size_t(options_.max_lamps);
        if (options_.rule == PlanRule::paper) {
            plan = max_lamps > 0 ? paper_plan(max_lamps)
                                 : choose_lights(looks_.measurability, options_.cover);
            return positions_of(plan.chosen);
        }
        std::size_t count = std::min(max_lamps, greedy.picks.size());
        if (max_lamps == 0) {
            const auto small = std::find_if(
                greedy.gains.begin(), greedy.gains.end(), [min_gain = limits().min_gain](double g) {
                    return g < min_gain;
                });
            count = std::size_t(small - greedy.gains.begin());
        }
        Order order(greedy.picks.begin(), greedy.picks.begin() + std::ptrdiff_t(count));
        plan = describe_choice(looks_.measurability, options_.cover, lights_at(order));
        plan.stop = max_lamps > 0 ? CoverStop::max_lamps : CoverStop::small_gain;
        const std::optional<std::size_t> next =
            count < greedy.picks.size() ? greedy.picks[count] : greedy.next;
        if (!next) {
            plan.stop = CoverStop::no_candidates;
            return order;
        }
        Order more = order;
        more.push_back(*next);
        plan.next =
            NextLamp{candidates()[*next],
                     shares_of(looks_.measurability, options_.cover, lights_at(more)).back()};
        return order;
    }

    [[nodiscard]] std::vector<PlanWorth> worth_of(const Order& order) const {
        const std::vector<MeasurableShare> shares =
            shares_of(looks_.measurability, options_.cover, lights_at(order));
        Knowledge known = known_;
        std::vector<PlanWorth> worth = {{known.share_known(), shares[0]}};
        for (std::size_t i = 0; i < order.size(); ++i) {
            known.add(lamps_[order[i]]);
            worth.push_back({known.share_known(), shares[i + 1]});
        }
        return worth;
    }

    [[nodiscard]] std::vector<PlanWorth> median_of_draws(std::size_t size) const {
        std::vector<std::vector<PlanWorth>> draws(std::size_t(options_.num_draws));
        parallel_for(
            draws.size(),
            [&](std::size_t draw) {
                const Order order = random_order(candidates().size(), options_.seed, draw);
                draws[draw] = worth_of(shortened(order, size));
            },
            1);
        std::vector<PlanWorth> middle(draws.front().size());
        for (std::size_t n = 0; n < middle.size(); ++n) {
            const auto median_of = [&](const auto& value) {
                std::vector<double> values;
                for (const auto& draw : draws) values.push_back(value(draw[n]));
                return median(std::move(values));
            };
            middle[n].known = median_of([](const PlanWorth& w) { return w.known; });
            middle[n].share = {median_of([](const PlanWorth& w) { return w.share.diffuse; }),
                               median_of([](const PlanWorth& w) { return w.share.specular; })};
        }
        return middle;
    }

    [[nodiscard]] std::vector<RuleCurve> curves(const Order& greedy, std::size_t size) const {
        const std::vector<Light> lamps = values_of(capture_.description.lights, candidates());
        const Order uniform = uniform_order(lamps, bounds_of(capture_.mesh).center());
        const Order paper = positions_of(paper_plan(size).chosen);
        return {{"d-optimal", worth_of(shortened(greedy, size))},
                {"paper", worth_of(paper)},
                {"uniform", worth_of(shortened(uniform, size))},
                {"random", median_of_draws(size)}};
    }

    [[nodiscard]] std::vector<NextLook> rank_next() const {
        std::vector<NextLook> next;
        if (options_.num_next == 0) return next;
        const auto consider = [&](bool is_camera, std::size_t index, const LookGradients& looks) {
            next.push_back({is_camera, index, known_.gain(looks), {}, 0});
        };
        for (std::size_t i = 0; i < candidates().size(); ++i) {
            consider(false, candidates()[i], lamps_[i]);
        }
        for (std::size_t i = 0; i < cameras_.size(); ++i) {
            consider(true, i, cameras_[i]);
        }
        std::stable_sort(next.begin(), next.end(), [](const NextLook& a, const NextLook& b) {
            return a.gain > b.gain;
        });
        next.resize(std::min(next.size(), std::size_t(options_.num_next)));
        for (NextLook& look : next) {
            Knowledge known = known_;
            known.add(look.is_camera ? cameras_[look.index]
                                     : lamps_[positions_of({look.index}).front()]);
            look.errors = known.errors();
            look.known = known.share_known();
        }
        return next;
    }

    const PlannedLooks& looks_;
    const Capture& capture_;
    const StudyOptions& options_;
    SupposedSurface surface_;
    LookNoise noise_;
    Knowledge known_;                     // before any choice
    std::vector<LookGradients> lamps_;    // of the candidates
    std::vector<LookGradients> cameras_;  // of the new ones
};

}  // namespace

void validate(const StudyOptions& options, std::size_t num_lights) {
    validate(options.cover, num_lights);
    const auto require = [](bool is_right, const char* option, const char* expected) {
        if (!is_right) throw Error(option, "", "is out of range", expected);
    };
    require(options.prior_diffuse > 0, "--prior-diffuse", "above 0");
    require(options.prior_specular_albedo > 0, "--prior-specular-albedo", "above 0");
    require(options.max_lamps >= 0, "--lamps", "0 or more");
    require(options.min_drop >= 0 && options.min_drop < 1, "--min-drop", "in [0, 1)");
    require(options.max_texels >= 0, "--plan-texels", "0 or more");
    require(options.num_draws >= 1, "--draws", "1 or more");
    require(options.num_next >= 0, "--next-looks", "0 or more");
}

LampStudy study_lamps(const Capture& capture,
                      const std::vector<Camera>& new_cameras,
                      const StudyOptions& options,
                      Progress& progress) {
    validate(options, capture.description.lights.size());
    PATINA_CHECK(options.maps.empty() || options.maps.size() == capture.atlas.texels.size());
    PlannedLooksOptions looks;
    looks.cover = options.cover;
    looks.shots_are_taken = options.shots_are_taken;
    looks.max_texels = std::size_t(options.max_texels);
    looks.seed = options.seed;
    const RigView rig(capture, progress);
    const PlannedLooks planned = collect_planned_looks(rig, new_cameras, looks, progress);
    progress.begin_stage("choosing lamps");
    LampStudy study = Study(planned, capture, options).run();
    progress.end_stage(
        fmt::format("{} lamps chosen over {} texels", study.plan.chosen.size(), study.num_texels));
    return study;
}

}  // namespace patina
