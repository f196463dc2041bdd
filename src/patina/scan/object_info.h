// What the objects are like as tests of the method: highlights that can be seen, light in the
// creases, surface that the scanner misses. docs/objects.md states the numbers.
#pragma once

#include "patina/scan/object.h"
#include "patina/scene/camera.h"
#include "patina/scene/light.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// Share of each panel's texels that show a direct highlight under at least one of the lamps: seen
// by the camera, lit without shadow, theta_r < 2 sigma. One number per panel [-].
[[nodiscard]] std::vector<double> highlight_coverage(const SimulatedObject& object,
                                                     const Camera& camera,
                                                     std::span<const Light> lights);

// Mean curvature from the divergence of the normal over `step` [1/length]: negative where the
// surface is concave, 1/r on a sphere of radius r.
[[nodiscard]] double mean_curvature(const SignedDistance& distance, const Vec3& p, double step);

// Surface of a mean curvature below this is a crease [1/m]: a groove as round as a finger, of
// radius 8 mm.
inline constexpr double kCreaseCurvature = -62.5;
// Over which the curvature is taken [m].
inline constexpr double kCurvatureStep = 0.0005;

struct CreaseLight {
    int num_texels = 0;      // creases among the texels that the camera sees
    double texel_share = 0;  // of the texels seen [-]
    double direct = 0;    // radiance towards the camera straight from the lamp, mean of channels,
                          // texels and lamps
    double indirect = 0;  // the same after at least one reflection elsewhere
};

// Light in the creases of a figurine (B or C), at texels' centres, each lamp on alone.
[[nodiscard]] CreaseLight crease_light(const SimulatedObject& object,
                                       const Camera& camera,
                                       std::span<const Light> lights,
                                       int samples_per_texel,
                                       std::uint64_t seed);

// Share of a figurine's area that the range finder cannot see, its underside left out [-].
[[nodiscard]] double hidden_area_share(const SimulatedObject& object);

// Share of a figurine's area that lies further than `tolerance` [m], along its normal, from the
// surface made of its range image, the underside left out [-]: what is hidden, and what is lost at
// jumps or between pixels.
[[nodiscard]] double missing_area_share(const SimulatedObject& object,
                                        const Mesh& scanned,
                                        double tolerance);

}  // namespace patina
