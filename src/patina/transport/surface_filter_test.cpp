#include "patina/transport/surface_filter.h"

#include "patina/base/random.h"

#include <gtest/gtest.h>

#include "support/false_alarms.h"
#include "support/scenes.h"
#include <cmath>
#include <functional>

namespace patina {
namespace {

constexpr double kRadius = 2;
// Weights are stored in single precision: each rounds by 6e-8, relatively.
constexpr double kFloatError = 6e-8;

struct Filtered {
    double value = 0;
    double sum_of_magnitudes = 0;  // of the addends, which rounding is relative to
};

Filtered apply(const SurfaceFilter& filter,
               std::size_t texel,
               const std::function<double(TexelId)>& value) {
    Filtered sum;
    for (std::size_t k = filter.begin[texel]; k < filter.begin[texel + 1]; ++k) {
        const double addend = double(filter.weight[k]) * value(filter.texel[k]);
        sum.value += addend;
        sum.sum_of_magnitudes += std::abs(addend);
    }
    return sum;
}

double sum_of_squares(const SurfaceFilter& filter, std::size_t texel) {
    double sum = 0;
    for (std::size_t k = filter.begin[texel]; k < filter.begin[texel + 1]; ++k) {
        sum += square(double(filter.weight[k]));
    }
    return sum;
}

// A tilted plate of 20 x 16 texels.
TexelAtlas plate_atlas() {
    return build_atlas(rectangle({1, 2, 3}, {1.6, 0, 1.2}, {0, 1.6, 0}), 20, 16);
}

TEST(SurfaceFilter, WeightsAddUpToOne) {
    const struct {
        const char* name;
        TexelAtlas atlas;
    } scenes[] = {
        {"plate", plate_atlas()},
        {"corner", build_atlas(perpendicular_unit_squares(), 24, 48)},
        {"box", build_atlas(inward_box(Vec3(1, 2, 1.5)), 60, 40)},
        {"sphere", build_atlas(sphere(1, 32, 16, SphereSide::inward, true), 48, 24)},
    };
    for (const auto& [name, atlas] : scenes) {
        const SurfaceFilter filter = build_surface_filter(atlas, kRadius);
        ASSERT_EQ(filter.begin.size(), atlas.texels.size() + 1) << name;
        for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
            const Filtered one = apply(filter, i, [](TexelId) { return 1.0; });
            EXPECT_NEAR(one.value, 1, kFloatError * one.sum_of_magnitudes) << name << ", " << i;
        }
    }
}

TEST(SurfaceFilter, PassesALinearFunctionUnchangedAlsoBesideABorder) {
    const TexelAtlas atlas = plate_atlas();
    const SurfaceFilter filter = build_surface_filter(atlas, kRadius);
    const auto linear = [&](TexelId texel) {
        return 2 + Vec3(0.7, -1.3, 0.4).dot(atlas.texels[texel].point.position);
    };
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        // A corner has the fewest neighbours: a quarter of a circle of radius 2, centres included.
        EXPECT_GE(filter.begin[i + 1] - filter.begin[i], 6U) << "not filtered, " << i;
        EXPECT_LT(sum_of_squares(filter, i), 1) << "not filtered, " << i;
        const Filtered filtered = apply(filter, i, linear);
        // Positions are interpolated from single precision too, beside 7 at most.
        EXPECT_NEAR(
            filtered.value, linear(TexelId(i)), kFloatError * (filtered.sum_of_magnitudes + 4 * 7))
            << i;
    }
}

TEST(SurfaceFilter, ReachesNotOverACrease) {
    const TexelAtlas atlas = build_atlas(perpendicular_unit_squares(), 24, 48);
    const SurfaceFilter filter = build_surface_filter(atlas, kRadius);
    const auto is_floor = [&](std::size_t texel) {
        return atlas.texels[texel].point.normal.z() > 0.5;
    };
    std::size_t num_beside_crease = 0;
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        for (std::uint32_t k = atlas.neighbor_begin[i]; k < atlas.neighbor_begin[i + 1]; ++k) {
            if (is_floor(atlas.neighbors[k]) != is_floor(i)) ++num_beside_crease;
        }
        for (std::size_t k = filter.begin[i]; k < filter.begin[i + 1]; ++k) {
            EXPECT_EQ(is_floor(filter.texel[k]), is_floor(i)) << i;
        }
    }
    EXPECT_GT(num_beside_crease, 0U) << "nothing to reach over";
}

TEST(SurfaceFilter, LeavesTexelsWithTooFewNeighboursAlone) {
    const Mesh mesh = rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    for (const int width : {1, 4, 16}) {  // alone; too few; enough, but on a line
        const TexelAtlas atlas = build_atlas(mesh, width, 1);
        const SurfaceFilter filter = build_surface_filter(atlas, kRadius);
        ASSERT_EQ(atlas.texels.size(), std::size_t(width));
        for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
            EXPECT_EQ(apply(filter, i, [](TexelId texel) { return 3.0 + texel; }).value,
                      3.0 + double(i));
        }
    }
}

TEST(SurfaceFilter, LowersTheVarianceOfNoiseToItsSumOfSquaredWeights) {
    constexpr std::uint64_t kNumRuns = 2000;
    const TexelAtlas atlas = plate_atlas();
    const SurfaceFilter filter = build_surface_filter(atlas, kRadius);
    const std::size_t middle = std::size_t(8 * atlas.width + 10);
    const std::size_t border = std::size_t(8 * atlas.width);
    const std::size_t corner = 0;
    for (const std::size_t texel : {middle, border, corner}) {
        std::vector<double> squares;
        for (std::uint64_t run = 0; run < kNumRuns; ++run) {
            Rng rng(run, Pass::tests, texel);
            squares.push_back(
                square(apply(filter, texel, [&](TexelId) { return rng.normal(); }).value));
        }
        EXPECT_TRUE(agrees(estimate_of(squares), sum_of_squares(filter, texel))) << texel;
        // No weights that add up to 1 do better than equal ones.
        const double num_texels = double(filter.begin[texel + 1] - filter.begin[texel]);
        EXPECT_GE(sum_of_squares(filter, texel), (1 - 1e-6) / num_texels) << texel;
    }
    EXPECT_LT(sum_of_squares(filter, middle), sum_of_squares(filter, border));
    EXPECT_LT(sum_of_squares(filter, border), sum_of_squares(filter, corner));
}

}  // namespace
}  // namespace patina
