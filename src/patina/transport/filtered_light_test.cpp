#include "patina/transport/filtered_light.h"

#include "patina/base/random.h"
#include "patina/scene/atlas.h"

#include <gtest/gtest.h>

#include "support/scenes.h"
#include <bit>
#include <cmath>
#include <functional>
#include <vector>

namespace patina {
namespace {

constexpr int kSide = 32;
constexpr double kRadius = 2;
constexpr double kNoise = 0.1;  // of one half, one standard deviation

TexelAtlas plate() {
    return build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), kSide, kSide);
}

// Light of every lamp and channel, with noise of its own in each half.
LargeVector<LightHalves> noisy_light(const TexelAtlas& atlas,
                                     double noise,
                                     const std::function<double(const Texel&)>& truth) {
    LargeVector<LightHalves> light(atlas.texels.size());
    for (std::size_t i = 0; i < light.size(); ++i) {
        Rng rng(5, Pass::tests, i);
        for (auto& half : light[i]) {
            for (Lanes& channel : half) {
                for (std::size_t l = 0; l < kLanes; ++l) {
                    // Uniform, of the standard deviation `noise`.
                    const double error = noise * std::sqrt(12.0) * (rng.uniform() - 0.5);
                    channel[l] = float(truth(atlas.texels[i]) + error);
                }
            }
        }
    }
    return light;
}

double step(const Texel& texel) { return texel.column < kSide / 2 ? 1.0 : 2.0; }
double plane(const Texel& texel) { return 1 + 0.01 * texel.column; }

double distance_from_step(const Texel& texel) { return std::abs(texel.column + 0.5 - kSide / 2); }

// Share of the lamps of the texels that are asked for [0 to 1].
double share_of_gains(const TexelAtlas& atlas,
                      const std::vector<LampMask>& gains,
                      const std::function<bool(const Texel&)>& is_asked) {
    double sum = 0;
    double count = 0;
    for (std::size_t i = 0; i < gains.size(); ++i) {
        if (!is_asked(atlas.texels[i])) continue;
        sum += std::popcount(gains[i]);
        count += double(kLanes);
    }
    return sum / count;
}

// Where light is a plane the filter lowers the error by (1 - sum of squared weights) / 2 of a
// half's variance, 0.44 of it for the nine texels of this one. The estimate of that has a standard
// deviation of 1.1 of that variance for one number, over the root of three channels and of the 27
// texels that three means over nine come to: 0.12. So one lamp in some thousands is judged wrongly,
// and at the plate's rim, with half as many texels, one in a hundred; of all fewer than one in two
// hundred.
constexpr double kJudgedRightly = 0.995;

TEST(FilteredLight, TakesNoiseAwayWhereLightIsAPlane) {
    const TexelAtlas atlas = plate();
    const SurfaceFilter filter = build_surface_filter(atlas, kRadius);
    const std::vector<LampMask> gains =
        where_filter_gains(filter, noisy_light(atlas, kNoise, plane));
    EXPECT_GT(share_of_gains(atlas, gains, [](const Texel&) { return true; }), kJudgedRightly);
}

TEST(FilteredLight, StaysAsItIsWhereThereIsNoNoise) {
    const TexelAtlas atlas = plate();
    const SurfaceFilter filter = build_surface_filter(atlas, kRadius);
    const std::vector<LampMask> gains = where_filter_gains(filter, noisy_light(atlas, 0, step));
    for (std::size_t i = 0; i < gains.size(); ++i) {
        if (distance_from_step(atlas.texels[i]) < kRadius) {
            EXPECT_EQ(gains[i], 0) << i;
        }
    }
}

// A step of ten standard deviations: its blur outweighs the noise in all rows that reach it, and
// counts for nothing in those three rows away.
TEST(FilteredLight, KeepsAStepThatStandsOutOfTheNoise) {
    const TexelAtlas atlas = plate();
    const SurfaceFilter filter = build_surface_filter(atlas, kRadius);
    const std::vector<LampMask> gains =
        where_filter_gains(filter, noisy_light(atlas, kNoise, step));
    const auto is_near = [](const Texel& texel) { return distance_from_step(texel) < kRadius; };
    const auto is_far = [](const Texel& texel) { return distance_from_step(texel) > 4 * kRadius; };
    EXPECT_EQ(share_of_gains(atlas, gains, is_near), 0);
    EXPECT_GT(share_of_gains(atlas, gains, is_far), kJudgedRightly);
}

// The error of what is chosen, against light filtered everywhere and nowhere.
TEST(FilteredLight, IsNearerToTheTruthThanAllOrNothing) {
    const TexelAtlas atlas = plate();
    const SurfaceFilter filter = build_surface_filter(atlas, kRadius);
    const LargeVector<LightHalves> light = noisy_light(atlas, kNoise, step);
    const std::vector<LampMask> gains = where_filter_gains(filter, light);
    double nowhere = 0, everywhere = 0, chosen = 0;
    for (std::size_t i = 0; i < light.size(); ++i) {
        const LightHalves smooth = filtered(filter, light, i);
        const auto error = [&](const LightHalves& halves) {
            double sum = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const Lanes off =
                    0.5f * (halves[0][c] + halves[1][c]) - float(step(atlas.texels[i]));
                sum += sum_of_lanes(off * off);
            }
            return sum;
        };
        nowhere += error(light[i]);
        everywhere += error(smooth);
        chosen += error(filtered_for(gains[i], filter, light, i));
    }
    EXPECT_LT(chosen, nowhere);
    EXPECT_LT(chosen, everywhere);
}

}  // namespace
}  // namespace patina
