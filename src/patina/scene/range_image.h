// Range images (cylindrical, and depth of a camera) as surfaces.
#pragma once

#include "patina/image/image.h"
#include "patina/scene/camera.h"
#include "patina/scene/mesh.h"

#include <optional>

namespace patina {

enum class RangeProjection { cylindrical, camera };

// How the pixels of a range image lie in space.
struct RangeFrame {
    RangeProjection projection = RangeProjection::cylindrical;
    double azimuth_begin = 0;        // a0 [rad], cylindrical
    double azimuth_end = 2 * kPi;    // a1 [rad], cylindrical; a full turn wraps around
    double height_begin = 0;         // y0 [length], cylindrical
    double height_end = 1;           // y1 [length], cylindrical
    Camera camera;                   // for projection camera
    std::optional<double> max_step;  // [length]; default: 4 x the median distance of neighbours

    [[nodiscard]] bool wraps_around() const;
};

// Azimuth of the centre of a column of a cylindrical range image [rad].
[[nodiscard]] double column_azimuth(const RangeFrame& frame, int width, double column);

// The surface: one vertex per measured pixel, smooth normals pointing away from the axis or towards
// the camera, uv of the pixel's centre in the texel domain of the range image's own grid. Neighbours
// further apart than max_step are not joined. range: one channel; NaN (and 0 where the format says so)
// is not measured.
[[nodiscard]] Mesh mesh_from_range(const RangeFrame& frame, const Image& range);

}  // namespace patina
