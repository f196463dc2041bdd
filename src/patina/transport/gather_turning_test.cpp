// Lamps that turn with the scanner, gathered.
#include <gtest/gtest.h>

#include "support/channel.h"
#include "support/fluted_column.h"
#include "support/gathered_light.h"
#include <cmath>
#include <cstring>
#include <limits>

namespace patina {
namespace {

constexpr std::size_t kNumRuns = 128;  // independent graphs
constexpr int kConverged = 5;  // sweeps: a fifth and less is left after each, 0.03 % after all

class FlutedColumnUnderATurningLamp : public testing::Test {
  protected:
    [[nodiscard]] GatheredLight gather(const GatherOptions& options) const {
        return {
            scene_.surface(), atlas_, lamp_block(scene_.lights, direct_), maps_, options, {}, true};
    }
    // H at the centres of texels when the lamp stands `offset` beside them [rad].
    [[nodiscard]] SampleMean reference(const std::vector<TexelId>& texels,
                                       int max_bounces,
                                       double offset) const {
        PathTracerOptions options;
        options.max_bounces = max_bounces;
        const ReflectanceField field = scene_.field();
        return randomised_mean(128, 512, texels.front(), [&](SobolSampler& sampler) {
            const Texel& texel = atlas_.texels[random_texel(texels, sampler)];
            return trace_indirect_irradiance(scene_.surface(),
                                             field,
                                             scene_.lights,
                                             texel.azimuth + offset,
                                             texel.point,
                                             options,
                                             sampler)
                .mean();
        });
    }
    // Mean difference of azimuth between these texels and the texels that light them [rad].
    [[nodiscard]] double azimuth_to_hits(const GatherGraph& graph,
                                         const std::vector<TexelId>& texels) const {
        double sum = 0;
        double count = 0;
        for (const TexelId texel : texels) {
            for (const GatherHit& hit : graph.irradiance.of(texel)) {
                sum += std::abs(std::remainder(
                    atlas_.texels[texel].azimuth - atlas_.texels[hit.to].azimuth, 2 * kPi));
                count += 1;
            }
        }
        return sum / count;
    }
    [[nodiscard]] static double mean_irradiance(const GatheredLight& light,
                                                const std::vector<TexelId>& texels) {
        return mean_over(texels, [&](TexelId texel) { return light.irradiance(texel); });
    }

    static constexpr int kFirst = 17;  // columns deep in a flute
    static constexpr int kEnd = 25;
    // The lamp is 2.6 or more away, and a facet 0.08 wide on the flanks.
    static inline const double kBias = texel_centre_bias(0.08, 0.3, 2.6);
    const Reflectance material_{Rgb(0.6, 0.5, 0.4), 1, 0.3};
    const LitScene scene_{FlutedColumn::mesh(), material_, [] {
                              Light lamp = point_light(Vec3(0.5, 0.7, 4), 10);
                              lamp.frame = FrameOfReference::scanner;
                              return std::vector<Light>{lamp};
                          }()};
    const TexelAtlas atlas_ = FlutedColumn::atlas(scene_.mesh);
    const std::vector<LargeVector<DirectLight>> direct_{
        direct_light(scene_.surface(), atlas_, scene_.lights.front())};
    const std::vector<Reflectance> maps_ =
        std::vector<Reflectance>(atlas_.texels.size(), material_);
};

TEST_F(FlutedColumnUnderATurningLamp, EachColumnGathersWhatTheLampSendsFromItsOwnAzimuth) {
    constexpr std::size_t kNumColumns = kEnd - kFirst;
    std::array<std::vector<TexelId>, kNumColumns> columns;
    for (std::size_t k = 0; k < kNumColumns; ++k) {
        columns[k] = FlutedColumn::flute(atlas_, kFirst + int(k), kFirst + int(k) + 1);
    }
    std::array<std::vector<double>, kNumColumns> runs;
    for (std::size_t run = 0; run < kNumRuns; ++run) {
        GatherOptions options;
        options.rays = 8;
        options.seed = run;
        GatheredLight light = gather(options);
        light.sweep(1);
        for (std::size_t k = 0; k < kNumColumns; ++k) {
            runs[k].push_back(mean_irradiance(light, columns[k]));
        }
    }
    for (std::size_t k = 0; k < kNumColumns; ++k) {
        const SampleMean exact = reference(columns[k], 1, 0);
        const SampleMean error = difference(estimate_of(runs[k]), exact);
        EXPECT_TRUE(agrees(error, 0, kBias * exact.mean)) << "column " << k;
        EXPECT_LT(3 * error.standard_error, 0.05 * exact.mean) << "the test would see nothing";
    }
}

TEST_F(FlutedColumnUnderATurningLamp, LaterBouncesComeFromTheAzimuthOfWhatTheyMeet) {
    // A column's own indirect light is known for its own azimuth only, and that is what it sends on
    // to others. So what arrives after the first bounce errs as H does when the lamp stands as far
    // aside as the columns that light each other are.
    const std::vector<TexelId> flute = FlutedColumn::flute(atlas_, kFirst, kEnd);
    std::vector<double> first;
    std::vector<double> converged;
    double offset = 0;
    for (std::size_t run = 0; run < kNumRuns; ++run) {
        GatherOptions options;
        options.rays = 4;
        options.seed = run;
        GatheredLight light = gather(options);
        light.sweep(1);
        first.push_back(mean_irradiance(light, flute));
        light.sweep(kConverged - 1);
        converged.push_back(mean_irradiance(light, flute));
        offset += azimuth_to_hits(light.graph(), flute) / kNumRuns;
    }
    constexpr int kAll = std::numeric_limits<int>::max();
    const SampleMean exact = reference(flute, kAll, 0);
    const SampleMean gathered = estimate_of(converged);
    const double later = gathered.mean - estimate_of(first).mean;
    double change = 0;  // of H, relative
    for (const double aside : {-offset, offset}) {
        change = std::max(change, std::abs(reference(flute, kAll, aside).mean / exact.mean - 1));
    }
    const SampleMean error = difference(gathered, exact);
    EXPECT_TRUE(agrees(error, 0, kBias * exact.mean + change * later))
        << gathered.mean << " +- " << gathered.standard_error << ", " << exact.mean << " +- "
        << exact.standard_error;
    EXPECT_LT(change * later + 3 * error.standard_error, 0.1 * exact.mean)
        << "the test would see nothing";
}

TEST(TurningLamp, IsOneThatStandsWhereTheAzimuthIsZero) {
    // The light of either is stored in 16 bits, rounded to nearest. It enters the lobe's Gaussian
    // exp(-x) by its factor and by x; the mean of x exp(-x) over a lobe is that of exp(-x), so that
    // the two are worth twice as much in the mean.
    constexpr double kRounding = 2 * kCompactRounding;
    const Channel channel;
    std::vector<Light> turning = channel.scene.lights;
    for (Light& light : turning) light.frame = FrameOfReference::scanner;
    const auto gather = [&](const std::vector<Light>& lights, bool turns) {
        GatherOptions options;
        options.rays = 16;
        GatheredLight light(channel.scene.surface(),
                            channel.atlas,
                            lamp_block(lights, channel.direct),
                            channel.maps,
                            options,
                            {},
                            turns);
        light.sweep(3);
        return light;
    };
    const GatheredLight standing = gather(channel.scene.lights, false);
    const GatheredLight turned = gather(turning, true);
    for (const std::vector<TexelId>& patch : channel.patches()) {
        const double expected =
            mean_over(patch, [&](TexelId texel) { return standing.irradiance(texel); });
        EXPECT_GT(expected, 0);
        EXPECT_NEAR(mean_over(patch, [&](TexelId texel) { return turned.irradiance(texel); }),
                    expected,
                    2 * kRounding * expected);
    }
}

TEST_F(FlutedColumnUnderATurningLamp, GathersTheSameOnAnyNumberOfThreads) {
    const auto light = [&](int threads) {
        const ThreadLimit limit(threads);
        GatheredLight result = gather(GatherOptions{});
        result.sweep(2);
        return result;
    };
    const GatheredLight one = light(1);
    const GatheredLight two = light(2);
    for (const std::size_t half : {0U, 1U}) {
        const IndirectLanes& a = one.halves()[half];
        const IndirectLanes& b = two.halves()[half];
        ASSERT_EQ(a.size(), b.size());
        EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])), 0);
    }
}

}  // namespace
}  // namespace patina
