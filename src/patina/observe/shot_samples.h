// The radiance that one shot shows of every texel.
#pragma once

#include "patina/base/large_vector.h"
#include "patina/capture/capture.h"
#include "patina/observe/camera_view.h"

#include <array>
#include <vector>

namespace patina {

// What one shot says of one texel.
struct TexelSample {
    Rgbf radiance = Rgbf::Zero();  // [radiance]
    Rgbf variance = Rgbf::Zero();  // of radiance, from the stated read and shot noise [radiance^2]
    bool usable = false;  // seen, and no pixel of the footprint masked, saturated or not a number
};

// Change of a sample's radiance per pixel along x and along y of the image [radiance / pixel].
using SampleGradient = std::array<Rgbf, 2>;

// views: of the shot's camera. Bilinear between pixel centres. One entry per texel.
[[nodiscard]] LargeVector<TexelSample> sample_shot(const RadianceImage& image,
                                                   const std::vector<TexelView>& views);

// Over a pixel about each sample; zero where a pixel that it needs is not usable.
[[nodiscard]] std::vector<SampleGradient> sample_gradients(const RadianceImage& image,
                                                           const std::vector<TexelView>& views);

}  // namespace patina
