#include "patina/estimate/observations.h"

#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/estimate/lobe_spread.h"
#include "patina/math/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <map>
#include <numeric>

namespace patina {
namespace {

enum class LookQuality : std::uint8_t { none, poor, good };

using Samples = std::vector<LargeVector<TexelSample>>;  // per used shot, per texel

// How one shot looks at one texel, before the radiance is read.
struct Look {
    LookQuality quality = LookQuality::none;
    bool seen = false;
};

class ObservationBuilder {
  public:
    ObservationBuilder(const Capture& capture,
                       const SceneView& scene,
                       const ObservationOptions& options)
        : capture_(capture),
          scene_(scene),
          min_cos_i_(std::cos(options.max_light_angle)),
          min_cos_v_(std::cos(options.max_view_angle)) {}

    [[nodiscard]] Look look(std::size_t shot, std::size_t texel) const {
        const TexelView& view = scene_.views[scene_.camera_of_shot[shot]][texel];
        if (view.state == ViewState::hidden || view.cos_v < min_cos_v_) return {};
        bool lit = false;
        bool edge = view.state == ViewState::edge;
        for (const auto* direct : scene_.lamp_sets[scene_.lamp_set_of_shot[shot]].direct) {
            const DirectLight& light = (*direct)[texel];
            if (light.state == ShadowState::edge) edge = true;
            if (light.irradiance.maxCoeff() > 0 && light.cos_i >= min_cos_i_) lit = true;
        }
        if (!lit) return {};
        return {edge ? LookQuality::poor : LookQuality::good, true};
    }

    // The looks at a texel are those of one quality.
    [[nodiscard]] LookCount count(std::size_t texel) const {
        LookCount poor;
        LookCount good;
        for (std::size_t shot = 0; shot < scene_.shots.size(); ++shot) {
            const LookQuality quality = look(shot, texel).quality;
            if (quality == LookQuality::none) continue;
            LookCount& of_quality = quality == LookQuality::good ? good : poor;
            ++of_quality.rows;
            of_quality.terms += num_terms(shot, texel);
        }
        return {std::max(poor.rows, good.rows), std::max(poor.terms, good.terms)};
    }

    // The shots whose looks at a texel are taken: those of the best quality that it has.
    void choose(std::size_t texel, const Samples& samples, std::vector<std::size_t>& shots) const {
        LookQuality best = LookQuality::none;
        shots.clear();
        for (std::size_t shot = 0; shot < scene_.shots.size(); ++shot) {
            if (!samples[shot][texel].usable) continue;
            const LookQuality quality = look(shot, texel).quality;
            if (quality == LookQuality::none || quality < best) continue;
            if (quality > best) shots.clear();
            best = quality;
            shots.push_back(shot);
        }
    }

    [[nodiscard]] bool is_seen(std::size_t texel) const {
        for (std::size_t shot = 0; shot < scene_.shots.size(); ++shot) {
            if (look(shot, texel).seen) return true;
        }
        return false;
    }

    // Lamps of a shot that shine on a texel.
    [[nodiscard]] std::size_t num_terms(std::size_t shot, std::size_t texel) const {
        const LampSet& lamps = scene_.lamp_sets[scene_.lamp_set_of_shot[shot]];
        return std::size_t(
            std::count_if(lamps.direct.begin(), lamps.direct.end(), [&](const auto* direct) {
                return (*direct)[texel].irradiance.maxCoeff() > 0;
            }));
    }

    // terms: room for num_terms(), which begins at first_term among those of all looks.
    void write(std::size_t shot,
               std::size_t texel,
               const TexelSample& sample,
               std::size_t first_term,
               std::span<LampTerm> terms,
               Observation& row) const {
        const Vec3 normal = capture_.atlas.texels[texel].point.normal;
        const TexelView& view = scene_.views[scene_.camera_of_shot[shot]][texel];
        const Vec3 w_v = view.w_v.cast<double>().normalized();
        row.radiance = sample.radiance;
        row.variance = sample.variance;
        row.shot = static_cast<std::uint32_t>(shot);
        row.first_term = static_cast<std::uint32_t>(first_term);
        row.num_terms = static_cast<std::uint32_t>(terms.size());
        double nearest = square(kPi);
        auto term = terms.begin();
        for (const auto* direct : scene_.lamp_sets[scene_.lamp_set_of_shot[shot]].direct) {
            const DirectLight& light = (*direct)[texel];
            if (light.irradiance.maxCoeff() <= 0) continue;
            term->irradiance = light.irradiance;
            const double theta_r_squared =
                mirror_angle_squared(normal, light.w_i.cast<double>().normalized(), w_v);
            term->theta_r_squared = float(theta_r_squared);
            term->lobe_cosines = float(lobe_cosines(double(light.cos_i), double(view.cos_v)));
            nearest = std::min(nearest, theta_r_squared);
            ++term;
        }
        row.theta_r = float(std::sqrt(nearest));
    }

  private:
    const Capture& capture_;
    const SceneView& scene_;
    double min_cos_i_;
    double min_cos_v_;
};

// Read noise for captures that state none: a share of the bright end of the used samples.
double default_variance(const Samples& samples, double share) {
    std::vector<double> values;
    for (const auto& shot : samples) {
        for (std::size_t i = 0; i < shot.size(); i += 7) {
            if (shot[i].usable) values.push_back(double(shot[i].radiance.maxCoeff()));
        }
    }
    return values.empty() ? 0 : square(share * quantile(std::move(values), 0.99));
}

// Calls read(shot) for every shot, kImagesAtOnce at a time. Of several that fail, what the first
// one threw is passed on, as if they were read in turn.
template <typename Read>
void for_each_shot(std::size_t num_shots, const Read& read) {
    struct Failure {
        std::size_t shot;
        std::exception_ptr exception;
    };
    std::array<Failure, kImagesAtOnce> failures;
    failures.fill({num_shots, nullptr});
    std::atomic<std::size_t> next = 0;
    std::atomic<bool> has_failed = false;
    const auto read_some = [&](std::size_t lane) {
        // All shots before one that fails were begun before it, and are read to their end.
        while (!has_failed) {
            const std::size_t shot = next++;
            if (shot >= num_shots) return;
            try {
                read(shot);
            } catch (...) {
                failures[lane] = {shot, std::current_exception()};
                has_failed = true;
            }
        }
    };
    parallel_for(kImagesAtOnce, read_some, 1);
    const Failure& first =
        *std::min_element(failures.begin(), failures.end(), [](const Failure& a, const Failure& b) {
            return a.shot < b.shot;
        });
    if (first.exception) std::rethrow_exception(first.exception);
}

void add_noise_model(const ObservationOptions& options,
                     double read_variance,
                     Observations& result) {
    const auto tau = float(options.calibration_stddev);
    parallel_for(result.rows.size(), [&](std::size_t i) {
        Observation& row = result.rows[i];
        row.variance += float(read_variance) + (tau * row.radiance).square();
    });
}

}  // namespace

SceneView view_scene(const Capture& capture, const Surface& surface, Progress& progress) {
    const CaptureDescription& description = capture.description;
    SceneView scene;
    std::map<std::size_t, std::size_t> view_of_camera;
    std::map<std::vector<std::size_t>, std::size_t> set_of_lights;
    for (std::size_t i = 0; i < description.shots.size(); ++i) {
        const Shot& shot = description.shots[i];
        if (shot.heldout) continue;
        scene.shots.push_back(i);
        scene.camera_of_shot.push_back(
            view_of_camera.try_emplace(shot.camera, view_of_camera.size()).first->second);
        scene.lamp_set_of_shot.push_back(
            set_of_lights.try_emplace(shot.lights, set_of_lights.size()).first->second);
    }
    progress.begin_stage("direct light and views");
    scene.views.resize(view_of_camera.size());
    double pixel_size = 1;
    for (const auto& [camera, view] : view_of_camera) {
        scene.views[view] =
            view_texels(capture.mesh, *surface.tracer, capture.atlas, description.cameras[camera]);
        pixel_size = std::max(
            pixel_size,
            pixel_over_texel(capture.atlas, description.cameras[camera], scene.views[view]));
    }
    // A shadow's edge is as wide as a pixel, where that is larger than a texel.
    const int edge_rings = int(std::ceil(std::clamp(pixel_size, 1.0, 3.0)));
    for (const Light& light : description.lights) scene.lights.push_back(&light);
    scene.direct.resize(description.lights.size());
    scene.lamp_sets.resize(set_of_lights.size());
    for (const auto& [lights, set] : set_of_lights) {
        for (const std::size_t light : lights) {
            if (scene.direct[light].empty()) {
                scene.direct[light] =
                    direct_light(surface, capture.atlas, description.lights[light], edge_rings);
            }
            LampSet& lamps = scene.lamp_sets[set];
            lamps.indices.push_back(light);
            lamps.lights.push_back(&description.lights[light]);
            lamps.direct.push_back(&scene.direct[light]);
            if (description.lights[light].frame == FrameOfReference::scanner) {
                lamps.turns_with_scanner = true;
            }
        }
    }
    progress.end_stage(fmt::format("{} texels, {} cameras, {} sets of lamps",
                                   capture.atlas.texels.size(),
                                   scene.views.size(),
                                   scene.lamp_sets.size()));
    return scene;
}

LookCount count_looks(const Capture& capture,
                      const SceneView& scene,
                      const ObservationOptions& options) {
    const ObservationBuilder builder(capture, scene, options);
    return ordered_reduce(capture.atlas.texels.size(), LookCount(), [&](std::size_t texel) {
        return builder.count(texel);
    });
}

Observations collect_observations(const Capture& capture,
                                  const SceneView& scene,
                                  const ObservationOptions& options,
                                  Progress& progress) {
    const std::size_t num_texels = capture.atlas.texels.size();
    const std::size_t num_shots = scene.shots.size();
    progress.begin_stage("reading images", num_shots, "images");
    Samples samples(num_shots);
    const bool need_gradients = capture.description.geometry.registration_stddev > 0;
    std::vector<std::vector<SampleGradient>> gradients(need_gradients ? num_shots : 0);
    for_each_shot(num_shots, [&](std::size_t shot) {
        const RadianceImage image = load_radiance(capture.description, scene.shots[shot]);
        const std::vector<TexelView>& views = scene.views[scene.camera_of_shot[shot]];
        samples[shot] = sample_shot(image, views);
        if (need_gradients) gradients[shot] = sample_gradients(image, views);
        progress.advance(1);
    });
    const ObservationBuilder builder(capture, scene, options);
    Observations result;
    result.seen.assign(num_texels, 0);
    result.begin.assign(num_texels + 1, 0);
    std::vector<std::uint32_t> first_term(num_texels + 1, 0);
    parallel_blocks(num_texels, kParallelBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<std::size_t> shots;
        for (std::size_t texel = begin; texel < end; ++texel) {
            result.seen[texel] = builder.is_seen(texel) ? 1 : 0;
            builder.choose(texel, samples, shots);
            result.begin[texel + 1] = static_cast<std::uint32_t>(shots.size());
            for (const std::size_t shot : shots) {
                first_term[texel + 1] += static_cast<std::uint32_t>(builder.num_terms(shot, texel));
            }
        }
    });
    std::partial_sum(result.begin.begin(), result.begin.end(), result.begin.begin());
    std::partial_sum(first_term.begin(), first_term.end(), first_term.begin());
    result.rows.resize(result.begin.back());
    result.terms.resize(first_term.back());
    if (need_gradients) result.gradients.resize(result.rows.size());
    parallel_blocks(num_texels, kParallelBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<std::size_t> shots;
        for (std::size_t texel = begin; texel < end; ++texel) {
            builder.choose(texel, samples, shots);
            std::size_t row = result.begin[texel];
            std::size_t term = first_term[texel];
            for (const std::size_t shot : shots) {
                const std::size_t num_terms = builder.num_terms(shot, texel);
                builder.write(shot,
                              texel,
                              samples[shot][texel],
                              term,
                              std::span(result.terms).subspan(term, num_terms),
                              result.rows[row]);
                if (need_gradients) result.gradients[row] = gradients[shot][texel];
                term += num_terms;
                ++row;
            }
        }
    });
    if (result.rows.empty()) {
        throw Error(capture.description.file.string(),
                    "shots",
                    "no shot shows a lit part of the surface",
                    "cameras and lamps in front of the object");
    }
    const double read_variance = capture.description.radiometry.has_noise
                                     ? 0.0
                                     : default_variance(samples, options.default_read_stddev);
    add_noise_model(options, read_variance, result);
    spread_over_footprints(capture, scene, result);
    progress.end_stage(
        fmt::format("{} shots, {:.1f} looks per seen texel",
                    num_shots,
                    double(result.rows.size()) /
                        double(std::max<std::ptrdiff_t>(
                            1, std::count(result.seen.begin(), result.seen.end(), 1)))));
    return result;
}

void divide_radiances(double factor, Observations& observations) {
    const auto share = float(1 / factor);
    for (Observation& look : observations.rows) {
        look.radiance *= share;
        look.variance *= square(share);
    }
    for (SampleGradient& gradient : observations.gradients) {
        for (Rgbf& axis : gradient) axis *= share;
    }
}

}  // namespace patina
