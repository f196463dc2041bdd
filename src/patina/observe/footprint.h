// The pixels that a position in an image is read from.
#pragma once

#include "patina/math/types.h"

#include <array>

namespace patina {

// One axis of a bilinear footprint: pixels first and last (equal or adjacent) and the weight of
// last.
struct FootprintAxis {
    int first = 0;
    int last = 0;
    float weight_last = 0;
};

// Pixel centres lie at half-integers; positions within a thousandth of a pixel of a centre read
// that pixel alone (grids that are the image's own), and positions beyond the outermost centres
// read the outermost pixel. size: pixels along the axis.
[[nodiscard]] FootprintAxis footprint_axis(float position, int size);

}  // namespace patina
