// Pictures inside a page: images reduced, coloured and written as PNG within the HTML.
#pragma once

#include "patina/export/colormap.h"
#include "patina/image/image.h"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace patina {

// Which pixels of an image hold a value; as many as pixels, or empty for all.
using PixelMask = std::vector<std::uint8_t>;

// An image and what of it counts.
struct MaskedImage {
    Image image;
    PixelMask mask;
};

// Averages blocks of whole pixels, those of the mask only, so that the width is at most max_width
// (>= 1). Smaller images stay as they are.
[[nodiscard]] MaskedImage reduce(const MaskedImage& source, int max_width);
// The same for labels: the block's middle pixel.
[[nodiscard]] Image reduce_labels(const Image& labels, int max_width);

// Linear values to sRGB: white (> 0) becomes 1, pixels outside the mask no_value_color(). Channels:
// 3, or 1 for grey.
[[nodiscard]] Image display_image(const MaskedImage& source, double white);

// Colours the first channel: color(value) gives sRGB.
[[nodiscard]] Image colored_image(const MaskedImage& source,
                                  const std::function<Rgb(double)>& color);

[[nodiscard]] std::string base64(std::string_view bytes);

// An <img> element with the PNG inside. srgb: 3 channels in [0, 1]. alternative: plain text.
[[nodiscard]] std::string picture_html(const Image& srgb, std::string_view alternative);

// A horizontal bar of the colours between low and high with ticks and a label with its unit.
// color: of values in [low, high]; low < high.
[[nodiscard]] std::string color_bar(double low,
                                    double high,
                                    std::string_view label,
                                    const std::function<Rgb(double)>& color);

// "#rrggbb".
[[nodiscard]] std::string css_color(const Rgb& srgb);

}  // namespace patina
