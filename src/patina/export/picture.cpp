#include "patina/export/picture.h"

#include "patina/base/parallel.h"
#include "patina/export/html_page.h"
#include "patina/export/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// Smaller pictures show their pixels as squares.
constexpr int kCoarseWidth = 200;

bool counts(const PixelMask& mask, std::size_t pixel) { return mask.empty() || mask[pixel] != 0; }

// Whole pixels per block.
int block_size(int width, int max_width) { return (width + max_width - 1) / max_width; }

// Averages one block of source into pixel (x, y) of target.
void average_block(const MaskedImage& source, int block, int x, int y, MaskedImage& target) {
    const Image& from = source.image;
    std::vector<double> sums(std::size_t(from.channels), 0.0);
    int count = 0;
    for (int v = y * block; v < std::min((y + 1) * block, from.height); ++v) {
        for (int u = x * block; u < std::min((x + 1) * block, from.width); ++u) {
            const std::size_t pixel = std::size_t(v) * std::size_t(from.width) + std::size_t(u);
            if (!counts(source.mask, pixel)) continue;
            for (int c = 0; c < from.channels; ++c) sums[std::size_t(c)] += from.at(u, v, c);
            ++count;
        }
    }
    const std::size_t pixel = std::size_t(y) * std::size_t(target.image.width) + std::size_t(x);
    target.mask[pixel] = std::uint8_t(count > 0);
    for (int c = 0; c < from.channels && count > 0; ++c) {
        target.image.at(x, y, c) = float(sums[std::size_t(c)] / count);
    }
}

// Calls color(pixel index, rgb) for every pixel of the mask.
Image paint(const MaskedImage& source, const std::function<Rgb(std::size_t)>& color) {
    Image result(source.image.width, source.image.height, 3);
    const std::size_t num_pixels = result.data.size() / 3;
    parallel_for(num_pixels, [&](std::size_t i) {
        const Rgb rgb = counts(source.mask, i) ? color(i) : no_value_color();
        for (std::size_t c = 0; c < 3; ++c) result.data[3 * i + c] = float(rgb[int(c)]);
    });
    return result;
}

}  // namespace

MaskedImage reduce(const MaskedImage& source, int max_width) {
    const int block = block_size(source.image.width, max_width);
    if (block <= 1) return source;
    MaskedImage result;
    result.image = Image((source.image.width + block - 1) / block,
                         (source.image.height + block - 1) / block,
                         source.image.channels);
    result.mask.assign(std::size_t(result.image.width) * std::size_t(result.image.height), 0);
    for (int y = 0; y < result.image.height; ++y) {
        for (int x = 0; x < result.image.width; ++x) average_block(source, block, x, y, result);
    }
    return result;
}

Image reduce_labels(const Image& labels, int max_width) {
    const int block = block_size(labels.width, max_width);
    if (block <= 1) return labels;
    Image result((labels.width + block - 1) / block, (labels.height + block - 1) / block, 1);
    for (int y = 0; y < result.height; ++y) {
        for (int x = 0; x < result.width; ++x) {
            result.at(x, y) = labels.at(std::min(x * block + block / 2, labels.width - 1),
                                        std::min(y * block + block / 2, labels.height - 1));
        }
    }
    return result;
}

Image display_image(const MaskedImage& source, double white) {
    const std::size_t channels = std::size_t(source.image.channels);
    return paint(source, [&](std::size_t i) {
        Rgb rgb;
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = source.image.data[i * channels + std::min(c, channels - 1)];
            rgb[int(c)] = srgb_from_linear(double(value) / white);
        }
        return rgb;
    });
}

Image colored_image(const MaskedImage& source, const std::function<Rgb(double)>& color) {
    const std::size_t channels = std::size_t(source.image.channels);
    return paint(source,
                 [&](std::size_t i) { return color(double(source.image.data[i * channels])); });
}

std::string base64(std::string_view bytes) {
    static constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto byte = i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : std::uint8_t(0);
            group = (group << 8) | byte;
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const bool is_padding = i + k > bytes.size();
            text += is_padding ? '=' : kDigits[(group >> (18 - 6 * k)) & 63];
        }
    }
    return text;
}

std::string picture_html(const Image& srgb, std::string_view alternative) {
    return fmt::format(
        "<img{} width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">",
        srgb.width < kCoarseWidth ? " class=\"coarse\"" : "",
        srgb.width,
        srgb.height,
        escape_html(alternative),
        base64(encode_png(srgb)));
}

std::string css_color(const Rgb& srgb) {
    std::string text = "#";
    for (int c = 0; c < 3; ++c) {
        text += fmt::format("{:02x}", int(std::lround(255 * std::clamp(srgb[c], 0.0, 1.0))));
    }
    return text;
}

std::string color_bar(double low,
                      double high,
                      std::string_view label,
                      const std::function<Rgb(double)>& color) {
    constexpr int kSteps = 48;
    constexpr double kWidth = 192;
    constexpr double kInset = 12;
    constexpr int kMaxTicks = 5;
    std::string svg = fmt::format(
        "<svg class=\"bar\" width=\"216\" height=\"44\" viewBox=\"0 0 216 44\" role=\"img\" "
        "aria-label=\"{0}\"><text x=\"{1}\" y=\"11\">{0}</text>",
        escape_html(label),
        kInset);
    for (int i = 0; i < kSteps; ++i) {
        svg +=
            fmt::format("<rect x=\"{:.1f}\" y=\"16\" width=\"{:.1f}\" height=\"10\" fill=\"{}\"/>",
                        kInset + kWidth * i / kSteps,
                        // Neighbours overlap, or seams would show.
                        kWidth / kSteps + (i + 1 < kSteps ? 1 : 0),
                        css_color(color(low + (high - low) * (i + 0.5) / kSteps)));
    }
    const std::vector<double> ticks = linear_ticks(low, high, kMaxTicks);
    const std::vector<std::string> labels = tick_labels(ticks);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const double x = kInset + kWidth * (ticks[i] - low) / (high - low);
        svg += fmt::format(
            "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"26\" y2=\"30\" class=\"frame\"/>"
            "<text x=\"{0:.1f}\" y=\"41\" class=\"tick\" text-anchor=\"middle\">{1}</text>",
            x,
            labels[i]);
    }
    return svg + "</svg>";
}

}  // namespace patina
