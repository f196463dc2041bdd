#include "patina/scan/sensor.h"

#include "patina/math/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace patina {
namespace {

constexpr int kSide = 128;

TEST(Sensor, NoiseHasTheStatedVariance) {
    const double value = 0.5;
    Image image(kSide, kSide, 3, float(value));
    add_noise({0.02, 0.001}, Image(kSide, kSide, 1, 1), 7, 3, image);
    const std::vector<double> samples(image.data.begin(), image.data.end());
    const Moments found = moments(samples);
    const double variance = 0.02 * 0.02 + 0.001 * value;
    const double count = double(samples.size());
    // False-alarm rate 1e-5 each, two-sided; the variance of a variance is 2 v^2 / n.
    const double z = normal_quantile(1 - 0.5e-5);
    EXPECT_NEAR(found.mean, value, z * std::sqrt(variance / count));
    EXPECT_NEAR(found.variance, variance, z * variance * std::sqrt(2 / count));
}

TEST(Sensor, WhatIsNotSeenStaysBlack) {
    Image image(4, 4, 3);
    add_noise({0.1, 0}, Image(4, 4, 1, 0), 1, 0, image);
    for (const float value : image.data) EXPECT_EQ(value, 0);
}

TEST(Sensor, StreamsAreIndependent) {
    Image first(kSide, kSide, 1);
    Image second(kSide, kSide, 1);
    add_noise({1, 0}, Image(kSide, kSide, 1, 1), 1, 0, first);
    add_noise({1, 0}, Image(kSide, kSide, 1, 1), 1, 1, second);
    double product = 0;
    for (std::size_t i = 0; i < first.data.size(); ++i) {
        product += double(first.data[i]) * double(second.data[i]);
    }
    const double count = double(first.data.size());
    EXPECT_LT(std::abs(product), normal_quantile(1 - 0.5e-5) * std::sqrt(count));
}

TEST(Sensor, FloatImagesAreNeitherScaledNorRounded) {
    EXPECT_EQ(sensor_exposure(0), 1);
    EXPECT_EQ(rounding_stddev(0), 0);
    EXPECT_DOUBLE_EQ(rounding_stddev(8), 1.0 / 255 / std::sqrt(12.0));
}

}  // namespace
}  // namespace patina
