#include "patina/observe/shot_samples.h"

#include "patina/observe/footprint.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

// radiance = 1 + 10 x + 100 y at pixel centres, the same in all channels.
RadianceImage ramp(int size) {
    RadianceImage image;
    image.radiance = Image(size, size, 3);
    image.variance = Image(size, size, 3, 0.5f);
    image.usable.assign(std::size_t(size) * std::size_t(size), 1);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            for (int c = 0; c < 3; ++c)
                image.radiance.at(x, y, c) = 1.0f + 10.0f * float(x) + 100.0f * float(y);
        }
    }
    return image;
}

TexelView view_at(float x, float y) {
    TexelView view;
    view.pixel = {x, y};
    view.state = ViewState::clear;
    return view;
}

TEST(Footprint, CentresReadOnePixelAndBordersReadTheOutermost) {
    EXPECT_EQ(footprint_axis(2.5f, 8).first, 2);
    EXPECT_EQ(footprint_axis(2.5f, 8).last, 2);
    EXPECT_EQ(footprint_axis(2.5004f, 8).last, 2);
    const FootprintAxis between = footprint_axis(3.25f, 8);
    EXPECT_EQ(between.first, 2);
    EXPECT_EQ(between.last, 3);
    EXPECT_FLOAT_EQ(between.weight_last, 0.75f);
    EXPECT_EQ(footprint_axis(0.1f, 8).last, 0);
    EXPECT_EQ(footprint_axis(7.9f, 8).first, 7);
}

TEST(ShotSamples, InterpolatesRadianceAndItsVariance) {
    const auto samples = sample_shot(ramp(4), {view_at(1.75f, 2.0f), view_at(1.5f, 1.5f)});
    ASSERT_TRUE(samples[0].usable);
    // x = 1.25 and y = 1.5 in units of centres.
    EXPECT_NEAR(samples[0].radiance[1], 1 + 12.5 + 150, 1e-4);
    EXPECT_NEAR(samples[0].variance[0], 0.5 * (0.75 * 0.75 + 0.25 * 0.25) * 0.5, 1e-6);
    EXPECT_NEAR(samples[1].radiance[2], 111, 1e-4);
    EXPECT_NEAR(samples[1].variance[2], 0.5, 1e-6);
}

TEST(ShotSamples, OneUnusablePixelSpoilsEveryFootprintThatTouchesIt) {
    RadianceImage image = ramp(4);
    image.usable[1 * 4 + 2] = 0;
    const auto samples =
        sample_shot(image, {view_at(2.0f, 1.5f), view_at(1.5f, 1.5f), view_at(2.5f, 2.0f)});
    EXPECT_FALSE(samples[0].usable);
    EXPECT_TRUE(samples[1].usable);
    EXPECT_FALSE(samples[2].usable);
}

TEST(ShotSamples, HiddenTexelsAreNotSampled) {
    TexelView hidden = view_at(1.5f, 1.5f);
    hidden.state = ViewState::hidden;
    EXPECT_FALSE(sample_shot(ramp(4), {hidden})[0].usable);
}

}  // namespace
}  // namespace patina
