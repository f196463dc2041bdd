#include "patina/estimate/lobe_bounds.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/estimate/error_propagation.h"
#include "patina/estimate/fit_rows.h"
#include "patina/estimate/observations.h"
#include "patina/estimate/texel_turn.h"

#include <cmath>
#include <limits>

namespace patina {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

LobeBound bound_of(std::span<FitRow> rows, const Reflectance& truth, const FitNoise& noise) {
    for (FitRow& row : rows) row.radiance = predict(row, truth);
    TexelFit fit;
    fit.reflectance = truth;
    judge_lobe(rows, noise.scale, false, FitOptions(), fit);
    if (!std::isfinite(fit.roughness_error)) return {false, kInfinity, kInfinity};
    const ErrorPropagation propagation(rows, truth, KnownLobe::all);
    const Parameters variance =
        noise.own * propagation.own_variance() + noise.shared * propagation.shared_variance();
    return {fit.roughness_measured, std::sqrt(variance[3]), std::sqrt(variance[4])};
}

}  // namespace

std::vector<LobeBound> lobe_bounds(const Capture& capture,
                                   std::span<const Reflectance> truth,
                                   const FitNoise& noise,
                                   Progress& progress) {
    PATINA_CHECK_EQ(truth.size(), capture.atlas.texels.size());
    const Tracer tracer(capture.mesh);
    const Surface surface{&capture.mesh, &tracer};
    const SceneView scene = view_scene(capture, surface, progress);
    const Observations observations =
        collect_observations(capture, scene, ObservationOptions(), progress);
    const FitRowMaker maker(scene, observations);
    const IndirectLight direct_only;
    std::vector<LobeBound> bounds(truth.size());
    parallel_blocks(truth.size(), kParallelBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<FitRow> rows;
        for (std::size_t i = begin; i < end; ++i) {
            maker.make(i, direct_only, truth[i], rows);
            if (!rows.empty()) bounds[i] = bound_of(rows, truth[i], noise);
        }
    });
    return bounds;
}

}  // namespace patina
