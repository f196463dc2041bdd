// The radiance that one shot shows of every texel.
#pragma once

#include "patina/capture/capture.h"
#include "patina/observe/camera_view.h"

#include <vector>

namespace patina {

// What one shot says of one texel.
struct TexelSample {
    Rgbf radiance = Rgbf::Zero();  // [radiance]
    Rgbf variance = Rgbf::Zero();  // of radiance, from the stated read and shot noise [radiance^2]
    bool usable = false;  // seen, and no pixel of the footprint masked, saturated or not a number
};

// views: of the shot's camera. Bilinear between pixel centres. One entry per texel.
[[nodiscard]] std::vector<TexelSample> sample_shot(const RadianceImage& image,
                                                   const std::vector<TexelView>& views);

}  // namespace patina
