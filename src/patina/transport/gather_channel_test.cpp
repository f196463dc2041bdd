// A channel of three glossy plates, gathered many times over, against the path tracer.
#include "patina/base/wide_code.h"
#include "patina/transport/gather_sweep.h"

#include <gtest/gtest.h>

#include "support/channel.h"
#include "support/gathered_light.h"
#include "support/same_bytes.h"
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace patina {
namespace {

constexpr std::size_t kNumRuns = 128;  // independent graphs
constexpr int kAllBounces = std::numeric_limits<int>::max();
constexpr int kConverged = 6;  // sweeps: a third and less is left after each, 0.1 % after all

// What many graphs make of the channel's light after one sweep and after many.
class GatherChannel : public testing::Test {
  protected:
    struct Runs {
        std::array<std::vector<double>, 4> irradiance;  // per patch
        std::array<std::vector<double>, kLobeWidths.size()> lobe;
    };

    static void SetUpTestSuite() {
        channel_ = std::make_unique<Channel>();
        runs_ = std::make_unique<std::array<Runs, 2>>();
        for (std::size_t i = 0; i < kNumRuns; ++i) {
            GatherOptions options;
            options.rays = 8;
            options.lobe_rays = 8;
            options.seed = i;
            GatheredLight light = gather(options);
            light.sweep(1);
            add(light, (*runs_)[0]);
            light.sweep(kConverged - 1);
            add(light, (*runs_)[1]);
        }
    }
    static void TearDownTestSuite() {
        runs_.reset();
        channel_.reset();
    }

    static GatheredLight gather(const GatherOptions& options,
                                std::span<const Reflectance> maps = channel_->maps) {
        ViewDirections view(channel_->atlas.texels.size(), Vec3f::Zero());
        for (const TexelId texel : channel_->looked_at()) {
            view[texel] = Channel::towards_camera().cast<float>();
        }
        return {channel_->scene.surface(),
                channel_->atlas,
                lamp_block(channel_->scene.lights, channel_->direct),
                maps,
                options,
                std::span(&view, 1)};
    }
    static void add(const GatheredLight& light, Runs& runs) {
        const auto patches = channel_->patches();
        for (std::size_t k = 0; k < patches.size(); ++k) {
            runs.irradiance[k].push_back(
                mean_over(patches[k], [&](TexelId texel) { return light.irradiance(texel); }));
        }
        std::array<double, kLobeWidths.size()> sums{};
        const std::vector<TexelId> looked_at = channel_->looked_at();
        for (const TexelId texel : looked_at) {
            const auto lobe = light.lobe(
                texel, Channel::towards_camera().cast<float>(), channel_->maps[texel].roughness);
            for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += lobe[k];
        }
        for (std::size_t k = 0; k < sums.size(); ++k) {
            runs.lobe[k].push_back(sums[k] / double(looked_at.size()));
        }
    }

    // By path tracing, at the centres of the texels of a patch.
    static SampleMean reference(const std::vector<TexelId>& patch,
                                std::span<const Reflectance> maps,
                                int max_bounces) {
        return traced_irradiance(*channel_, patch, maps, max_bounces, 2048, 1);
    }
    // By path tracing from the texels that are looked at, through lobe number k of kLobeWidths:
    // what the places that are met send on of the lamps' light, of light that others sent, or of
    // both.
    struct Sent {
        double direct, indirect;
    };
    static SampleMean seen_through_lobe(std::span<const Reflectance> maps,
                                        std::size_t k,
                                        Sent sent,
                                        std::size_t num_samples) {
        const ReflectanceField field =
            ReflectanceField::per_texel(channel_->scene.mesh, channel_->atlas, maps);
        const std::vector<TexelId> looked_at = channel_->looked_at();
        const double sigma = channel_->maps[looked_at.front()].roughness;
        return randomised_mean(128, num_samples, k, [&](SobolSampler& sampler) {
            const TexelId texel = random_texel(looked_at, sampler);
            const OutgoingRadiance radiance =
                sample_through_lobe(channel_->scene,
                                    field,
                                    channel_->atlas.texels[texel].point,
                                    Channel::towards_camera(),
                                    kLobeWidths[k].factor * sigma,
                                    sampler);
            return (sent.direct * radiance.direct + sent.indirect * radiance.indirect).mean();
        });
    }
    // Where the widest lobe has fallen below 1 %, light is left out: 1 % of the lobe's.
    static double left_out_of_lobe(std::size_t k) {
        return kLobeWidths[k].factor == 2 ? 0.01 : 0.0;
    }
    // What lobes send on of light that other lobes sent is spread evenly: its energy is right, its
    // directions are not. It errs by no more than itself, which is at most this share of what
    // arrives after the first bounce.
    static double evenly_spread_share() {
        double share = 0;
        for (const Reflectance& map : channel_->maps) {
            const double albedo = map.specular * lobe_albedo(2.0 / 3, map.roughness);
            share = std::max(share, albedo / (map.diffuse.mean() + albedo));
        }
        return square(share);
    }
    // Its part of the converged light [-].
    static double spread_bias(const std::vector<double>& first,
                              const std::vector<double>& converged) {
        return evenly_spread_share() * (1 - estimate_of(first).mean / estimate_of(converged).mean);
    }
    static void expect_close(const std::vector<double>& runs,
                             const SampleMean& reference,
                             double bias,
                             const std::string& name) {
        const SampleMean gathered = estimate_of(runs);
        const SampleMean error = difference(gathered, reference);
        EXPECT_TRUE(agrees(error, 0, bias * reference.mean))
            << name << ": " << gathered.mean << " +- " << gathered.standard_error << ", "
            << reference.mean << " +- " << reference.standard_error;
        EXPECT_LT(3 * error.standard_error, 0.03 * reference.mean)
            << name << ": the test would see nothing";
    }

    static std::unique_ptr<Channel> channel_;
    static std::unique_ptr<std::array<Runs, 2>> runs_;
};

std::unique_ptr<Channel> GatherChannel::channel_;
std::unique_ptr<std::array<GatherChannel::Runs, 2>> GatherChannel::runs_;

TEST_F(GatherChannel, HasTheFirstBounceOfThePathTracer) {
    const auto patches = channel_->patches();
    for (std::size_t k = 0; k < patches.size(); ++k) {
        expect_close((*runs_)[0].irradiance[k],
                     reference(patches[k], channel_->maps, 1),
                     kChannelBias,
                     "patch " + std::to_string(k));
    }
}

TEST_F(GatherChannel, ConvergesToTheDiffuseLightOfThePathTracer) {
    std::vector<Reflectance> maps = channel_->maps;
    for (Reflectance& map : maps) map.specular = 0;
    const auto patches = channel_->patches();
    std::array<std::vector<double>, 4> runs;
    for (std::size_t i = 0; i < kNumRuns; ++i) {
        GatherOptions options;
        options.rays = 4;
        options.seed = i;
        GatheredLight light = gather(options, maps);
        light.sweep(kConverged);
        for (std::size_t k = 0; k < patches.size(); ++k) {
            runs[k].push_back(
                mean_over(patches[k], [&](TexelId texel) { return light.irradiance(texel); }));
        }
    }
    for (std::size_t k = 0; k < patches.size(); ++k) {
        expect_close(runs[k],
                     reference(patches[k], maps, kAllBounces),
                     kChannelBias,
                     "patch " + std::to_string(k));
    }
}

TEST_F(GatherChannel, ConvergesToTheIrradianceOfThePathTracer) {
    const auto patches = channel_->patches();
    for (std::size_t k = 0; k < patches.size(); ++k) {
        const std::vector<double>& converged = (*runs_)[1].irradiance[k];
        const double spread = spread_bias((*runs_)[0].irradiance[k], converged);
        EXPECT_LT(spread, 0.1) << "the test would see nothing";
        expect_close(converged,
                     reference(patches[k], channel_->maps, kAllBounces),
                     kChannelBias + spread,
                     "patch " + std::to_string(k));
    }
}

TEST_F(GatherChannel, IsSeenThroughTheLobeAsThePathTracerSeesIt) {
    for (std::size_t k = 0; k < kLobeWidths.size(); ++k) {
        const std::string name = kLobeWidths[k].name;
        const std::vector<double>& first = (*runs_)[0].lobe[k];
        const std::vector<double>& converged = (*runs_)[1].lobe[k];
        expect_close(first,
                     seen_through_lobe(channel_->maps, k, {1, 0}, 1024),
                     kChannelBias + left_out_of_lobe(k),
                     name + ", first bounce");
        expect_close(converged,
                     seen_through_lobe(channel_->maps, k, {1, 1}, 1024),
                     kChannelBias + left_out_of_lobe(k) + spread_bias(first, converged),
                     name + ", converged");
    }
}

// The left wall alone is glossy, and more so than bright: nothing that its lobe sends on has come
// from a lobe before, so that nothing is spread evenly.
TEST_F(GatherChannel, FollowsWhatOneGlossyWallSendsOn) {
    std::vector<Reflectance> maps = channel_->maps;
    for (Reflectance& map : maps) map = lambertian(0.7);
    for (const TexelId texel :
         channel_->patch(Channel::left, 0, Channel::kSide, 0, Channel::kSide)) {
        maps[texel] = {Rgb::Constant(0.1), 4, 0.25};
    }
    Runs first;
    Runs converged;
    for (std::size_t i = 0; i < kNumRuns; ++i) {
        GatherOptions options;
        options.rays = 16;
        options.lobe_rays = 64;
        options.seed = i;
        GatheredLight light = gather(options, maps);
        light.sweep(1);
        add(light, first);
        light.sweep(kConverged - 1);
        add(light, converged);
    }
    const auto patches = channel_->patches();
    for (std::size_t k = 0; k < patches.size(); ++k) {
        expect_close(converged.irradiance[k],
                     reference(patches[k], maps, kAllBounces),
                     kChannelBias,
                     "patch " + std::to_string(k));
    }
    // Without the images of the lamps, which hide it.
    for (std::size_t k = 0; k < kLobeWidths.size(); ++k) {
        std::vector<double> later;
        for (std::size_t i = 0; i < kNumRuns; ++i) {
            later.push_back(converged.lobe[k][i] - first.lobe[k][i]);
        }
        expect_close(later,
                     seen_through_lobe(maps, k, {0, 1}, 8192),
                     kChannelBias + left_out_of_lobe(k),
                     kLobeWidths[k].name);
    }
}

void expect_same_bytes(const GatheredLight& a, const GatheredLight& b) {
    ASSERT_GT(a.graph().irradiance.hits.size(), 10'000U);
    ASSERT_GT(a.graph().lobes.front().hits.size(), 1'000U);
    EXPECT_TRUE(same_bytes(a.graph().irradiance.begin, b.graph().irradiance.begin));
    EXPECT_TRUE(same_bytes(a.graph().irradiance.hits, b.graph().irradiance.hits));
    EXPECT_TRUE(same_bytes(a.graph().lobes.front().hits, b.graph().lobes.front().hits));
    ASSERT_GT(a.graph().irradiance.glossy.size(), 1'000U);
    EXPECT_TRUE(same_bytes(a.graph().irradiance.glossy, b.graph().irradiance.glossy));
    EXPECT_TRUE(same_bytes(a.graph().lobes.front().glossy, b.graph().lobes.front().glossy));
    for (const std::size_t half : {0U, 1U}) {
        EXPECT_TRUE(same_bytes(a.halves()[half], b.halves()[half]));
    }
}

TEST_F(GatherChannel, IsTheSameForAnyNumberOfThreads) {
    const auto light = [&](int threads) {
        const ThreadLimit limit(threads);
        GatheredLight result = gather(GatherOptions{});
        result.sweep(2);
        return result;
    };
    expect_same_bytes(light(1), light(2));
}

TEST_F(GatherChannel, IsTheSameWithAvx512AndWithout) {
    if (!takes_avx512()) GTEST_SKIP() << "this machine has no AVX-512";
    const auto light = [&] {
        GatheredLight result = gather(GatherOptions{});
        result.sweep(2);
        return result;
    };
    const GatheredLight wide = light();
    const NarrowCode narrow_code;
    ASSERT_FALSE(takes_avx512());
    expect_same_bytes(wide, light());
}

}  // namespace
}  // namespace patina
