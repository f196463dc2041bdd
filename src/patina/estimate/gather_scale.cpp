#include "patina/estimate/gather_scale.h"

#include "patina/estimate/gather_trials.h"
#include "patina/math/statistics.h"

#include <fmt/format.h>

#include <cmath>

namespace patina {
namespace {

// Pd of most surfaces is not far from this, which is where the search starts [-].
constexpr double kTypicalAlbedo = 0.5;

// ln of the factor under which the median texel has the typical albedo, if all light were direct.
double start_of_search(std::span<const TexelFit> fits) {
    std::vector<double> albedos;
    for (const TexelFit& fit : fits) {
        if (fit.observed) albedos.push_back(fit.reflectance.diffuse.maxCoeff());
    }
    const double middle = albedos.empty() ? 0 : median(std::move(albedos));
    return middle > 0 ? std::log(middle / kTypicalAlbedo) : 0;
}

}  // namespace

ScaleEstimate measure_scale(GatherIteration& iteration,
                            GatherEngine& engine,
                            const TexelAtlas& atlas,
                            const SceneView& scene,
                            const Observations& observations,
                            Progress& progress) {
    progress.begin_stage("absolute scale");
    GatherTrials trials(iteration, engine, atlas, scene, observations, progress, [&](double x) {
        iteration.set_lamp_factor(std::exp(x));
    });
    const ScaleEstimate scale =
        find_scale(trials, start_of_search(iteration.fits()), scene.lamp_sets.size());
    progress.end_stage(scale.told
                           ? fmt::format("{} turns, the lamps are {:.4g} times as strong as stated "
                                         "(standard error {:.1f} %)",
                                         trials.num_turns(),
                                         scale.factor,
                                         100 * scale.standard_error)
                           : fmt::format("{} turns", trials.num_turns()));
    if (!scale.told) progress.note(untold_note(scale));
    return scale;
}

}  // namespace patina
