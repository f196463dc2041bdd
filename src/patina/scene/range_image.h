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

// The surface: one vertex per measured pixel with measured neighbours, smooth normals pointing away
// from the axis or towards the camera, uv of the pixel's centre in the texel domain of the range
// image's own grid. Neighbours further apart than max_step are not joined. Triangles across the
// seam of a full turn are cut halfway, so that uvs stay in [0,1]^2: one part ends at u = 1, the
// other begins at u = 0. Where all four neighbours of a pixel are joined to it, its normal is that
// of the central differences, with an error of second order in the pixel's size. range: one
// channel. Not measured: what is not finite, and except for orthographic cameras what is not above
// 0.
[[nodiscard]] Mesh mesh_from_range(const RangeFrame& frame, const Image& range);

}  // namespace patina
