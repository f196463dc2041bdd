// Gather iterations brought to rest under one value after another of an unknown that all texels
// share, and what the looks then say against it.
#pragma once

#include "patina/estimate/gather_engine.h"
#include "patina/estimate/gather_iteration.h"
#include "patina/estimate/profile.h"

#include <functional>
#include <span>
#include <vector>

namespace patina {

// Keeps references to what it is made from.
class GatherTrials final : public ProfileTrials {
  public:
    // iteration: started. apply: gives the unknown a value in the iteration.
    GatherTrials(GatherIteration& iteration,
                 GatherEngine& engine,
                 const TexelAtlas& atlas,
                 const SceneView& scene,
                 const Observations& observations,
                 Progress& progress,
                 std::function<void(double)> apply);

    // Some turns at x, after which weights and what counts as measured are held.
    void settle(double x) override;
    // Turns at x until the maps move by less than the tolerance, relative.
    [[nodiscard]] ProfileTrial try_at(double x, double tolerance) override;
    [[nodiscard]] int num_turns() const { return num_turns_; }

  private:
    double take_turn(bool frozen);
    [[nodiscard]] std::size_t block_of(std::size_t texel) const;
    [[nodiscard]] std::vector<double> costs() const;
    void add_texel(std::size_t texel, std::span<double> costs) const;

    GatherIteration& iteration_;
    GatherEngine& engine_;
    const TexelAtlas& atlas_;
    const SceneView& scene_;
    const Observations& observations_;
    Progress& progress_;
    std::function<void(double)> apply_;
    int num_turns_ = 0;
};

}  // namespace patina
