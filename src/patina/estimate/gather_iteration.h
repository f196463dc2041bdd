// Method gather: sweeps of light over the gather graph and joint fits of every texel, interleaved.
//
// docs/theory.md, "The iteration": one sweep for each fit has the fixed points of the paper's loop
// and contracts by lambda wherever lambda < 1.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/estimate/drawn_lobe.h"
#include "patina/estimate/estimate.h"
#include "patina/estimate/fit_rows.h"
#include "patina/estimate/gather_engine.h"
#include "patina/estimate/guided_fill.h"
#include "patina/estimate/joint_fit.h"
#include "patina/estimate/lobe_filling.h"
#include "patina/estimate/observations.h"
#include "patina/estimate/texel_turn.h"

#include <span>
#include <string>
#include <vector>

namespace patina {

// Keeps references to what it is made from. Not thread-safe; parallel inside.
class GatherIteration {
  public:
    GatherIteration(const Capture& capture,
                    const SceneView& scene,
                    const Observations& observations,
                    const EstimateOptions& options);

    // A fit without indirect light, which the others start from.
    void start(Progress& progress);
    // Turns until the maps rest, or options.max_iterations of them.
    void run(GatherEngine& engine, Progress& progress);
    // One sweep and one fit of all texels. frozen: what counts as measured, the weights of outliers
    // and the guide of the filling stay as they are; otherwise hold() ends.
    IterationLog turn(GatherEngine& engine, bool frozen);
    // Leaves the iteration empty.
    [[nodiscard]] Estimate finish();

    // The true intensities of the lamps over the stated ones, 1 at first [-]; > 0. The maps follow
    // so that the direct light that they reflect stays the same.
    void set_lamp_factor(double factor);
    // Ps sigma^2 of all texels where no lobe was measured anywhere, 0 at first [-]; >= 0.
    void set_shared_lobe(double specular_albedo) { shared_lobe_ = specular_albedo; }
    // Whether any texel's Ps was measured in the last turn.
    [[nodiscard]] bool has_lobes() const;
    // From now on, in frozen turns, the looks have the weights that they have under the present
    // light and maps, but for the lamp factor, and lobes have their present sigma: costs under
    // several factors then compare, and change smoothly.
    void hold();

    // The looks at a texel under the present light, with their weights. Radiances are those of the
    // capture over the lamp factor.
    void make_rows(std::size_t texel, const IndirectLight& light, std::vector<FitRow>& rows) const;
    // What turn() left: its light, its fits before they were held in the feasible set, the maps.
    [[nodiscard]] const IndirectLight& light() const { return light_; }
    [[nodiscard]] std::span<const TexelFit> fits() const { return fits_; }
    [[nodiscard]] std::span<const Reflectance> maps() const { return result_.maps; }
    [[nodiscard]] std::size_t num_clamped() const { return result_.num_clamped; }

  private:
    // The row factors of one texel.
    [[nodiscard]] std::span<float> robust(std::size_t texel);
    IterationLog take_turn(const std::string& stage,
                           const IndirectLight& light,
                           bool has_maps,
                           bool frozen);

    [[nodiscard]] bool is_held() const { return !held_weights_.empty(); }

    // One texel.
    void fit_texel(const std::vector<FitRow>& rows,
                   bool has_maps,
                   const JointFit& joint,
                   std::size_t i);
    void follow_texel(const JointFit& joint, std::size_t i);
    void draw_texel(const JointFit& joint, std::size_t i);
    [[nodiscard]] Reflectance with_lobe_shown(std::size_t i) const;
    void weigh_outliers(const JointFit& joint, std::size_t i, std::vector<double>& misfits);

    // All texels.
    void update_noise_scale();
    // tolerance: of solve_links().
    void fill_unmeasured(const IndirectLight& light, double tolerance);
    void refit_matte(const IndirectLight& light);
    void refit_unconfirmed(const IndirectLight& light);
    double update_maps();

    // What neighbours say of measured lobes, for the next turn (gather_lobes.cpp).
    void ask_neighbors(bool frozen);
    // Filled lobes that looks reach into (gather_lobes.cpp).
    void inform_filled(const IndirectLight& light, bool frozen);
    void choose_informed();
    [[nodiscard]] double trust_in_looks(const IndirectLight& light) const;
    [[nodiscard]] LargeVector<LobeEvidence> evidence_of_looks(const IndirectLight& light) const;
    void take_informed(const IndirectLight& light,
                       std::span<const LobeEvidence> evidence,
                       bool frozen);

    const Capture& capture_;
    const TexelAtlas& atlas_;
    const SceneView& scene_;
    const Observations& observations_;
    FitRowMaker rows_;
    const EstimateOptions& options_;
    std::size_t num_texels_;
    double lamp_factor_ = 1;
    double shared_lobe_ = 0;
    int num_free_turns_ = 0;  // under bounced light, not frozen
    LobeSpread between_neighbors_ = {0, 0};
    LargeVector<LobePrior> priors_;  // empty: nothing is known of neighbours
    double trust_ = 0;               // see evidence_weight()
    LargeVector<TexelFit> fits_;
    LargeVector<float> robust_;       // factors on the weights, per row of the observations
    std::vector<Rgbf> held_weights_;  // for lamp factor 1, per row; empty unless held
    GuidedFill geometry_fill_;
    LobeFilling lobe_filling_;
    std::vector<std::uint8_t>
        dropped_;  // by drop_unconfirmed(), in the last turn that was not frozen
    IndirectLight light_;
    Estimate result_;
};

}  // namespace patina
