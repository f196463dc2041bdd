#include "patina/estimate/shared_lobe.h"

#include "patina/estimate/gather_trials.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace patina {
namespace {

// Arms of the parabola: two fifths of the 0.05 that glossy paints reflect by their lobe, 2 Ps
// sigma^2. The lobe's light is nearly linear in it, so the misfit is nearly a parabola.
constexpr double kArm = 0.01;
constexpr int kMaxRounds = 4;
// A lobe is told from none at so many standard errors.
constexpr double kTold = 2;

}  // namespace

SharedLobe measure_shared_lobe(GatherIteration& iteration,
                               GatherEngine& engine,
                               const TexelAtlas& atlas,
                               const SceneView& scene,
                               const Observations& observations,
                               Progress& progress) {
    progress.begin_stage("shared lobe");
    GatherTrials trials(iteration, engine, atlas, scene, observations, progress, [&](double x) {
        iteration.set_shared_lobe(x);
    });
    SharedLobe lobe;
    lobe.standard_error = std::numeric_limits<double>::infinity();
    double x = kArm;
    for (int round = 0; round < kMaxRounds; ++round) {
        trials.settle(x);
        const Vertex vertex = vertex_at(trials, x, kArm, scene.lamp_sets.size());
        if (!vertex.exists) break;
        lobe.standard_error = vertex.standard_error;
        lobe.specular_albedo = x + vertex.offset;
        x = std::max(kArm, x + std::clamp(vertex.offset, -4 * kArm, 4 * kArm));
        if (std::abs(vertex.offset) <= kArm / 2) break;
    }
    if (!(lobe.specular_albedo > kTold * lobe.standard_error)) lobe.specular_albedo = 0;
    progress.end_stage(fmt::format("{} turns, Ps sigma^2 {:.3g} (standard error {:.2g})",
                                   trials.num_turns(),
                                   lobe.specular_albedo,
                                   lobe.standard_error));
    return lobe;
}

}  // namespace patina
