#include "patina/scan/material.h"

#include "patina/math/statistics.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(Material, FinishIsKeptInTheRangeOfRealMaterials) {
    const Reflectance low = make_reflectance({Rgb::Constant(-1), -1, 0.01});
    EXPECT_DOUBLE_EQ(low.diffuse[0], kObjectMinDiffuse);
    EXPECT_DOUBLE_EQ(low.roughness, kObjectMinRoughness);
    EXPECT_DOUBLE_EQ(low.specular * 2 * square(low.roughness), kObjectMinGloss);
    const Reflectance high = make_reflectance({Rgb::Constant(2), 1, 2});
    EXPECT_DOUBLE_EQ(high.diffuse[2], kObjectMaxDiffuse);
    EXPECT_DOUBLE_EQ(high.roughness, kObjectMaxRoughness);
    EXPECT_DOUBLE_EQ(high.specular * 2 * square(high.roughness), kObjectMaxGloss);
}

TEST(Material, BlendEndsAtItsTwoFinishes) {
    const Finish a{Rgb(0.1, 0.2, 0.3), 0.01, 0.1};
    const Finish b{Rgb(0.7, 0.6, 0.5), 0.03, 0.3};
    EXPECT_DOUBLE_EQ(blend(a, b, -1).gloss, a.gloss);
    EXPECT_DOUBLE_EQ(blend(a, b, 0.5).roughness, 0.2);
    EXPECT_DOUBLE_EQ(blend(a, b, 2).diffuse[0], b.diffuse[0]);
}

TEST(Material, NoiseStaysInRangeAndFillsIt) {
    std::vector<double> values;
    for (int i = 0; i < 4000; ++i) {
        values.push_back(smooth_noise(Vec3(0.37 * i, -0.21 * i, 0.11 * i), 1.0, 3));
    }
    EXPECT_GE(quantile(values, 0), -1);
    EXPECT_LE(quantile(values, 1), 1);
    EXPECT_LT(quantile(values, 0), -0.5);
    EXPECT_GT(quantile(values, 1), 0.5);
}

TEST(Material, NoiseIsContinuousAcrossItsLattice) {
    for (int i = -3; i < 4; ++i) {
        const double before = smooth_noise(Vec3(i - 1e-9, 0.3, 0.7), 1.0, 5);
        const double after = smooth_noise(Vec3(i + 1e-9, 0.3, 0.7), 1.0, 5);
        // The slope is at most 2 x 15/8 per unit of length.
        EXPECT_NEAR(before, after, 1e-8);
    }
}

TEST(Material, FieldsOfDifferentNumbersDiffer) {
    EXPECT_NE(smooth_noise(Vec3(0.4, 0.5, 0.6), 1.0, 1), smooth_noise(Vec3(0.4, 0.5, 0.6), 1.0, 2));
}

}  // namespace
}  // namespace patina
