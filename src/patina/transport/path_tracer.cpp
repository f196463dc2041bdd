#include "patina/transport/path_tracer.h"

#include "patina/math/warp.h"

#include <algorithm>
#include <optional>

namespace patina {
namespace {

// Largest probability with which roulette lets a path go on, so that each one ends [-].
constexpr double kMaxSurvival = 0.99;

struct Scene {
    const Surface& surface;
    const ReflectanceField& field;
    std::span<const Light> lights;
    double azimuth;
    const PathTracerOptions& options;
    bool has_sky;
};

// The direction in which a path that arrived along -w_o goes on, and what it then carries.
struct Step {
    Vec3 direction;
    Rgb throughput;  // [-]
};

std::optional<Step> reflect(const Reflectance& reflectance,
                            const SurfacePoint& point,
                            const Vec3& w_o,
                            const Rgb& throughput,
                            SobolSampler& sampler) {
    const double choice = sampler.next_pair()[0];
    const LobeSample sample =
        sample_lobe(reflectance, point.normal, w_o, choice, sampler.next_pair());
    if (!(sample.weight > 0).any() || !faces(point, sample.w_o)) return std::nullopt;
    return Step{sample.w_o, throughput * sample.weight};
}

// Ends the path with the probability that its throughput has lost; the survivors make up for it.
bool survives(Rgb& throughput, SobolSampler& sampler) {
    const double probability = std::min(kMaxSurvival, throughput.maxCoeff());
    if (sampler.next_pair()[0] >= probability) return false;
    throughput /= probability;
    return true;
}

// One sample of the radiance that arrives at `point` out of step.direction, times step.throughput.
Rgb arriving_radiance(const Scene& scene, SurfacePoint point, Step step, SobolSampler& sampler) {
    Rgb sum = Rgb::Zero();
    for (int bounces = 0;; ++bounces) {
        const std::optional<RayHit> hit = scene.surface.tracer->intersect(
            scene.surface.tracer->offset(point, step.direction), step.direction);
        if (!hit) return sum + step.throughput * scene.options.sky_radiance;
        if (bounces >= scene.options.max_bounces) return sum;

        point = surface_point(*scene.surface.mesh, hit->triangle, hit->barycentric);
        const Vec3 w_o = -step.direction;
        if (!faces(point, w_o)) return sum;
        const Reflectance reflectance = scene.field.at(hit->triangle, hit->barycentric);
        sum += step.throughput *
               direct_radiance(scene.surface, reflectance, scene.lights, scene.azimuth, point, w_o);

        if (bounces + 1 >= scene.options.max_bounces && !scene.has_sky) return sum;
        const std::optional<Step> next = reflect(reflectance, point, w_o, step.throughput, sampler);
        if (!next) return sum;
        step = *next;
        if (bounces + 1 >= scene.options.roulette_from && !survives(step.throughput, sampler)) {
            return sum;
        }
    }
}

Scene make_scene(const Surface& surface,
                 const ReflectanceField& field,
                 std::span<const Light> lights,
                 double azimuth,
                 const PathTracerOptions& options) {
    return {surface, field, lights, azimuth, options, (options.sky_radiance > 0).any()};
}

}  // namespace

OutgoingRadiance trace_path(const Surface& surface,
                            const ReflectanceField& field,
                            std::span<const Light> lights,
                            double azimuth,
                            const SurfacePoint& point,
                            const Vec3& w_o,
                            const PathTracerOptions& options,
                            SobolSampler& sampler) {
    OutgoingRadiance result;
    if (!faces(point, w_o)) return result;
    const Scene scene = make_scene(surface, field, lights, azimuth, options);
    const Reflectance reflectance = field.at(point.triangle, point.barycentric);
    result.direct = direct_radiance(surface, reflectance, lights, azimuth, point, w_o);
    if (options.max_bounces <= 0 && !scene.has_sky) return result;
    const std::optional<Step> step = reflect(reflectance, point, w_o, Rgb::Ones(), sampler);
    if (step) result.indirect = arriving_radiance(scene, point, *step, sampler);
    return result;
}

Rgb trace_indirect_irradiance(const Surface& surface,
                              const ReflectanceField& field,
                              std::span<const Light> lights,
                              double azimuth,
                              const SurfacePoint& point,
                              const PathTracerOptions& options,
                              SobolSampler& sampler) {
    const Scene scene = make_scene(surface, field, lights, azimuth, options);
    if (options.max_bounces <= 0 && !scene.has_sky) return Rgb::Zero();
    const Vec3 w = Frame(point.normal).to_world(square_to_cosine_hemisphere(sampler.next_pair()));
    if (!faces(point, w)) return Rgb::Zero();
    // The density is cos/pi, so every sample weighs pi.
    return kPi * arriving_radiance(scene, point, {w, Rgb::Ones()}, sampler);
}

}  // namespace patina
