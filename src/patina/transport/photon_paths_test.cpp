#include "patina/transport/photon_paths.h"

#include "patina/base/wide_code.h"
#include "patina/transport/path_tracer.h"
#include "patina/transport/ratio_kernel.h"

#include <gtest/gtest.h>

#include "support/channel.h"
#include "support/fluted_column.h"
#include "support/same_bytes.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace patina {
namespace {

// --- A channel of three glossy plates ------------------------------------------------------------

constexpr std::size_t kNumRuns = 128;  // independent sets of photons

struct GlossyChannel : Channel {
    LampSet lamps;
    RatioKernel kernel;
    std::vector<Reflectance> guide;  // something else than the maps

    GlossyChannel() : guide(atlas.texels.size(), {Rgb(0.5, 0.5, 0.3), 0.5, 0.3}) {
        for (const Light& light : scene.lights) lamps.lights.push_back(&light);
        for (const auto& lamp : direct) lamps.direct.push_back(&lamp);
        // A kernel that does not depend on the photons keeps the estimate linear in their power.
        RatioKernelOptions options;
        options.arrivals = 1e-9;
        options.min_radius = options.max_radius = 2;
        kernel = build_ratio_kernel(atlas, std::vector<double>(atlas.texels.size(), 1.0), options);
    }

    [[nodiscard]] PhotonPaths trace(std::span<const Reflectance> guides,
                                    std::uint64_t photons,
                                    std::uint64_t seed) const {
        PhotonOptions options;
        options.photons = photons;
        options.seed = seed;
        Progress progress;
        return trace_photons(
            PhotonScene(scene.surface(), atlas, guides), lamps, options, 0, progress);
    }
    // A random point of the kernel of a texel: the texel y with the probability w A, then anywhere
    // in it. A mean over such points is what the kernel makes of a function, without its bias.
    [[nodiscard]] SurfacePoint point_in_kernel(TexelId center, SobolSampler& sampler) const {
        const auto [choice, unused] = sampler.next_pair();
        std::size_t k = kernel.begin[center];
        double remaining = choice;
        for (; k + 1 < kernel.begin[center + 1]; ++k) {
            remaining -= double(kernel.weight[k]) * atlas.texels[kernel.texel[k]].area;
            if (remaining < 0) break;
        }
        const Texel& texel = atlas.texels[kernel.texel[k]];
        const Triangle& t = scene.mesh.triangles[2 * std::size_t(texel.column / kPitch)];
        const auto [u, v] = sampler.next_pair();
        SurfacePoint point = texel.point;
        point.position +=
            ((u - 0.5) / kSide *
                 (scene.mesh.positions[t[1]] - scene.mesh.positions[t[0]]).cast<double>() +
             (v - 0.5) / kSide *
                 (scene.mesh.positions[t[2]] - scene.mesh.positions[t[1]]).cast<double>());
        return point;
    }
};

constexpr std::array<Rgbf IndirectLobe::*, kLobeWidths.size()> kLobeMembers = {
    &IndirectLobe::half, &IndirectLobe::same, &IndirectLobe::twice};

// The photons of all runs, in numbers: what the tests of the channel compare.
class PhotonChannel : public testing::Test {
  protected:
    static constexpr std::size_t kNumPatches = 4;
    struct Runs {
        std::array<std::vector<double>, kNumPatches> irradiance;
        std::array<std::vector<double>, kLobeWidths.size()> lobe;
    };

    static void SetUpTestSuite() {
        channel_ = std::make_unique<GlossyChannel>();
        patches_ = channel_->patches();
        looked_at_ = channel_->looked_at();
        own_ = run(channel_->maps, 1);
    }
    static void TearDownTestSuite() { channel_.reset(); }

    // Photons that follow `guide`, weighted for the channel's maps.
    static Runs run(std::span<const Reflectance> guide, std::uint64_t seed) {
        Runs runs;
        const std::size_t num_texels = channel_->atlas.texels.size();
        std::vector<std::uint8_t> wanted(num_texels, 0);
        for (const TexelId texel : looked_at_) wanted[texel] = 1;
        const std::vector<Vec3f> w_v(num_texels, Channel::towards_camera().cast<float>());
        for (std::size_t i = 0; i < kNumRuns; ++i) {
            const PhotonPaths paths = channel_->trace(guide, 8192, seed * kNumRuns + i);
            const PhotonPower power = photon_power(paths, channel_->maps);
            const std::vector<IndirectIrradiance> irradiance =
                indirect_irradiance(channel_->kernel, paths, power.arrivals);
            for (std::size_t k = 0; k < kNumPatches; ++k) {
                runs.irradiance[k].push_back(mean_over(
                    patches_[k], [&](TexelId texel) { return irradiance[texel].mean().mean(); }));
            }
            std::vector<IndirectLobe> lobe(num_texels);
            add_indirect_lobe(channel_->kernel,
                              paths,
                              power.arrivals,
                              channel_->atlas,
                              w_v,
                              channel_->maps,
                              wanted,
                              {lobe.data()});
            for (std::size_t k = 0; k < kLobeWidths.size(); ++k) {
                runs.lobe[k].push_back(mean_over(looked_at_, [&](TexelId texel) {
                    return double((lobe[texel].*kLobeMembers[k]).mean());
                }));
            }
        }
        return runs;
    }

    static std::unique_ptr<GlossyChannel> channel_;
    static std::array<std::vector<TexelId>, kNumPatches> patches_;
    static std::vector<TexelId> looked_at_;
    static Runs own_;
};

std::unique_ptr<GlossyChannel> PhotonChannel::channel_;
std::array<std::vector<TexelId>, PhotonChannel::kNumPatches> PhotonChannel::patches_;
std::vector<TexelId> PhotonChannel::looked_at_;
PhotonChannel::Runs PhotonChannel::own_;

TEST_F(PhotonChannel, HasTheIrradianceOfThePathTracer) {
    const GlossyChannel& channel = *channel_;
    const ReflectanceField field =
        ReflectanceField::per_texel(channel.scene.mesh, channel.atlas, channel.maps);
    for (std::size_t k = 0; k < kNumPatches; ++k) {
        const SampleMean reference = randomised_mean(128, 2048, k, [&](SobolSampler& sampler) {
            const TexelId texel = random_texel(patches_[k], sampler);
            const SurfacePoint point = channel.point_in_kernel(texel, sampler);
            return trace_indirect_irradiance(
                       channel.scene.surface(), field, channel.scene.lights, 0, point, {}, sampler)
                .mean();
        });
        const SampleMean photons = estimate_of(own_.irradiance[k]);
        const SampleMean error = difference(photons, reference);
        EXPECT_TRUE(agrees(error, 0, kChannelBias * reference.mean))
            << "patch " << k << ": " << photons.mean << " +- " << photons.standard_error << ", "
            << reference.mean << " +- " << reference.standard_error;
        EXPECT_LT(3 * error.standard_error, 0.02 * reference.mean) << "the test would see nothing";
    }
}

TEST_F(PhotonChannel, IsSeenThroughTheLobeAsThePathTracerSeesIt) {
    const GlossyChannel& channel = *channel_;
    const ReflectanceField field =
        ReflectanceField::per_texel(channel.scene.mesh, channel.atlas, channel.maps);
    const double sigma = channel.maps[looked_at_.front()].roughness;
    for (std::size_t k = 0; k < kLobeWidths.size(); ++k) {
        const SampleMean reference = randomised_mean(128, 512, k, [&](SobolSampler& sampler) {
            const TexelId texel = random_texel(looked_at_, sampler);
            const OutgoingRadiance radiance =
                sample_through_lobe(channel.scene,
                                    field,
                                    channel.point_in_kernel(texel, sampler),
                                    Channel::towards_camera(),
                                    kLobeWidths[k].factor * sigma,
                                    sampler);
            return (radiance.direct + radiance.indirect).mean();
        });
        const SampleMean photons = estimate_of(own_.lobe[k]);
        const SampleMean error = difference(photons, reference);
        // Arrivals beyond three sigma of the widest lobe are left out: exp(-9/2) of its light.
        const double left_out = kLobeWidths[k].factor == 2 ? std::exp(-4.5) : 0.0;
        EXPECT_TRUE(agrees(error, 0, (kChannelBias + left_out) * reference.mean))
            << kLobeWidths[k].name << ": " << photons.mean << " +- " << photons.standard_error
            << ", " << reference.mean << " +- " << reference.standard_error;
        EXPECT_LT(3 * error.standard_error, 0.05 * reference.mean) << "the test would see nothing";
    }
}

TEST_F(PhotonChannel, WeighsPhotonsOfOtherMapsToTheSameLight) {
    const Runs other = run(channel_->guide, 2);
    for (std::size_t k = 0; k < kNumPatches; ++k) {
        const SampleMean error =
            difference(estimate_of(other.irradiance[k]), estimate_of(own_.irradiance[k]));
        const double mean = estimate_of(own_.irradiance[k]).mean;
        EXPECT_TRUE(agrees(error, 0)) << "patch " << k;
        EXPECT_LT(3 * error.standard_error, 0.02 * mean) << "the test would see nothing";
    }
}

struct PhotonLight {
    PhotonPaths paths;
    PhotonPower power;
    std::vector<IndirectIrradiance> irradiance;

    explicit PhotonLight(const GlossyChannel& channel)
        : paths(channel.trace(channel.guide, 30'000, 3)),
          power(photon_power(paths, channel.maps)),
          irradiance(indirect_irradiance(channel.kernel, paths, power.arrivals)) {}
};

void expect_same_bytes(const PhotonLight& a, const PhotonLight& b) {
    ASSERT_GT(a.paths.bounces.size(), 10'000U);
    EXPECT_TRUE(same_bytes(a.paths.bounces, b.paths.bounces));
    EXPECT_TRUE(same_bytes(a.paths.arrivals_begin, b.paths.arrivals_begin));
    EXPECT_TRUE(same_bytes(a.paths.arrival_direction, b.paths.arrival_direction));
    EXPECT_TRUE(same_bytes(a.power.arrivals, b.power.arrivals));
    EXPECT_EQ(a.power.by_bounce, b.power.by_bounce);
    EXPECT_TRUE(same_bytes(a.irradiance, b.irradiance));
}

TEST_F(PhotonChannel, IsTheSameForAnyNumberOfThreads) {
    const auto light = [&](int threads) {
        const ThreadLimit limit(threads);
        return PhotonLight(*channel_);
    };
    expect_same_bytes(light(1), light(2));
}

TEST_F(PhotonChannel, IsTheSameWithAvx512AndWithout) {
    if (!takes_avx512()) GTEST_SKIP() << "this machine has no AVX-512";
    const PhotonLight wide(*channel_);
    const NarrowCode narrow_code;
    ASSERT_FALSE(takes_avx512());
    expect_same_bytes(wide, PhotonLight(*channel_));
}

// --- A closed box --------------------------------------------------------------------------------

class ClosedBox : public testing::TestWithParam<double> {};

TEST_P(ClosedBox, LosesAtEachBounceWhatIsAbsorbed) {
    // Photons start in proportion to the light sent on, so that each carries the same power, and
    // survive with the guide's albedo g: after k more reflections N g^k are left, a binomial
    // number, and each carries (a / g)^k.
    constexpr double kGuideAlbedo = 0.6;
    const double albedo = GetParam();
    const LitScene scene(inward_box(Vec3(1, 2, 1.5)), {}, {point_light(Vec3(0.4, 0.7, 1), 2)});
    const TexelAtlas atlas = build_atlas(scene.mesh, 30, 20);
    const auto direct = direct_light(scene.surface(), atlas, scene.lights.front());
    LampSet lamps;
    lamps.lights = {&scene.lights.front()};
    lamps.direct = {&direct};
    double flux = 0;  // on the texels, all channels
    for (std::size_t i = 0; i < direct.size(); ++i) {
        flux += double(direct[i].irradiance.sum()) * atlas.texels[i].area;
    }
    const std::vector<Reflectance> guide(atlas.texels.size(), lambertian(kGuideAlbedo));
    const std::vector<Reflectance> maps(atlas.texels.size(), lambertian(albedo));
    PhotonOptions options;
    options.photons = 100'000;
    Progress progress;
    const PhotonPaths paths =
        trace_photons(PhotonScene(scene.surface(), atlas, guide), lamps, options, 0, progress);
    const PhotonPower power = photon_power(paths, maps);
    // Each weight rounds by 1e-7; rays that slip through an edge of the box are fewer than 1e-5.
    constexpr double kLoss = 2e-5;
    for (int k = 0; k < 10; ++k) {
        const double alive = std::pow(kGuideAlbedo, k);
        const double standard_error = std::sqrt((1 - alive) / (alive * double(options.photons)));
        const double ratio = power.by_bounce.at(std::size_t(k)) / (flux * std::pow(albedo, k + 1));
        EXPECT_NEAR(ratio, 1, kLoss * (k + 1) + normal_threshold() * standard_error) << k;
    }
}

INSTANTIATE_TEST_SUITE_P(Albedos, ClosedBox, testing::Values(0.6, 0.3, 0.8));

// --- A scanned object under a lamp that turns ----------------------------------------------------

TEST(TurningLamp, LightsEveryColumnFromItsOwnAzimuth) {
    constexpr double kWindow = radians(10.0);
    Light lamp = point_light(Vec3(0.5, 0.7, 4), 10);
    lamp.frame = FrameOfReference::scanner;
    const Reflectance material{Rgb(0.6, 0.5, 0.4), 1, 0.3};
    const LitScene scene(FlutedColumn::mesh(), material, {lamp});
    const TexelAtlas atlas = FlutedColumn::atlas(scene.mesh);
    const auto direct = direct_light(scene.surface(), atlas, scene.lights.front());
    LampSet lamps;
    lamps.lights = {&scene.lights.front()};
    lamps.direct = {&direct};
    lamps.turns_with_scanner = true;
    const std::vector<Reflectance> maps(atlas.texels.size(), material);
    // Columns deep in a flute (about longitude 60 degrees), the same in all three.
    const std::vector<TexelId> flute = FlutedColumn::flute(atlas, 17, 25);
    PhotonOptions options;
    options.photons = 12'288;
    options.azimuth_window = kWindow;
    std::vector<double> runs;
    Progress progress;
    const PhotonScene photon_scene(scene.surface(), atlas, maps);
    for (std::size_t run = 0; run < kNumRuns; ++run) {
        options.seed = run;
        const PhotonPaths paths = trace_photons(photon_scene, lamps, options, 0, progress);
        const PhotonPower power = photon_power(paths, maps);
        runs.push_back(mean_over(flute, [&](TexelId texel) {
            double sum = 0;
            for (std::uint32_t k = paths.arrivals_begin[texel]; k < paths.arrivals_begin[texel + 1];
                 ++k) {
                sum += double(power.arrivals[k].mean());
            }
            return sum / atlas.texels[texel].area;
        }));
    }
    // H in the flute's columns when the lamp stands `offset` beside them.
    const auto reference_at = [&](double offset, std::uint64_t seed) {
        return randomised_mean(128, 512, seed, [&](SobolSampler& sampler) {
            const Texel& texel = atlas.texels[random_texel(flute, sampler)];
            const auto [u, v] = sampler.next_pair();
            const Triangle& t = scene.mesh.triangles[2 * std::size_t(texel.column)];
            SurfacePoint point = texel.point;
            point.position +=
                (u - 0.5) *
                    (scene.mesh.positions[t[1]] - scene.mesh.positions[t[0]]).cast<double>() +
                (v - 0.5) / FlutedColumn::kRows * Vec3::UnitY();
            return trace_indirect_irradiance(scene.surface(),
                                             scene.field(),
                                             scene.lights,
                                             texel.azimuth + offset,
                                             point,
                                             {},
                                             sampler)
                .mean();
        });
    };
    const SampleMean reference = reference_at(0, 1);
    // The window's variance is w^2 / 5, so that it errs by w^2 / 10 |H''|; H'' w^2 as the second
    // difference over the window.
    const SampleMean before = reference_at(-kWindow, 2);
    const SampleMean after = reference_at(kWindow, 3);
    const double window_bias = std::abs(before.mean - 2 * reference.mean + after.mean) / 10;
    // As in the channel: sums over texel centres, h = 0.08 on the flanks, of what lies at a
    // distance of about 0.4 and is as wide as the lobe, sigma = 0.3, makes it.
    const double start_bias = texel_centre_bias(0.08, 0.3, 0.4) * reference.mean;
    const SampleMean photons = estimate_of(runs);
    const SampleMean error = difference(photons, reference);
    EXPECT_TRUE(agrees(error, 0, window_bias + start_bias))
        << photons.mean << " +- " << photons.standard_error << ", " << reference.mean << " +- "
        << reference.standard_error;
    EXPECT_LT(window_bias + 3 * error.standard_error, 0.1 * reference.mean)
        << "the test would see nothing";
}

}  // namespace
}  // namespace patina
