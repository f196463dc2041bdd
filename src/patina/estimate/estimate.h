// The estimate: methods I (direct), II (diffuse) and the paper's (photon) on one iteration, and
// ours (gather) on its own.
//
// Based on: Machida, Takemura, Yokoya. 2004, sections 2.2 and 3. docs/theory.md says where and why
// we depart.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/capture.h"
#include "patina/capture/result_folder.h"
#include "patina/estimate/calibration_errors.h"
#include "patina/estimate/measurability.h"
#include "patina/estimate/observations.h"
#include "patina/estimate/scale_profile.h"
#include "patina/estimate/texel_fit.h"
#include "patina/transport/gather_graph.h"
#include "patina/transport/ratio_kernel.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patina {

enum class Method { direct, diffuse, photon, gather };
// How the maps follow a fit: damped by omega = 1 - lambda^2, or replaced by it as in the paper.
enum class Loop { damped, plain };
// How photons become irradiance. disc: the classical k nearest neighbours, for comparison only.
enum class Irradiance { ratio, disc };

struct EstimateOptions {
    Method method = Method::gather;
    Loop loop = Loop::damped;
    Irradiance irradiance = Irradiance::ratio;
    PhotonOptions photons;
    RatioKernelOptions kernel;
    GatherOptions gather;
    // Where method gather keeps its graph for the next estimate; empty: nowhere (for
    // estimate_capture(): beside the result).
    std::filesystem::path graph_file;
    // What method gather may take [GiB]; nothing: what it needs. > 0
    std::optional<double> memory;
    double filter_radius = 2.0;  // of the indirect light of method gather [texels]; > 0
    ObservationOptions observations;
    FitOptions fit;
    int max_iterations = 60;  // of the outer loop, for each of methods II and photon; >= 1
    double threshold = 0;     // stop when E of equation (5) falls below it [radiance^2]; >= 0
    double tolerance = 1e-4;  // stop when maps and E change by less, relative [-]; > 0
};

// One turn of the outer loop.
struct IterationLog {
    std::string stage;  // the method whose loop it belongs to
    double error =
        0;  // E of equation (5): mean squared difference over looks and channels [radiance^2]
    double change = 0;           // root mean square relative change of the maps' albedo [-]
    double spectral_radius = 0;  // lambda, from the power of successive bounces [-]
    double damping = 1;          // omega [-]
    bool retraced = false;       // photons were traced anew before this turn
};

// The lobe of all texels where none shows a highlight, from bounced light.
struct SharedLobe {
    double specular_albedo = 0;  // Ps sigma^2; 0 unless told from 0 [-]
    double standard_error = 0;   // of the value that fits best; infinite: there is none [-]
};

// One entry per texel of the atlas in every vector.
struct Estimate {
    std::vector<Reflectance> maps;
    std::vector<Reflectance> errors;  // standard errors; +infinity where nothing is known
    std::vector<TexelStatus> status;
    std::vector<TexelMeasurability> measurability;
    std::vector<std::uint8_t>
        seen;  // by some camera, within the angle limits, under an unshadowed lamp
    std::vector<float>
        indirect_over_direct;  // mean over looks of indirect over direct irradiance [-]
    std::vector<IterationLog> iterations;
    bool converged = false;
    std::size_t num_clamped = 0;  // texels held in the feasible set
    double noise_scale = 1;       // root of the median misfit over the stated variance [-]
    // Of the standardised residuals, the median over the surface: the variance that the channels of
    // a look do not share, and that they do [-].
    double noise_own = 1;
    double noise_shared = 0;
    double lobe_misfit = 1;  // factor of the errors of Ps and sigma, lobe_misfit_factor() [-]
    std::vector<FoundError> calibration;  // errors that the capture states and all texels share
    // Where the capture does not know the strength of its lamps. The maps are those under the lamps
    // as stated times its factor.
    std::optional<ScaleEstimate> scale;
    std::optional<SharedLobe> shared_lobe;  // where it was looked for
    // The peak as it was reckoned beforehand, by method gather alone [bytes].
    std::optional<double> reckoned_memory;
};

// Throws Error for options out of range. option names in messages are those of the command line.
void validate(const EstimateOptions& options);

[[nodiscard]] Estimate estimate_reflectance(const Capture& capture,
                                            const EstimateOptions& options,
                                            Progress& progress);

}  // namespace patina
