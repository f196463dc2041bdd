#include "patina/plan/planned_looks.h"

#include <algorithm>
#include <map>
#include <utility>

namespace patina {
namespace {

// The sets of lights that used shots lit, each with the cameras that took them.
std::map<std::vector<std::size_t>, std::vector<std::size_t>> cameras_by_lights(
    const CaptureDescription& description) {
    std::map<std::vector<std::size_t>, std::vector<std::size_t>> result;
    for (const Shot& shot : description.shots) {
        if (!shot.heldout) result[shot.lights].push_back(shot.camera);
    }
    return result;
}

class LookCollector {
  public:
    LookCollector(const RigView& rig,
                  const std::vector<Camera>& new_cameras,
                  const PlannedLooksOptions& options)
        : rig_(rig), options_(options), description_(rig.capture().description) {
        data_.texels = sample_texels(rig, options.max_texels, options.seed);
        for (const Camera& camera : new_cameras) {
            new_views_.push_back(values_at(data_.texels.ids, rig.views_of(camera)));
            new_cameras_.push_back(&camera);
        }
    }

    PlannedLooks collect(Progress& progress) {
        // In ascending order, as the candidates are.
        data_.measurability =
            measure_candidates(rig_,
                               options_.cover,
                               progress,
                               [this](std::size_t light, const LargeVector<DirectLight>& all) {
                                   light_[light] = values_at(data_.texels.ids, all);
                                   if (is_taken(light)) return;
                                   data_.candidates.push_back(looks_through_all({light}));
                                   light_.erase(light);
                               });
        std::vector<LookTable> taken;
        for (const auto& [lights, cameras] : taken_sets()) {
            for (const std::size_t camera : cameras) taken.push_back(looks(lights, camera));
        }
        data_.taken = join(taken);
        for (std::size_t camera = 0; camera < new_cameras_.size(); ++camera) {
            data_.new_cameras.push_back(looks_of_new(camera));
        }
        return std::move(data_);
    }

  private:
    using Lights = std::vector<std::size_t>;

    [[nodiscard]] bool is_taken(std::size_t light) const {
        const std::vector<std::size_t>& taken = options_.cover.taken;
        return std::find(taken.begin(), taken.end(), light) != taken.end();
    }

    [[nodiscard]] std::map<Lights, std::vector<std::size_t>> taken_sets() const {
        if (options_.shots_are_taken) return cameras_by_lights(description_);
        std::map<Lights, std::vector<std::size_t>> sets;
        for (const std::size_t light : options_.cover.taken) sets[{light}] = cameras_for(light);
        return sets;
    }

    [[nodiscard]] std::vector<std::size_t> cameras_for(std::size_t light) const {
        std::vector<std::size_t> cameras;
        for (std::size_t i = 0; i < description_.cameras.size(); ++i) {
            if (may_go_together(description_.cameras[i], description_.lights[light])) {
                cameras.push_back(i);
            }
        }
        return cameras;
    }

    [[nodiscard]] LookTable collect_through(const Lights& lights,
                                            std::span<const TexelView> views) const {
        std::vector<const std::vector<DirectLight>*> lamps;
        for (const std::size_t light : lights) lamps.push_back(&light_.at(light));
        return collect_looks(
            rig_.capture().atlas, data_.texels.ids, lamps, views, options_.cover.limits());
    }

    [[nodiscard]] LookTable looks(const Lights& lights, std::size_t camera) const {
        return collect_through(lights, data_.texels.views[camera]);
    }

    [[nodiscard]] LookTable looks_through_all(const Lights& lights) const {
        std::vector<LookTable> tables;
        for (const std::size_t camera : cameras_for(lights.front())) {
            tables.push_back(looks(lights, camera));
        }
        return join(tables);
    }

    [[nodiscard]] LookTable looks_of_new(std::size_t camera) const {
        std::vector<LookTable> tables;
        for (const auto& [lights, cameras] : taken_sets()) {
            if (std::all_of(lights.begin(), lights.end(), [&](std::size_t light) {
                    return may_go_together(*new_cameras_[camera], description_.lights[light]);
                })) {
                tables.push_back(collect_through(lights, new_views_[camera]));
            }
        }
        return join(tables);
    }

    [[nodiscard]] LookTable join(std::span<const LookTable> tables) const {
        return join_tables(tables, data_.texels.ids.size());
    }

    const RigView& rig_;
    const PlannedLooksOptions& options_;
    const CaptureDescription& description_;
    std::vector<const Camera*> new_cameras_;
    std::vector<std::vector<TexelView>> new_views_;
    std::map<std::size_t, std::vector<DirectLight>> light_;  // per light, at the plan's texels
    PlannedLooks data_;
};

}  // namespace

PlannedLooks collect_planned_looks(const RigView& rig,
                                   const std::vector<Camera>& new_cameras,
                                   const PlannedLooksOptions& options,
                                   Progress& progress) {
    return LookCollector(rig, new_cameras, options).collect(progress);
}

}  // namespace patina
