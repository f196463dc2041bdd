#include "patina/estimate/texel_turn.h"

#include "patina/scene/atlas.h"

#include <gtest/gtest.h>

#include "support/scenes.h"
#include <functional>
#include <vector>

namespace patina {
namespace {

constexpr int kSide = 24;
constexpr double kRoughness = 0.1;
constexpr double kSpecular = 2.0;

TexelAtlas plate() {
    return build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), kSide, kSide);
}

bool in_rectangle(const Texel& texel, int column, int row, int width, int height) {
    return texel.column >= column && texel.column < column + width && texel.row >= row &&
           texel.row < row + height;
}

// All texels observed; where Ps is above 0, lobes measured.
std::vector<TexelFit> fits_with(const TexelAtlas& atlas,
                                const std::function<double(const Texel&)>& specular) {
    std::vector<TexelFit> fits;
    for (const Texel& texel : atlas.texels) {
        TexelFit& fit = fits.emplace_back();
        fit.observed = true;
        fit.reflectance.specular = specular(texel);
        fit.reflectance.roughness = kRoughness;
        fit.specular_measured = fit.roughness_measured = fit.reflectance.specular > 0;
    }
    return fits;
}

std::size_t count_measured(const std::vector<TexelFit>& fits) {
    std::size_t count = 0;
    for (const TexelFit& fit : fits) count += fit.specular_measured ? 1 : 0;
    return count;
}

TEST(DropUnconfirmed, KeepsAHighlight) {
    const TexelAtlas atlas = plate();
    std::vector<TexelFit> fits = fits_with(atlas, [](const Texel& texel) {
        return in_rectangle(texel, 5, 6, 9, 4) ? kSpecular : 0.0;
    });
    const std::vector<std::uint8_t> dropped = drop_unconfirmed(atlas, fits);
    EXPECT_EQ(count_measured(fits), 9u * 4u);
    for (const std::uint8_t is_dropped : dropped) EXPECT_EQ(is_dropped, 0);
}

TEST(DropUnconfirmed, TakesBackSmallClumpsThoughTheirTexelsConfirmEachOther) {
    const TexelAtlas atlas = plate();
    for (const int side : {1, 2}) {
        std::vector<TexelFit> fits = fits_with(atlas, [&](const Texel& texel) {
            return in_rectangle(texel, 7, 7, side, side) ? kSpecular : 0.0;
        });
        const std::vector<std::uint8_t> dropped = drop_unconfirmed(atlas, fits);
        EXPECT_EQ(count_measured(fits), 0u) << side;
        for (std::size_t i = 0; i < dropped.size(); ++i) {
            EXPECT_EQ(dropped[i] != 0, in_rectangle(atlas.texels[i], 7, 7, side, side)) << i;
        }
    }
}

TEST(DropUnconfirmed, TakesBackARaggedClumpFromItsRimInwards) {
    const TexelAtlas atlas = plate();
    // A line has two neighbours of four at each inner texel and one at its ends.
    std::vector<TexelFit> fits = fits_with(
        atlas, [](const Texel& texel) { return in_rectangle(texel, 3, 9, 15, 1) ? kSpecular : 0; });
    static_cast<void>(drop_unconfirmed(atlas, fits));
    EXPECT_EQ(count_measured(fits), 0u);
}

TEST(DropUnconfirmed, TakesBackAStrayLobeWithinAHighlight) {
    const TexelAtlas atlas = plate();
    std::vector<TexelFit> fits = fits_with(atlas, [](const Texel& texel) {
        if (texel.column == 9 && texel.row == 9) return 5 * kSpecular;
        return in_rectangle(texel, 4, 4, 12, 12) ? kSpecular : 0.0;
    });
    static_cast<void>(drop_unconfirmed(atlas, fits));
    EXPECT_EQ(count_measured(fits), 12u * 12u - 1u);
}

}  // namespace
}  // namespace patina
