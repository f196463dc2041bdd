// A mesh of one material under lamps, ready to be traced, and the mean of a random quantity over
// it.
#pragma once

#include "patina/base/parallel.h"
#include "patina/base/random.h"
#include "patina/transport/surface.h"

#include "support/false_alarms.h"
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace patina {

[[nodiscard]] inline Light point_light(const Vec3& position, double intensity) {
    Light light;
    light.position = position;
    light.intensity = Rgb::Constant(intensity);
    return light;
}

// to_light: unit.
[[nodiscard]] inline Light directional_light(const Vec3& to_light, double irradiance) {
    Light light;
    light.type = LightType::directional;
    light.direction = to_light;
    light.irradiance = Rgb::Constant(irradiance);
    return light;
}

[[nodiscard]] inline Reflectance lambertian(double albedo) {
    return {Rgb::Constant(albedo), 0, 0.2};
}

struct LitScene {
    LitScene(Mesh scene_mesh, const Reflectance& material, std::vector<Light> scene_lights)
        : mesh(std::move(scene_mesh)),
          tracer(mesh),
          vertices(mesh.positions.size(), material),
          lights(std::move(scene_lights)) {}

    [[nodiscard]] Surface surface() const { return {&mesh, &tracer}; }
    [[nodiscard]] ReflectanceField field() const {
        return ReflectanceField::per_vertex(mesh, vertices);
    }

    Mesh mesh;
    Tracer tracer;
    std::vector<Reflectance> vertices;
    std::vector<Light> lights;
};

// Mean of sample(SobolSampler&) -> double over num_randomisations x samples_each samples; the
// standard error is that of the independent randomisations, so what Sobol's order gains within each
// counts.
template <typename Sample>
[[nodiscard]] SampleMean randomised_mean(std::size_t num_randomisations,
                                         std::uint32_t samples_each,
                                         std::uint64_t seed,
                                         const Sample& sample) {
    std::vector<double> means(num_randomisations, 0.0);
    parallel_for(
        num_randomisations,
        [&](std::size_t i) {
            for (std::uint32_t j = 0; j < samples_each; ++j) {
                SobolSampler sampler(seed, Pass::tests, i, j);
                means[i] += sample(sampler) / samples_each;
            }
        },
        1);
    return estimate_of(means);
}

}  // namespace patina
