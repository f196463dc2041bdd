// Every usable look at every texel: what the used shots say, and the direct light that explains it.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/base/progress.h"
#include "patina/capture/capture.h"
#include "patina/observe/camera_view.h"
#include "patina/observe/shot_samples.h"
#include "patina/transport/direct.h"
#include "patina/transport/photon_paths.h"

#include <span>
#include <vector>

namespace patina {

struct ObservationOptions {
    double max_light_angle = radians(80.0);  // from the normal; beyond, a look is left out [rad]
    double max_view_angle = radians(75.0);   // from the normal [rad]
    double calibration_stddev = 0.01;  // of radiance, relative: what no noise model covers [-]
    double default_read_stddev =
        0.002;  // where the capture states no noise; share of the 99th percentile [-]
};

// One lamp's direct light in one look.
struct LampTerm {
    Rgbf irradiance = Rgbf::Zero();  // cosine included [radiance x sr]
    float theta_r_squared = 0;       // [rad^2]
    float lobe_cosines = 0;          // lobe_cosines() [-]
    // Variance of the view's chord to the mirror direction over the look's footprint, along that
    // chord and across it [rad^2]: what widens the highlight.
    float spread_along = 0;
    float spread_across = 0;
};

// One look: one shot, one texel.
struct Observation {
    Rgbf radiance = Rgbf::Zero();
    Rgbf variance = Rgbf::Zero();  // read, shot and calibration noise [radiance^2]
    float theta_r = 0;             // smallest of the lamps' [rad]
    std::uint32_t shot = 0;        // position among the used shots
    std::uint32_t first_term = 0;
    std::uint32_t num_terms = 0;
};

// Compressed rows by texel. Looks at a silhouette or at a shadow's edge are kept only for texels
// that have no better one.
struct Observations {
    std::vector<std::uint32_t> begin;  // texels + 1 offsets into rows
    LargeVector<Observation> rows;
    LargeVector<LampTerm> terms;
    // Per row; empty unless the capture states an error of registration.
    std::vector<SampleGradient> gradients;
    // Texels that some camera sees within the angle limits under an unshadowed lamp.
    std::vector<std::uint8_t> seen;

    [[nodiscard]] std::span<const Observation> of(std::size_t texel) const {
        return std::span(rows).subspan(begin[texel], begin[texel + 1] - begin[texel]);
    }
    [[nodiscard]] std::span<const LampTerm> lamps(const Observation& row) const {
        return std::span(terms).subspan(row.first_term, row.num_terms);
    }
};

// Divides every radiance and its noise: where lamps are `factor` times as strong as stated, these
// are the radiances that they would bring about as stated. factor: > 0.
void divide_radiances(double factor, Observations& observations);

// The scene as the used shots (those not held out) see it. Nothing in it depends on the maps.
struct SceneView {
    std::vector<std::size_t> shots;                // indices into the capture's shots
    std::vector<std::size_t> camera_of_shot;       // into views
    std::vector<std::size_t> lamp_set_of_shot;     // into lamp_sets
    std::vector<std::vector<TexelView>> views;     // per camera that a used shot needs
    std::vector<const Light*> lights;              // every lamp of the capture
    std::vector<LargeVector<DirectLight>> direct;  // per lamp of the capture; empty where unused
    std::vector<LampSet> lamp_sets;                // distinct sets of lamps, point into direct
};

[[nodiscard]] SceneView view_scene(const Capture& capture,
                                   const Surface& surface,
                                   Progress& progress);

struct LookCount {
    std::size_t rows = 0;
    std::size_t terms = 0;

    LookCount& operator+=(const LookCount& other) {
        rows += other.rows;
        terms += other.terms;
        return *this;
    }
};

// At most so many looks come of it, whatever the images show.
[[nodiscard]] LookCount count_looks(const Capture& capture,
                                    const SceneView& scene,
                                    const ObservationOptions& options);

// Images that are decoded and sampled side by side: decoding one is the work of one thread.
inline constexpr std::size_t kImagesAtOnce = 2;

// Reads the used shots' images. Throws Error when no texel is seen at all.
[[nodiscard]] Observations collect_observations(const Capture& capture,
                                                const SceneView& scene,
                                                const ObservationOptions& options,
                                                Progress& progress);

}  // namespace patina
