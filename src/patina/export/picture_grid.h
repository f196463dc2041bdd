// Pictures in rows and columns with their names, and maps of labels as shares.
#pragma once

#include "patina/export/picture.h"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace patina {

// sRGB of a value.
using Color = std::function<Rgb(double)>;
// sequential_color() from low to high, low < high.
[[nodiscard]] Color sequential(double low, double high);

// Above a column, or before a row.
[[nodiscard]] std::string head_cell(std::string_view title, std::string_view note);
[[nodiscard]] std::string name_cell(std::string_view name, std::string_view note = "");

// Pictures of maps are reduced to this width: there are many side by side [pixels].
[[nodiscard]] int map_width(int max_picture_width);
inline constexpr double kMaxMapHeight = 200;  // on the page [pixels]

// A column of names and columns of pictures of this shape, none higher than max_height [pixels].
[[nodiscard]] std::string picture_grid(int columns,
                                       const Image& shape,
                                       double max_height,
                                       const std::string& cells);

// A value of a map of labels.
struct ShareLabel {
    int value = 0;
    std::string words;
    Rgb color = Rgb::Zero();
};
// map: one channel; must outlive the call; may be empty.
struct LabelledMap {
    std::string name;
    const Image* map = nullptr;
};
// Which share of the labelled pixels each map has of every label, as a bar and in numbers, with a
// legend. Labels that no map has are left out. Empty when nothing is labelled.
[[nodiscard]] std::string share_bars(const std::vector<ShareLabel>& labels,
                                     const std::vector<LabelledMap>& maps);

}  // namespace patina
