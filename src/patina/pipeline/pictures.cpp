#include "patina/pipeline/pictures.h"

#include "patina/base/check.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

constexpr int kGap = 4;               // between the pictures of a sheet [pixels]
constexpr float kBackground = 0.15f;  // of a sheet [-]

// IEC 61966-2-1, linear to encoded.
float srgb_encode(double linear) {
    const double x = std::clamp(linear, 0.0, 1.0);
    return float(x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
}

// Mean over squares of factor x factor pixels; what is left over at the right and below is cut.
Image reduced(const Image& image, int factor) {
    if (factor == 1) return image;
    Image small(std::max(1, image.width / factor), std::max(1, image.height / factor), 3);
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
            for (int channel = 0; channel < 3; ++channel) {
                double sum = 0;
                int count = 0;
                for (int j = y * factor; j < std::min(image.height, (y + 1) * factor); ++j) {
                    for (int i = x * factor; i < std::min(image.width, (x + 1) * factor); ++i) {
                        sum += double(image.at(i, j, channel));
                        ++count;
                    }
                }
                small.at(x, y, channel) = float(sum / count);
            }
        }
    }
    return small;
}

void paste(const Image& picture, int left, int top, Image& sheet) {
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            for (int channel = 0; channel < 3; ++channel) {
                sheet.at(left + x, top + y, channel) = picture.at(x, y, channel);
            }
        }
    }
}

}  // namespace

Image display_picture(const Image& radiance, double white) {
    Image picture(radiance.width, radiance.height, 3);
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            for (int channel = 0; channel < 3; ++channel) {
                const int source = std::min(channel, radiance.channels - 1);
                picture.at(x, y, channel) = srgb_encode(double(radiance.at(x, y, source)) / white);
            }
        }
    }
    return picture;
}

Image difference_picture(const Image& real,
                         const Image& synthetic,
                         std::span<const std::uint8_t> counts,
                         double white) {
    PATINA_CHECK_EQ(real.data.size(), synthetic.data.size());
    Image picture(real.width, real.height, 3);
    for (std::size_t i = 0; i < picture.data.size(); ++i) {
        if (counts[i / 3] == 0) continue;
        const double difference = std::abs(double(synthetic.data[i]) - double(real.data[i]));
        picture.data[i] = float(std::min(1.0, difference / (kDifferenceRange * white)));
    }
    return picture;
}

Image contact_sheet(const std::vector<Image>& pictures, int cell) {
    std::vector<Image> thumbnails;
    int width = 1;
    int height = 1;
    for (const Image& picture : pictures) {
        const int longer = std::max(picture.width, picture.height);
        thumbnails.push_back(reduced(picture, (longer + cell - 1) / cell));
        width = std::max(width, thumbnails.back().width);
        height = std::max(height, thumbnails.back().height);
    }
    const int count = std::max(1, int(thumbnails.size()));
    const int columns = std::max(1, int(std::ceil(std::sqrt(1.5 * count * height / width))));
    const int rows = (count + columns - 1) / columns;
    Image sheet(columns * (width + kGap) + kGap, rows * (height + kGap) + kGap, 3, kBackground);
    for (std::size_t i = 0; i < thumbnails.size(); ++i) {
        const int column = int(i) % columns;
        const int row = int(i) / columns;
        paste(thumbnails[i], kGap + column * (width + kGap), kGap + row * (height + kGap), sheet);
    }
    return sheet;
}

}  // namespace patina
