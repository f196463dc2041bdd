// The blur of footprints where it is known: waves, jumps, noise.
#include "patina/estimate/footprint_blur.h"

#include "patina/base/random.h"

#include <gtest/gtest.h>

#include "support/scenes.h"
#include <cmath>
#include <vector>

namespace patina {
namespace {

constexpr int kSide = 48;
constexpr double kMoment = 1.0 / 12;

class FootprintBlur : public testing::Test {
  protected:
    template <typename Value>
    [[nodiscard]] std::vector<Parameters> maps(const Value& value) const {
        std::vector<Parameters> result;
        for (const Texel& texel : atlas_.texels) {
            result.push_back(Parameters::Constant(value(texel.column, texel.row)));
        }
        return result;
    }
    // Root of the mean variance that is found, away from the borders.
    [[nodiscard]] double found(const std::vector<Parameters>& maps, double noise) const {
        const std::vector<Parameters> variances(maps.size(), Parameters::Constant(square(noise)));
        const std::vector<std::uint8_t> observed(maps.size(), 1);
        const LargeVector<Parameters> blur =
            footprint_blur(atlas_, maps, variances, observed, kMoment);
        double sum = 0;
        int count = 0;
        for (std::size_t i = 0; i < blur.size(); ++i) {
            const Texel& texel = atlas_.texels[i];
            if (std::min(texel.column, texel.row) < 4) continue;
            if (std::max(texel.column, texel.row) >= kSide - 4) continue;
            sum += blur[i].mean();
            ++count;
        }
        return std::sqrt(sum / count);
    }

    TexelAtlas atlas_ =
        build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), kSide, kSide);
};

TEST_F(FootprintBlur, IsTheMomentTimesHalfTheLaplacianOnSmoothMaps) {
    constexpr double kWave = 2 * kPi / 20;  // [rad / texel]
    const double blur = found(maps([](int x, int) { return std::sin(kWave * x); }), 0);
    // Mean of the wave over a texel less its value at the centre.
    const double exact = (1 - std::sin(kWave / 2) / (kWave / 2)) / std::sqrt(2.0);
    // Second differences fall short of the Laplacian by kWave^2 / 12, and the table's ends are
    // straight lines.
    EXPECT_NEAR(blur, exact, 0.1 * exact);
}

TEST_F(FootprintBlur, IsWhatJumpsLeaveInTheMean) {
    // Stripes 12 texels apart whose edges slant by one texel over the whole height.
    const auto edge = [](int y) { return (y + 0.5) / kSide; };
    const auto stripe = [&](int x, int y) {
        const int phase = x % 12;
        if (phase == 0) return 1 - edge(y);
        if (phase == 6) return edge(y);
        return phase < 6 ? 1.0 : 0.0;
    };
    const double blur = found(maps(stripe), 0);
    // One texel of six holds an edge; its mean is off from its centre by min(f, 1 - f) for a share
    // f: 1/12 in the mean of squares.
    const double exact = std::sqrt(1.0 / 12 / 6);
    // Within a few rows the edge does not lie anywhere in its texel, so the ratio that is seen
    // there is not the mean one that the table holds for.
    EXPECT_GT(blur, 0.5 * exact);
    EXPECT_LT(blur, 1.5 * exact);
}

TEST_F(FootprintBlur, IsNotSeenInNoise) {
    constexpr double kNoise = 0.05;
    std::vector<Parameters> noisy = maps([](int, int) { return 0.5; });
    for (std::size_t i = 0; i < noisy.size(); ++i) {
        Rng rng(22, Pass::tests, i);
        for (double& value : noisy[i]) value += kNoise * rng.normal();
    }
    // Whether its variance is stated or not: noise is no wider over two texels than over one. What
    // is left is chance.
    EXPECT_LT(found(noisy, kNoise), 0.5 * kNoise);
    EXPECT_LT(found(noisy, 0), 0.5 * kNoise);
}

}  // namespace
}  // namespace patina
