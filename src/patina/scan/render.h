// Images of an object as a registered camera takes them: path tracing over the object's own fine
// mesh.
#pragma once

#include "patina/base/progress.h"
#include "patina/image/image.h"
#include "patina/scan/object.h"
#include "patina/scene/camera.h"
#include "patina/scene/light.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

struct RenderOptions {
    int samples_per_pixel = 256;  // paths per pixel and lamp; >= 1; powers of two are best
    // So many in the mean, shared out by plan_paths() for an image as free of noise as they allow,
    // where they are worth a pilot.
    bool adaptive = false;
    Vec2 image_shift = Vec2::Zero();  // what a pixel sees lies this far from it [pixels]
    std::uint64_t seed = 1;
    std::uint32_t camera_index =
        0;  // cameras and lamps of different numbers share no random numbers;
    std::vector<std::uint32_t> lamp_numbers;  // one per lamp, each below kMaxLampNumber
};
inline constexpr std::uint32_t kMaxLampNumber = 63;

struct RenderedImages {
    std::vector<Image> radiance;  // per lamp; three channels [radiance]; 0 where `seen` is
    Image seen;  // one channel: 1 where at least half of the pixel's samples see the surface
};

// One image per lamp, each with that lamp alone on. A pixel is the mean over samples spread over
// its footprint (for a cylindrical scan: azimuth and height, the camera and the lamps standing at
// the azimuth of the pixel's column); samples that miss the object or are hidden from the camera do
// not count. The ray to the surface and the camera's view of it are shared by the lamps, the light
// is sampled for each lamp on its own, so that the noise of the images is independent given the
// footprint. The same bytes for any number of threads. Throws Interrupted.
[[nodiscard]] RenderedImages render_lamps(const SimulatedObject& object,
                                          const Camera& camera,
                                          std::span<const Light> lights,
                                          const RenderOptions& options,
                                          Progress& progress);

// Whether nothing lies between the point and the camera, and the point has its front to it.
[[nodiscard]] bool is_seen(const SimulatedObject& object,
                           const Camera& camera,
                           const SurfacePoint& point,
                           double azimuth);

// Azimuth of the scanner for a column of the texel domain [rad]; 0 unless the object is scanned
// cylindrically.
[[nodiscard]] double scanner_azimuth(const SimulatedObject& object, int columns, int column);

}  // namespace patina
