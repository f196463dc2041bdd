#include "patina/plan/greedy_cover.h"

#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/reflectance/lobe.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

namespace patina {
namespace {

constexpr int kMaxNeed = 255;

void require(bool condition,
             const std::string& option,
             const std::string& problem,
             const std::string& expected) {
    if (!condition) throw Error(option, "", problem, expected);
}

// What one look at one texel shows; bits. theta_r: between the mirror direction and the view.
std::uint8_t look_shows(const CoverOptions& options,
                        const LookLimits& limits,
                        const Vec3& normal,
                        const DirectLight& direct,
                        const TexelView& view) {
    if (!is_usable(direct, view, limits)) return 0;
    const double theta_r =
        std::sqrt(mirror_angle_squared(normal, direct.w_i.cast<double>(), view.w_v.cast<double>()));
    if (theta_r < options.specular_reach * options.roughness) return kShowsSpecular;
    return theta_r > options.diffuse_reach * options.roughness ? kShowsDiffuse : 0;
}

// What one lamp shows of each texel through any of the cameras; bits.
std::vector<std::uint8_t> lamp_shows(const RigView& rig,
                                     const Light& light,
                                     const LargeVector<DirectLight>& direct,
                                     const CoverOptions& options) {
    const std::span<const Texel> texels = rig.capture().atlas.texels;
    const std::vector<Camera>& cameras = rig.capture().description.cameras;
    const LookLimits limits = options.limits();
    std::vector<std::uint8_t> shows(texels.size(), 0);
    for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
        if (!may_go_together(cameras[camera], light)) continue;
        parallel_for(texels.size(), [&](std::size_t i) {
            shows[i] |= look_shows(
                options, limits, texels[i].point.normal, direct[i], rig.views(camera)[i]);
        });
    }
    return shows;
}

// Counts how many of the lamps added so far show each texel, up to the number needed.
class Cover {
  public:
    // components: the bits that count.
    Cover(const Measurability& measurability, const CoverOptions& options, std::uint8_t components)
        : measurability_(&measurability) {
        if ((components & kShowsDiffuse) != 0)
            parts_.push_back({kShowsDiffuse, options.diffuse_need});
        if ((components & kShowsSpecular) != 0) {
            parts_.push_back({kShowsSpecular, options.specular_need});
        }
        for (Part& part : parts_) part.counts.assign(num_texels(), 0);
    }

    void add(std::size_t light) {
        const std::vector<std::uint8_t>& shows = measurability_->shows[light];
        for (Part& part : parts_) {
            for (std::size_t i = 0; i < shows.size(); ++i) {
                if ((shows[i] & part.bit) == 0 || part.counts[i] >= part.need) continue;
                ++part.counts[i];
                ++part.sum;
                if (part.counts[i] == part.need) ++part.num_measurable;
            }
        }
    }

    [[nodiscard]] std::uint64_t gain(std::size_t light) const {
        const std::vector<std::uint8_t>& shows = measurability_->shows[light];
        std::uint64_t gain = 0;
        for (const Part& part : parts_) {
            for (std::size_t i = 0; i < shows.size(); ++i) {
                gain += std::uint64_t((shows[i] & part.bit) != 0 && part.counts[i] < part.need);
            }
        }
        return gain;
    }

    [[nodiscard]] std::uint64_t sum() const {
        std::uint64_t sum = 0;
        for (const Part& part : parts_) sum += part.sum;
        return sum;
    }

    [[nodiscard]] MeasurableShare share() const {
        MeasurableShare share;
        for (const Part& part : parts_) {
            const double value = double(part.num_measurable) / double(measurability_->num_seen);
            (part.bit == kShowsDiffuse ? share.diffuse : share.specular) = value;
        }
        return share;
    }

    // Whether every component is measurable at `enough` of the texels at which `all` makes it so.
    [[nodiscard]] bool reaches(double enough, const Cover& all) const {
        for (std::size_t k = 0; k < parts_.size(); ++k) {
            if (double(parts_[k].num_measurable) < enough * double(all.parts_[k].num_measurable)) {
                return false;
            }
        }
        return true;
    }

  private:
    struct Part {
        std::uint8_t bit = 0;
        int need = 1;
        std::vector<std::uint8_t> counts = {};  // per texel, at most need
        std::uint64_t sum = 0;                  // of counts
        std::size_t num_measurable = 0;         // texels with counts == need
    };

    [[nodiscard]] std::size_t num_texels() const {
        std::size_t count = 0;
        for (const auto& shows : measurability_->shows) count = std::max(count, shows.size());
        return count;
    }

    const Measurability* measurability_;
    std::vector<Part> parts_;
};

struct Pick {
    std::size_t light = 0;
    std::uint64_t gain = 0;
};

// The candidates that are left. A gain never grows as lamps are taken, so the last one found of a
// lamp bounds what it is now, and only lamps whose bound is the largest need another look.
class LazyGains {
  public:
    LazyGains(const Cover& cover, std::vector<std::size_t> candidates)
        : candidates_(std::move(candidates)),
          bounds_(candidates_.size()),
          is_fresh_(candidates_.size(), 1) {
        parallel_for(
            candidates_.size(), [&](std::size_t k) { bounds_[k] = cover.gain(candidates_[k]); }, 1);
    }

    [[nodiscard]] bool empty() const { return candidates_.empty(); }

    // The candidate with the largest gain, ties to the lower index.
    [[nodiscard]] Pick best(const Cover& cover) {
        for (;;) {
            const auto top = std::max_element(bounds_.begin(), bounds_.end());
            const auto k = std::size_t(top - bounds_.begin());
            if (is_fresh_[k] != 0) return {candidates_[k], *top};
            *top = cover.gain(candidates_[k]);
            is_fresh_[k] = 1;
        }
    }

    // After the light was added to the cover.
    void take(std::size_t light) {
        const auto found = std::find(candidates_.begin(), candidates_.end(), light);
        bounds_.erase(bounds_.begin() + (found - candidates_.begin()));
        candidates_.erase(found);
        is_fresh_.assign(candidates_.size(), 0);
    }

  private:
    std::vector<std::size_t> candidates_;  // ascending
    std::vector<std::uint64_t> bounds_;
    std::vector<std::uint8_t> is_fresh_;
};

struct Choice {
    std::vector<std::size_t> chosen;
    std::optional<NextLamp> next;
    CoverStop stop = CoverStop::no_candidates;
};

// cover: with the lights taken already. candidates: ascending. all: what can be reached.
Choice choose_from(std::vector<std::size_t> candidates,
                   Cover cover,
                   const Cover& all,
                   const Measurability& measurability,
                   const CoverOptions& options) {
    Choice choice;
    const double min_gain = options.min_gain * double(measurability.num_seen);
    LazyGains gains(cover, std::move(candidates));
    while (!gains.empty()) {
        const Pick pick = gains.best(cover);
        const bool enough = cover.reaches(options.enough, all);
        const bool full = options.max_lamps > 0 && choice.chosen.size() == options.max_lamps;
        Cover with = cover;
        with.add(pick.light);
        if (enough || full || pick.gain == 0 || double(pick.gain) < min_gain) {
            choice.stop = enough ? CoverStop::enough
                          : full ? CoverStop::max_lamps
                                 : CoverStop::small_gain;
            choice.next = NextLamp{pick.light, with.share()};
            return choice;
        }
        cover = std::move(with);
        choice.chosen.push_back(pick.light);
        gains.take(pick.light);
    }
    if (cover.reaches(options.enough, all)) choice.stop = CoverStop::enough;
    return choice;
}

}  // namespace

void validate(const CoverOptions& options, std::size_t num_lights) {
    const auto is_angle = [](double angle) { return angle > 0 && angle <= kPi / 2; };
    require(
        is_angle(options.max_light_angle), "--max-light-angle", "is out of range", "in (0, 90]");
    require(is_angle(options.max_view_angle), "--max-view-angle", "is out of range", "in (0, 90]");
    require(options.roughness > 0, "--roughness", "is not positive", "radians > 0");
    require(options.specular_reach > 0, "--specular-reach", "is not positive", "> 0");
    require(options.diffuse_reach >= options.specular_reach,
            "--diffuse-reach",
            "is below --specular-reach",
            "at least as large");
    for (const auto& [name, need] : {std::pair{"--specular-need", options.specular_need},
                                     std::pair{"--diffuse-need", options.diffuse_need}}) {
        require(need >= 1 && need <= kMaxNeed, name, "is out of range", "1 to 255");
    }
    require(options.min_gain >= 0, "--min-gain", "is negative", ">= 0");
    require(options.enough > 0 && options.enough <= 1, "--enough", "is out of range", "in (0, 1]");
    for (const std::size_t light : options.taken) {
        require(light < num_lights, "--taken", "names no light", "a light of the capture");
        require(std::count(options.taken.begin(), options.taken.end(), light) == 1,
                "--taken",
                "names a light twice",
                "each once");
    }
}

Measurability measure_candidates(const RigView& rig,
                                 const CoverOptions& options,
                                 Progress& progress,
                                 const LampVisit& visit) {
    const CaptureDescription& description = rig.capture().description;
    const std::size_t num_lights = description.lights.size();
    validate(options, num_lights);
    Measurability result;
    result.candidates = candidate_lights(description, options.taken);
    std::vector<std::size_t> counted = result.candidates;
    counted.insert(counted.end(), options.taken.begin(), options.taken.end());
    std::sort(counted.begin(), counted.end());

    progress.begin_stage("lamps", counted.size(), "lamps");
    result.num_seen = rig.seen().size();
    result.shows.resize(num_lights);
    for (const std::size_t light : counted) {
        const LargeVector<DirectLight> direct = rig.direct(description.lights[light]);
        result.shows[light] = lamp_shows(rig, description.lights[light], direct, options);
        if (visit) visit(light, direct);
        progress.advance(1);
    }
    progress.end_stage(std::to_string(result.candidates.size()) + " candidates, " +
                       std::to_string(result.num_seen) + " texels seen");
    return result;
}

Measurability measure_candidates(const Capture& capture,
                                 const CoverOptions& options,
                                 Progress& progress) {
    validate(options, capture.description.lights.size());
    return measure_candidates(RigView(capture, progress), options, progress);
}

std::uint64_t coverage(const Measurability& measurability,
                       std::span<const std::size_t> lights,
                       const CoverOptions& options) {
    Cover cover(measurability, options, kShowsDiffuse | kShowsSpecular);
    for (const std::size_t light : lights) cover.add(light);
    return cover.sum();
}

namespace {

constexpr std::uint8_t kBoth = kShowsDiffuse | kShowsSpecular;

// The lamps taken already and some more.
Cover cover_of(const Measurability& measurability,
               const CoverOptions& options,
               std::uint8_t components,
               std::span<const std::size_t> more) {
    Cover cover(measurability, options, components);
    for (const std::size_t light : options.taken) cover.add(light);
    for (const std::size_t light : more) cover.add(light);
    return cover;
}

Choice choose_components(const Measurability& measurability,
                         const CoverOptions& options,
                         std::uint8_t components,
                         std::vector<std::size_t> candidates) {
    return choose_from(std::move(candidates),
                       cover_of(measurability, options, components, {}),
                       cover_of(measurability, options, components, measurability.candidates),
                       measurability,
                       options);
}

}  // namespace

std::vector<MeasurableShare> shares_of(const Measurability& measurability,
                                       const CoverOptions& options,
                                       std::span<const std::size_t> lights) {
    Cover cover = cover_of(measurability, options, kBoth, {});
    std::vector<MeasurableShare> shares = {cover.share()};
    for (const std::size_t light : lights) {
        cover.add(light);
        shares.push_back(cover.share());
    }
    return shares;
}

LightPlan describe_choice(const Measurability& measurability,
                          const CoverOptions& options,
                          std::vector<std::size_t> chosen) {
    LightPlan plan;
    plan.candidates = measurability.candidates;
    plan.num_seen = measurability.num_seen;
    std::vector<std::size_t> ascending = chosen;
    std::sort(ascending.begin(), ascending.end());
    plan.chosen_for_diffuse =
        choose_components(measurability, options, kShowsDiffuse, std::move(ascending)).chosen;
    plan.shares = shares_of(measurability, options, chosen);
    plan.share_before = plan.shares.front();
    plan.shares.erase(plan.shares.begin());
    plan.share_with_all = cover_of(measurability, options, kBoth, measurability.candidates).share();
    plan.chosen = std::move(chosen);
    return plan;
}

LightPlan choose_lights(const Measurability& measurability, const CoverOptions& options) {
    Choice both = choose_components(measurability, options, kBoth, measurability.candidates);
    LightPlan plan = describe_choice(measurability, options, std::move(both.chosen));
    plan.next = both.next;
    plan.stop = both.stop;
    return plan;
}

LightPlan plan_lights(const Capture& capture, const CoverOptions& options, Progress& progress) {
    const Measurability measurability = measure_candidates(capture, options, progress);
    progress.begin_stage("greedy cover");
    LightPlan plan = choose_lights(measurability, options);
    progress.end_stage(std::to_string(plan.chosen.size()) + " lamps chosen, " +
                       std::to_string(plan.chosen_for_diffuse.size()) + " for the diffuse part");
    return plan;
}

}  // namespace patina
