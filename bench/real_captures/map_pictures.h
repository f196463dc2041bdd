// Maps in the texel domain as PNG pictures with a bar of their colours on the right.
#pragma once

#include "patina/scene/atlas.h"

#include "method_run.h"
#include <filesystem>
#include <functional>
#include <string>

namespace patina {

// What the colours of a picture stand for; the bar's lower end is low.
struct ColorRange {
    double low = 0;
    double high = 1;
    std::string text;  // "0 to 1.2 rad"
};

// The upper end of a bar from 0: where most of the values lie, rounded up to one digit. values of
// the texels that are given.
[[nodiscard]] ColorRange range_from_zero(const TexelAtlas& atlas,
                                         const std::function<bool(TexelId)>& counts,
                                         const std::function<double(TexelId)>& value);

// Texels that do not count are grey.
void write_map_picture(const std::filesystem::path& path,
                       const TexelAtlas& atlas,
                       const ColorRange& range,
                       const std::function<bool(TexelId)>& counts,
                       const std::function<double(TexelId)>& value);

// A ratio about 1, on a bar from 1/1.5 (blue) to 1.5 (red-brown).
[[nodiscard]] ColorRange ratio_range();
void write_ratio_picture(const std::filesystem::path& path,
                         const TexelAtlas& atlas,
                         const std::function<bool(TexelId)>& counts,
                         const std::function<double(TexelId)>& ratio);

// The colours of status 1, 2 and 3; the bar shows 1 at its top.
void write_status_picture(const std::filesystem::path& path,
                          const TexelAtlas& atlas,
                          const Estimate& estimate);

}  // namespace patina
