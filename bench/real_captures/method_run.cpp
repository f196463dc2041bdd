#include "method_run.h"

#include "patina/base/parallel.h"
#include "patina/pipeline/estimate_capture.h"
#include "patina/raytrace/tracer.h"

#include <algorithm>
#include <limits>

namespace patina {
namespace {

// Keeps weights finite where a look is noise-free [radiance^2].
constexpr double kSmallestVariance = 1e-16;

EstimateOptions estimate_options(Method method, const RunSettings& settings) {
    EstimateOptions options;
    options.method = method;
    options.photons.photons = settings.photons;
    options.photons.seed = settings.seed;
    return options;
}

// Renders the held-out shots alone.
void compare_heldout(const Capture& capture,
                     const RunSettings& settings,
                     Progress& progress,
                     MethodRun& run) {
    Capture heldout = capture;
    std::vector<Shot>& shots = heldout.description.shots;
    std::erase_if(shots, [](const Shot& shot) { return !shot.heldout; });
    CompareOptions options;
    options.render.samples_per_pixel = settings.samples;
    options.render.seed = settings.seed;
    const Comparison comparison = compare_maps(heldout, run.maps, run.name, options, progress);
    run.heldout = comparison.heldout;
    run.truth = comparison.truth;
}

Rgb lambertian_diffuse(const Observations& observations, std::size_t texel) {
    std::vector<FitRow> rows;
    for (const Observation& look : observations.of(texel)) {
        FitRow& row = rows.emplace_back();
        row.radiance = look.radiance.cast<double>();
        row.weight = 1 / look.variance.cast<double>().max(kSmallestVariance);
        row.lamps = observations.lamps(look);
        for (const LampTerm& lamp : row.lamps) row.irradiance += lamp.irradiance.cast<double>();
        // All of one class: none is preferred.
        row.pixel_class = PixelClass::neither;
    }
    return rows.empty() ? Rgb::Zero() : fit_diffuse(rows, Reflectance(), FitOptions());
}

Estimate estimate_lambertian(const Capture& capture, Progress& progress) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const Tracer tracer(capture.mesh);
    const Surface surface{&capture.mesh, &tracer};
    const SceneView scene = view_scene(capture, surface, progress);
    const Observations observations =
        collect_observations(capture, scene, ObservationOptions(), progress);
    const std::size_t num_texels = capture.atlas.texels.size();
    Estimate estimate;
    estimate.maps.resize(num_texels);
    estimate.errors.assign(num_texels, {Rgb::Constant(kInfinity), kInfinity, kInfinity});
    estimate.status.assign(num_texels, TexelStatus::filled);
    estimate.measurability.resize(num_texels);
    estimate.seen = observations.seen;
    estimate.indirect_over_direct.assign(num_texels, 0.0f);
    parallel_for(num_texels, [&](std::size_t i) {
        if (observations.of(i).empty()) return;
        estimate.status[i] = TexelStatus::diffuse_measured;
        estimate.maps[i].diffuse = lambertian_diffuse(observations, i);
        estimate.maps[i] = project_to_feasible(estimate.maps[i]).reflectance;
    });
    return estimate;
}

MethodRun finish_run(const std::string& name,
                     const Capture& capture,
                     const EstimateOptions& options,
                     Estimate estimate,
                     const RunSettings& settings,
                     Progress& progress) {
    MethodRun run;
    run.name = name;
    run.maps = make_result(capture, options, estimate).maps;
    run.estimate = std::move(estimate);
    compare_heldout(capture, settings, progress, run);
    return run;
}

}  // namespace

bool has_status(const MethodRun& run, TexelId texel, TexelStatus status) {
    return run.estimate.status[texel] == status;
}

bool is_diffuse_measured(const MethodRun& run, TexelId texel) {
    return has_status(run, texel, TexelStatus::measured) ||
           has_status(run, texel, TexelStatus::diffuse_measured);
}

double mean_diffuse(const MethodRun& run, TexelId texel) {
    return run.estimate.maps[texel].diffuse.mean();
}

MethodRun run_method(const Capture& capture,
                     Method method,
                     const RunSettings& settings,
                     Progress& progress) {
    const EstimateOptions options = estimate_options(method, settings);
    Estimate estimate = estimate_reflectance(capture, options, progress);
    return finish_run(
        method_name(method), capture, options, std::move(estimate), settings, progress);
}

MethodRun run_lambertian(const Capture& capture, const RunSettings& settings, Progress& progress) {
    return finish_run("Lambertian",
                      capture,
                      estimate_options(Method::direct, settings),
                      estimate_lambertian(capture, progress),
                      settings,
                      progress);
}

}  // namespace patina
