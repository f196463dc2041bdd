#include "patina/estimate/guided_fill.h"

#include "patina/base/random.h"
#include "patina/scene/atlas.h"

#include <gtest/gtest.h>

#include "support/scenes.h"
#include <vector>

namespace patina {
namespace {

constexpr int kSide = 24;
// The solver stops at a relative residual of 1e-5; the equation's smallest eigenvalue is that of
// the screening, 1/60^2, and its largest about 8.
constexpr double kSolver = 1e-2;

TexelAtlas plate() {
    return build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), kSide, kSide);
}

const Rgb kRed(0.6, 0.2, 0.1);
const Rgb kBlue(0.1, 0.2, 0.6);

// Red on the left half, blue on the right.
std::vector<Rgb> two_colors(const TexelAtlas& atlas) {
    std::vector<Rgb> diffuse;
    for (const Texel& texel : atlas.texels)
        diffuse.push_back(texel.column < kSide / 2 ? kRed : kBlue);
    return diffuse;
}

TEST(GuidedFill, KeepsWhatIsKnownAndSpreadsAConstant) {
    const TexelAtlas atlas = plate();
    std::vector<float> confidence(atlas.texels.size(), 0.0f);
    std::vector<double> values(atlas.texels.size(), -5.0);
    for (std::size_t i = 0; i < values.size(); i += 37) {
        confidence[i] = 1;
        values[i] = 0.3;
    }
    GuidedFill(atlas, std::vector<Rgb>(values.size(), kRed)).fill(confidence, 9, values);
    for (std::size_t i = 0; i < values.size(); ++i) {
        EXPECT_NEAR(values[i], 0.3, i % 37 == 0 ? 0.0 : kSolver) << i;
    }
}

TEST(GuidedFill, GivesEachMaterialItsOwnValue) {
    const TexelAtlas atlas = plate();
    std::vector<float> confidence(atlas.texels.size(), 0.0f);
    std::vector<double> values(atlas.texels.size(), 0.0);
    // Known in two far corners only.
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Texel& texel = atlas.texels[i];
        if (texel.row >= 3 || (texel.column >= 3 && texel.column < kSide - 3)) continue;
        confidence[i] = 1;
        values[i] = texel.column < kSide / 2 ? 1.0 : 2.0;
    }
    GuidedFill(atlas, two_colors(atlas)).fill(confidence, 9, values);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool red = atlas.texels[i].column < kSide / 2;
        // Links across the border keep 1/1000 of their strength.
        EXPECT_NEAR(values[i], red ? 1.0 : 2.0, 0.1) << i;
    }
}

TEST(GuidedFill, IgnoresColorsThatExplainNothing) {
    // Values that follow the row, colours that follow chance: the trend must not follow the
    // colours.
    const TexelAtlas atlas = plate();
    std::vector<Rgb> diffuse;
    std::vector<float> confidence;
    std::vector<double> values;
    Rng rng(1, Pass::tests, 0);
    for (const Texel& texel : atlas.texels) {
        diffuse.push_back(rng.uniform() < 0.5 ? kRed : kBlue);
        const bool known = texel.row % 4 == 0;
        confidence.push_back(known ? 1.0f : 0.0f);
        values.push_back(known ? 1.0 + 0.05 * texel.row : 0.0);
    }
    GuidedFill(atlas, diffuse).fill(confidence, 9, values);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const int row = atlas.texels[i].row;
        if (row > 20) continue;
        // Between the known rows below and above.
        EXPECT_GE(values[i], 1.0 + 0.05 * (row / 4 * 4) - 0.05) << i;
        EXPECT_LE(values[i], 1.0 + 0.05 * ((row + 3) / 4 * 4) + 0.05) << i;
    }
}

TEST(GuidedFill, TrustsConfidentNeighboursMore) {
    const TexelAtlas atlas =
        build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), 3, 1);
    std::vector<float> confidence = {1.0f, 0.0f, 0.25f};
    std::vector<double> values = {1.0, 0.0, 2.0};
    GuidedFill(atlas, std::vector<Rgb>(3, kRed)).fill(confidence, 9, values);
    // One link each; weights 1 and 1/4, and the trend (1.2, one mean of both) with the weight
    // 1/3600.
    EXPECT_NEAR(values[1], (1.0 + 0.25 * 2.0 + 1.2 / 3600) / (1.25 + 1.0 / 3600), 1e-4);
}

TEST(GuidedFill, FallsBackWhenNothingIsKnown) {
    const TexelAtlas atlas = plate();
    std::vector<double> values(atlas.texels.size(), 1.0);
    GuidedFill(atlas, two_colors(atlas)).fill(std::vector<float>(values.size(), 0.0f), 9, values);
    for (const double value : values) EXPECT_EQ(value, 9);
}

}  // namespace
}  // namespace patina
