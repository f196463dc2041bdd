// The path tracer: unbiased, slow, obviously right. The oracle of every test of transport, and the
// virtual scanner's renderer.
//
// Based on: Kajiya. The rendering equation. SIGGRAPH 1986. Light sources are sampled at every
// vertex (next-event estimation); point and directional lights can be hit in no other way.
#pragma once

#include "patina/base/random.h"
#include "patina/transport/surface.h"

#include <limits>

namespace patina {

struct PathTracerOptions {
    // Reflections elsewhere, before the point looked at, after which a path is cut; >= 0; 0: light
    // straight from lamps and sky only. By default roulette alone ends a path, and nothing is
    // missing.
    int max_bounces = std::numeric_limits<int>::max();
    int roulette_from = 3;  // reflections before Russian roulette begins; >= 1
    Rgb sky_radiance =
        Rgb::Zero();  // constant radiance of rays that leave the scene [radiance]; for tests
};

// Radiance that leaves a point, split by what the light did before.
struct OutgoingRadiance {
    Rgb direct = Rgb::Zero();  // straight from the lamps [radiance]
    Rgb indirect =
        Rgb::Zero();  // after at least one reflection elsewhere, and from the sky [radiance]
};

// One sample of the radiance that leaves `point` towards w_o (unit, away from the surface). lights:
// all on at once. azimuth [rad]: of the scanner, for lights that turn with it. sampler: one
// element's numbers.
[[nodiscard]] OutgoingRadiance trace_path(const Surface& surface,
                                          const ReflectanceField& field,
                                          std::span<const Light> lights,
                                          double azimuth,
                                          const SurfacePoint& point,
                                          const Vec3& w_o,
                                          const PathTracerOptions& options,
                                          SobolSampler& sampler);

// One sample of the irradiance at `point` that arrives after at least one reflection elsewhere (and
// from the sky) [radiance x sr]. The smooth normal's cosine is used.
[[nodiscard]] Rgb trace_indirect_irradiance(const Surface& surface,
                                            const ReflectanceField& field,
                                            std::span<const Light> lights,
                                            double azimuth,
                                            const SurfacePoint& point,
                                            const PathTracerOptions& options,
                                            SobolSampler& sampler);

}  // namespace patina
