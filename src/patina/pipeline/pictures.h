// Pictures to look at that belong to no page.
#pragma once

#include "patina/image/image.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace patina {

// Level 255 is a difference of this share of white.
inline constexpr double kDifferenceRange = 0.1;
// |synthetic - real| / (kDifferenceRange white), clamped to [0, 1], linear; black where a pixel
// does not count.
[[nodiscard]] Image difference_picture(const Image& real,
                                       const Image& synthetic,
                                       std::span<const std::uint8_t> counts,
                                       double white);

// sRGB pictures of three channels and any sizes side by side in a grid of about the shape of a
// page, each reduced by a whole factor to at most `cell` pixels in width, on dark grey. At least
// one.
[[nodiscard]] Image contact_sheet(const std::vector<Image>& pictures, int cell);

}  // namespace patina
