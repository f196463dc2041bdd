#include "patina/pipeline/pictures.h"

#include "patina/base/check.h"
#include "patina/export/picture.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

constexpr int kGap = 4;               // between the pictures of a sheet [pixels]
constexpr double kSheetShape = 1.5;   // width over height of a sheet, about [-]
constexpr float kBackground = 0.15f;  // of a sheet [-]

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
    PATINA_CHECK(!pictures.empty());
    std::vector<Image> thumbnails;
    int width = 1;
    int height = 1;
    for (const Image& picture : pictures) {
        thumbnails.push_back(reduce({picture, {}}, cell).image);
        width = std::max(width, thumbnails.back().width);
        height = std::max(height, thumbnails.back().height);
    }
    const int count = int(thumbnails.size());
    const int columns = int(std::ceil(std::sqrt(kSheetShape * count * height / width)));
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
