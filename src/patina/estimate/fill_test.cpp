#include "patina/estimate/fill.h"

#include "patina/scene/atlas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scenes.h"
#include <vector>

namespace patina {
namespace {

using testing::DoubleEq;
using testing::Each;
using testing::Pointwise;

constexpr double kFallback = -7;

TexelAtlas flat_atlas(int width, int height) {
    return build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), width, height);
}

// The values of a full atlas, row by row, a negative one meaning "not measured", and what the fill
// makes of them.
std::vector<double> filled(const TexelAtlas& atlas, std::vector<double> values) {
    std::vector<std::uint8_t> measured(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) measured[i] = values[i] >= 0;
    interpolate_linearly(atlas, measured, kFallback, values);
    return values;
}

TEST(InterpolateLinearly, IsLinearBetweenTwoAndConstantBeyond) {
    EXPECT_THAT(filled(flat_atlas(8, 1), {-1, 1, -1, -1, -1, 3, -1, -1}),
                Pointwise(DoubleEq(), {1.0, 1.0, 1.5, 2.0, 2.5, 3.0, 3.0, 3.0}));
    EXPECT_THAT(filled(flat_atlas(1, 4), {6, -1, -1, 0}),
                Pointwise(DoubleEq(), {6.0, 4.0, 2.0, 0.0}));
}

TEST(InterpolateLinearly, WeightsRowAndColumnByInverseDistance) {
    const std::vector<double> values = filled(flat_atlas(4, 3),
                                              {-1,
                                               5,
                                               -1,
                                               -1,  //
                                               1,
                                               -1,
                                               -1,
                                               4,  //
                                               -1,
                                               -1,
                                               -1,
                                               -1});
    // Row: 1 at distance 1 and 4 at distance 2; column: 5 at distance 1, nothing below.
    EXPECT_DOUBLE_EQ(values[5], (1 / 1.0 + 4 / 2.0 + 5 / 1.0) / (1 / 1.0 + 1 / 2.0 + 1 / 1.0));
}

TEST(InterpolateLinearly, TakesTheNearestMeasuredTexelOfEachSide) {
    EXPECT_DOUBLE_EQ(filled(flat_atlas(5, 1), {9, 1, -1, 2, 9})[2], 1.5);
}

TEST(InterpolateLinearly, KeepsWhatIsMeasured) {
    EXPECT_THAT(filled(flat_atlas(2, 2), {1, 2, 3, 4}),
                Pointwise(DoubleEq(), {1.0, 2.0, 3.0, 4.0}));
}

TEST(InterpolateLinearly, GoesAroundWhereTheAtlasDoes) {
    const std::vector<double> values = {-1, 1, -1, -1, -1, -1, 4, -1};
    TexelAtlas atlas = flat_atlas(8, 1);
    EXPECT_DOUBLE_EQ(filled(atlas, values)[7], 4);
    EXPECT_DOUBLE_EQ(filled(atlas, values)[0], 1);
    atlas.wraps_around = true;
    // From column 6 over 7 and 0 to column 1.
    EXPECT_DOUBLE_EQ(filled(atlas, values)[7], 3);
    EXPECT_DOUBLE_EQ(filled(atlas, values)[0], 2);
    EXPECT_DOUBLE_EQ(filled(atlas, values)[4], 1 + 3 * 3 / 5.0);
}

TEST(InterpolateLinearly, GoesAroundToAnOnlyTexelFromBothSides) {
    TexelAtlas atlas = flat_atlas(6, 1);
    atlas.wraps_around = true;
    EXPECT_THAT(filled(atlas, {-1, -1, 5, -1, -1, -1}), Each(DoubleEq(5)));
}

TEST(InterpolateLinearly, DoesNotCrossCharts) {
    Mesh mesh = rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), {Vec2(0, 0), Vec2(0.5, 1)});
    append(mesh,
           rectangle(Vec3(5, 0, 0), Vec3::UnitX(), Vec3::UnitY(), {Vec2(0.5, 0), Vec2(1, 1)}));
    const TexelAtlas atlas = build_atlas(mesh, 6, 1);
    ASSERT_NE(atlas.texels[2].chart, atlas.texels[3].chart);
    EXPECT_THAT(filled(atlas, {-1, -1, 2, -1, 8, -1}),
                Pointwise(DoubleEq(), {2.0, 2.0, 2.0, 8.0, 8.0, 8.0}));
    // A chart in which nothing is measured takes the median of the others.
    EXPECT_THAT(filled(atlas, {1, 2, 6, -1, -1, -1}),
                Pointwise(DoubleEq(), {1.0, 2.0, 6.0, 2.0, 2.0, 2.0}));
}

TEST(InterpolateLinearly, TakesTheMedianWhereRowAndColumnAreEmpty) {
    const std::vector<double> values = filled(flat_atlas(3, 3),
                                              {3,
                                               1,
                                               -1,  //
                                               2,
                                               -1,
                                               -1,  //
                                               -1,
                                               -1,
                                               -1});
    EXPECT_DOUBLE_EQ(values[8], 2);
}

TEST(InterpolateLinearly, FallsBackWhenNothingIsMeasured) {
    EXPECT_THAT(filled(flat_atlas(3, 2), std::vector<double>(6, -1)), Each(DoubleEq(kFallback)));
}

}  // namespace
}  // namespace patina
