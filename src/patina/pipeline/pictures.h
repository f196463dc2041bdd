// Radiance as pictures to look at.
#pragma once

#include "patina/image/image.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace patina {

// Values / white, clamped to [0, 1], in the sRGB curve. radiance: three channels, or one, which
// becomes grey.
[[nodiscard]] Image display_picture(const Image& radiance, double white);

// Level 255 is a difference of this share of white.
inline constexpr double kDifferenceRange = 0.1;
// |synthetic - real| / (kDifferenceRange white), clamped to [0, 1], linear; black where a pixel
// does not count.
[[nodiscard]] Image difference_picture(const Image& real,
                                       const Image& synthetic,
                                       std::span<const std::uint8_t> counts,
                                       double white);

// Pictures of equal or different sizes side by side in a grid of about the shape of a page, each
// reduced by whole factors to at most `cell` pixels across, on dark grey.
[[nodiscard]] Image contact_sheet(const std::vector<Image>& pictures, int cell);

}  // namespace patina
