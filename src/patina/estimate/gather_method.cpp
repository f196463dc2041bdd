#include "patina/estimate/gather_method.h"

#include "patina/estimate/gather_iteration.h"
#include "patina/estimate/gather_scale.h"
#include "patina/estimate/memory_need.h"
#include "patina/estimate/shared_lobe.h"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace patina {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The scale's error comes on top of each texel's own, infinite where nothing is known.
void add_scale_error(double relative_error, Estimate& estimate) {
    for (std::size_t i = 0; i < estimate.maps.size(); ++i) {
        const Reflectance& map = estimate.maps[i];
        Reflectance& error = estimate.errors[i];
        error.diffuse = (error.diffuse.square() + (relative_error * map.diffuse).square()).sqrt();
        error.specular = std::hypot(error.specular, relative_error * map.specular);
    }
}

// Where less of the light than this goes on from bounce to bounce, it tells nothing of a lobe [-].
constexpr double kBouncesThatTell = 0.02;

// Turns until the maps rest, from looks whose radiances were divided by `lamp_factor`. The engine
// is given up before the standard errors are reckoned: both at once would take the most memory of
// all.
Estimate iterate(const Capture& capture,
                 const SceneView& scene,
                 const Observations& observations,
                 double lamp_factor,
                 EstimateOptions options,
                 std::unique_ptr<GatherEngine> engine,
                 Progress& progress) {
    // E is in radiances of the capture.
    options.threshold /= square(lamp_factor);
    GatherIteration iteration(capture, scene, observations, options);
    iteration.start(progress);
    iteration.run(*engine, progress);
    std::optional<SharedLobe> lobe;
    if (!iteration.has_lobes() && iteration.light().spectral_radius > kBouncesThatTell) {
        lobe =
            measure_shared_lobe(iteration, *engine, capture.atlas, scene, observations, progress);
        iteration.set_shared_lobe(lobe->specular_albedo);
        iteration.run(*engine, progress);
    }
    engine->finish_graph_file(progress);
    engine.reset();
    progress.begin_stage("standard errors");
    Estimate estimate = iteration.finish();
    progress.end_stage();
    estimate.shared_lobe = lobe;
    for (IterationLog& turn : estimate.iterations) turn.error *= square(lamp_factor);
    return estimate;
}

}  // namespace

Estimate estimate_by_gathering(const Capture& capture,
                               const Surface& surface,
                               const EstimateOptions& options,
                               Progress& progress) {
    const double limit = options.memory ? *options.memory * kGibibyte : kInfinity;
    MemoryCounts counts = count_memory(capture);
    (void)plan_memory(counts, limit);
    const SceneView scene = view_scene(capture, surface, progress);
    counts = count_work(capture, surface, scene, options, std::move(counts));
    const MemoryPlan memory = plan_memory(counts, limit);
    progress.note(memory_words(memory, counts));
    Observations observations =
        collect_observations(capture, scene, options.observations, progress);
    auto engine = std::make_unique<GatherEngine>(
        surface, capture.atlas, scene, options, progress, memory.kept_blocks);
    std::optional<ScaleEstimate> scale;
    if (capture.description.radiometry.scale_unknown) {
        GatherIteration trials(capture, scene, observations, options);
        trials.start(progress);
        scale = measure_scale(trials, *engine, capture.atlas, scene, observations, progress);
        engine->restart();
    }
    const double lamp_factor = scale ? scale->factor : 1;
    if (lamp_factor != 1) divide_radiances(lamp_factor, observations);
    Estimate estimate =
        iterate(capture, scene, observations, lamp_factor, options, std::move(engine), progress);
    if (scale && scale->told) add_scale_error(scale->standard_error, estimate);
    estimate.scale = std::move(scale);
    estimate.reckoned_memory = memory.peak;
    return estimate;
}

}  // namespace patina
