// Colours for numbers. Lightness runs linearly in OKLab, so equal steps look equal, also in grey.
//
// Based on: Ottosson. A perceptual color space for image processing. 2020 (OKLab).
#pragma once

#include "patina/capture/lobe_reason.h"
#include "patina/math/types.h"

namespace patina {

// OKLab lightness of an sRGB colour in [0, 1]^3 [-].
[[nodiscard]] double perceived_lightness(const Rgb& srgb);

// t in [0, 1], clamped: from dark violet over teal to light yellow. sRGB in [0, 1]^3.
[[nodiscard]] Rgb sequential_color(double t);

// t in [-1, 1], clamped: blue below 0, near-white at 0, red-brown above; equally dark at both ends.
// sRGB in [0, 1]^3.
[[nodiscard]] Rgb diverging_color(double t);

// What a texel of this status is drawn in, 0 (off the surface) to 3; told apart by lightness too.
[[nodiscard]] Rgb status_color(int status);

// What a texel is drawn in by what is known of its lobe; told apart by lightness too.
[[nodiscard]] Rgb lobe_reason_color(LobeReason reason);

// Where nothing is known, or the surface is not: a middle grey. sRGB.
[[nodiscard]] Rgb no_value_color();

// Linear light to sRGB, clamped to [0, 1]. IEC 61966-2-1.
[[nodiscard]] double srgb_from_linear(double linear);

}  // namespace patina
