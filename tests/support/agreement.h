// How far the methods agree: their maps with each other, and the light that each finds with the
// path tracer's.
#pragma once

#include "patina/base/parallel.h"
#include "patina/base/random.h"
#include "patina/estimate/gather_engine.h"
#include "patina/transport/path_tracer.h"

#include <cmath>
#include <span>
#include <vector>

namespace patina {

// Differences of two estimates of the same values over the standard errors of those differences.
struct Scores {
    double beyond = 0;  // |z| > 1.96
    double sum = 0;     // of z
    double count = 0;

    void add(double a, double b, double error_a, double error_b) {
        const double deviation = std::hypot(error_a, error_b);
        if (!std::isfinite(deviation) || deviation <= 0) return;
        beyond += std::abs(a - b) > 1.96 * deviation;
        sum += (a - b) / deviation;
        count += 1;
    }
};

// Irradiance in green, summed over texels under one lamp set each.
struct LightSum {
    double value = 0;
    double variance = 0;

    LightSum& operator+=(const LightSum& other) {
        value += other.value;
        variance += other.variance;
        return *this;
    }
};

// All of the light that an engine finds under `maps` against all of the path tracer's under the
// same maps: every `stride`-th texel, the lamp sets by turns.
class PathTracerCheck {
  public:
    PathTracerCheck(const Capture& capture, std::span<const Reflectance> maps, std::size_t stride)
        : capture_(capture),
          maps_(maps),
          stride_(stride),
          tracer_(capture.mesh),
          scene_(view_scene(capture, surface_, progress_)),
          field_(ReflectanceField::per_texel(capture.mesh, capture.atlas, maps)) {}

    // As if the paths were independent; Sobol's are better spread.
    [[nodiscard]] LightSum traced() const {
        std::vector<LightSum> texels((maps_.size() + stride_ - 1) / stride_);
        parallel_for(texels.size(), [&](std::size_t i) { texels[i] = trace(i * stride_, set(i)); });
        return sum(texels);
    }

    // The variance is that of the two halves.
    [[nodiscard]] LightSum found(const EstimateOptions& options) {
        if (options.method == Method::gather) {
            GatherEngine engine(surface_, capture_.atlas, scene_, options, progress_);
            return evaluate(engine, kBounces);
        }
        PhotonEngine engine(surface_, capture_.atlas, scene_, options, progress_);
        return evaluate(engine, 1);
    }

  private:
    static constexpr int kPaths = 64;
    static constexpr int kBounces = 40;  // light that has bounced more often does not count

    [[nodiscard]] std::size_t set(std::size_t number) const {
        return number % scene_.lamp_sets.size();
    }

    [[nodiscard]] static LightSum sum(std::span<const LightSum> texels) {
        LightSum sum;
        for (const LightSum& texel : texels) sum += texel;
        return sum;
    }

    [[nodiscard]] LightSum trace(std::size_t texel, std::size_t set) const {
        std::vector<Light> lights;
        for (const std::size_t light : scene_.lamp_sets[set].indices) {
            lights.push_back(*scene_.lights[light]);
        }
        const Texel& place = capture_.atlas.texels[texel];
        double sum = 0;
        double squares = 0;
        for (std::uint32_t path = 0; path < kPaths; ++path) {
            SobolSampler numbers(7, Pass::tests, texel, path);
            const double sample = trace_indirect_irradiance(
                surface_, field_, lights, place.azimuth, place.point, {}, numbers)[1];
            sum += sample;
            squares += square(sample);
        }
        const double mean = sum / kPaths;
        return {mean, std::max(0.0, squares / kPaths - square(mean)) / kPaths};
    }

    [[nodiscard]] LightSum evaluate(IndirectEngine& engine, int turns) const {
        const std::vector<std::uint8_t> nowhere(maps_.size(), 0);
        IndirectLight light;
        for (int turn = 0; turn < turns; ++turn) light = engine.evaluate(maps_, nowhere, true);
        LightSum sum;
        for (std::size_t i = 0; i * stride_ < maps_.size(); ++i) {
            const IndirectIrradiance& irradiance = light.irradiance.of(i * stride_)[set(i)];
            sum += {irradiance.mean()[1], irradiance.variance()[1]};
        }
        return sum;
    }

    const Capture& capture_;
    std::span<const Reflectance> maps_;
    std::size_t stride_;
    Progress progress_;
    Tracer tracer_;
    Surface surface_{&capture_.mesh, &tracer_};
    SceneView scene_;
    ReflectanceField field_;
};

}  // namespace patina
