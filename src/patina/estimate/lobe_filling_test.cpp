#include "patina/estimate/lobe_filling.h"

#include "patina/base/random.h"
#include "patina/scene/atlas.h"

#include <gtest/gtest.h>

#include "support/scenes.h"
#include <algorithm>
#include <cmath>
#include <vector>

namespace patina {
namespace {

constexpr int kSide = 48;
constexpr int kSpacing = 4;  // of the texels with measured lobes
constexpr double kSigma = 0.1;
constexpr double kLobeAlbedo = 0.02;  // Ps sigma^2
constexpr double kSpread = 0.05;      // of its logarithm, one standard deviation
constexpr double kStrayFactor = 5.0;
constexpr double kTolerance = 1e-5;
// A relative residual of kTolerance; the equation's smallest eigenvalue is that of the screening,
// 1/60^2, and its largest about 8.
constexpr double kSolver = 0.3;

TexelAtlas plate() {
    return build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), kSide, kSide);
}

double lobe_albedo(const TexelFit& fit) {
    return fit.reflectance.specular * square(fit.reflectance.roughness);
}

// Of one colour, with lobes alike to a few per cent measured on a grid, those where `factor` is
// not 1 so many times as strong; 0: measured to be matte.
template <typename Factor>
std::vector<TexelFit> measured_plate(const TexelAtlas& atlas, const Factor& factor) {
    std::vector<TexelFit> fits(atlas.texels.size());
    for (std::size_t i = 0; i < fits.size(); ++i) {
        TexelFit& fit = fits[i];
        fit.observed = true;
        fit.reflectance.diffuse = Rgb(0.5, 0.4, 0.3);
        const Texel& texel = atlas.texels[i];
        const double times = factor(texel);
        if (times == 1 && (texel.column % kSpacing != 0 || texel.row % kSpacing != 0)) continue;
        Rng rng(1, Pass::tests, i);
        const double noise = kSpread * std::sqrt(12.0) * (rng.uniform() - 0.5);
        fit.specular_measured = true;
        fit.roughness_measured = times > 0;
        fit.reflectance.roughness = kSigma;
        fit.reflectance.specular = times * kLobeAlbedo * std::exp(noise) / square(kSigma);
    }
    return fits;
}

void fill(const TexelAtlas& atlas, std::vector<TexelFit>& fits) {
    LobeFilling filling(atlas);
    filling.set_guide(fits);
    filling.fill_roughness(kTolerance, fits);
    filling.fill_specular(kTolerance, 0, fits);
}

bool in_clump(const Texel& texel) {
    return std::abs(texel.column - 14) <= 1 && std::abs(texel.row - 14) <= 1;
}

// Fills a plate on which `factor` makes a few lobes stray, less than the tenth of the measured ones
// from which on both of two kinds lie within three times the root mean square of all: what is
// filled lies between the others, and the strays stay what they were measured to be.
template <typename Factor>
void expect_strays_to_fill_nothing(const Factor& factor) {
    const TexelAtlas atlas = plate();
    std::vector<TexelFit> fits = measured_plate(atlas, factor);
    const std::vector<TexelFit> before = fits;
    fill(atlas, fits);
    const double furthest = std::exp(kSpread * std::sqrt(3.0)) * (1 + kSolver * kSpread);
    for (std::size_t i = 0; i < fits.size(); ++i) {
        if (before[i].specular_measured) {
            EXPECT_EQ(fits[i].reflectance.specular, before[i].reflectance.specular) << i;
        } else {
            EXPECT_GT(lobe_albedo(fits[i]), kLobeAlbedo / furthest) << i;
            EXPECT_LT(lobe_albedo(fits[i]), kLobeAlbedo * furthest) << i;
        }
    }
}

TEST(LobeFilling, LeavesOutAClumpOfLobesThatDepartFromAllOthers) {
    expect_strays_to_fill_nothing(
        [](const Texel& texel) { return in_clump(texel) ? kStrayFactor : 1.0; });
}

TEST(LobeFilling, LeavesOutAFewMatteTexelsOfAGlossySurface) {
    expect_strays_to_fill_nothing(
        [](const Texel& texel) { return texel.column == 14 && texel.row == 14 ? 0.0 : 1.0; });
}

TEST(LobeFilling, LeavesOutLobesOfAStrayWidth) {
    const TexelAtlas atlas = plate();
    std::vector<TexelFit> fits = measured_plate(atlas, [](const Texel&) { return 1.0; });
    for (std::size_t i = 0; i < fits.size(); ++i) {
        if (!fits[i].roughness_measured) continue;
        Rng rng(2, Pass::tests, i);
        const bool stray = atlas.texels[i].column == 16 && atlas.texels[i].row == 16;
        fits[i].reflectance.roughness *=
            stray ? kStrayFactor : std::exp(kSpread * (rng.uniform() - 0.5));
    }
    const std::vector<TexelFit> before = fits;
    fill(atlas, fits);
    for (std::size_t i = 0; i < fits.size(); ++i) {
        if (before[i].specular_measured) continue;
        EXPECT_NEAR(std::log(fits[i].reflectance.roughness / kSigma), 0, kSpread) << i;
    }
}

// A third of the surface is another material of the same colour: no stray.
TEST(LobeFilling, LetsAMaterialOfItsOwnFillItsSurroundings) {
    const TexelAtlas atlas = plate();
    const auto is_other = [](const Texel& texel) { return 3 * texel.column >= 2 * kSide; };
    std::vector<TexelFit> fits = measured_plate(atlas, [&](const Texel& texel) {
        const bool measured = texel.column % kSpacing == 0 && texel.row % kSpacing == 0;
        return is_other(texel) && measured ? kStrayFactor : 1.0;
    });
    fill(atlas, fits);
    const double between = kLobeAlbedo * std::sqrt(kStrayFactor);
    for (std::size_t i = 0; i < fits.size(); ++i) {
        const Texel& texel = atlas.texels[i];
        // Away from the border by a step of the grid.
        if (is_other(texel) && 3 * (texel.column - kSpacing) >= 2 * kSide) {
            EXPECT_GT(lobe_albedo(fits[i]), between) << i;
        } else if (3 * (texel.column + kSpacing) < 2 * kSide) {
            EXPECT_LT(lobe_albedo(fits[i]), between) << i;
        }
    }
}

}  // namespace
}  // namespace patina
