#include "patina/transport/gather_sweep.h"

#include <gtest/gtest.h>

#include "support/channel.h"
#include "support/gathered_light.h"
#include "support/same_bytes.h"
#include <cmath>
#include <memory>
#include <tuple>

namespace patina {
namespace {

// Sums in single precision: 6e-8 for each of some hundred additions; and what every texel sends on
// is held in 16 bits, here the same number in all of them.
constexpr double kRounding = 1e-5 + kCompactRounding;

// --- Diffuse light of known form -----------------------------------------------------------------

// Form factor from a point with the normal n to a polygon in front of it, counterclockwise as seen
// from there. Lambert, Photometria, 1760.
double form_factor(const Vec3& point, const Vec3& n, const std::vector<Vec3>& polygon) {
    double sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 a = (polygon[i] - point).normalized();
        const Vec3 b = (polygon[(i + 1) % polygon.size()] - point).normalized();
        sum += std::atan2(a.cross(b).norm(), a.dot(b)) * n.dot(a.cross(b).normalized());
    }
    return sum / (2 * kPi);
}

// A floor that is lit evenly, from straight above, and a wall that only the floor lights.
class LitFloor : public testing::Test {
  protected:
    static constexpr double kAlbedo = 0.6;
    static constexpr double kIrradiance = 2.5;

    LitFloor() {
        for (std::size_t i = 0; i < atlas_.texels.size(); ++i) {
            if (atlas_.texels[i].point.normal.x() > 0.5) wall_.push_back(TexelId(i));
        }
    }
    [[nodiscard]] double exact(TexelId texel) const {
        static const std::vector<Vec3> kFloor = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
        return kAlbedo * kIrradiance *
               form_factor(atlas_.texels[texel].point.position, Vec3::UnitX(), kFloor);
    }

    LitScene scene_{
        perpendicular_unit_squares(), {}, {directional_light(Vec3::UnitZ(), kIrradiance)}};
    TexelAtlas atlas_ = build_atlas(scene_.mesh, 24, 48);
    std::vector<std::vector<DirectLight>> direct_{
        direct_light(scene_.surface(), atlas_, scene_.lights.front())};
    std::vector<Reflectance> maps_ =
        std::vector<Reflectance>(atlas_.texels.size(), lambertian(kAlbedo));
    GatheredLight light_{
        scene_.surface(), atlas_, lamp_block(scene_.lights, direct_), maps_, GatherOptions{}};
    std::vector<TexelId> wall_;
};

TEST_F(LitFloor, LightsTheWallByItsFormFactor) {
    // Each texel's rays are its own, so the errors of the texels are independent.
    light_.sweep(1);
    std::vector<double> errors;
    double mean = 0;
    for (const TexelId texel : wall_) {
        errors.push_back(light_.irradiance(texel) - exact(texel));
        mean += exact(texel) / double(wall_.size());
    }
    const SampleMean error = estimate_of(errors);
    EXPECT_TRUE(agrees(error, 0, kRounding * mean));
    EXPECT_LT(error.standard_error, 0.005 * mean) << "the test would see nothing";
}

TEST_F(LitFloor, ShowsItsNoiseInTheDifferenceOfTheHalves) {
    // The halves are nets of Sobol points that complete each other: their mean is at least as good
    // as that of independent halves, whose variance their difference shows.
    light_.sweep(1);
    std::vector<double> excess;
    std::vector<double> half_errors;
    for (const TexelId texel : wall_) {
        const double first = light_.half(0, texel);
        const double second = light_.half(1, texel);
        const double variance = square(0.5 * (first - second));
        excess.push_back(square(light_.irradiance(texel) - exact(texel)) - variance);
        half_errors.push_back(first - exact(texel));
    }
    const SampleMean over = estimate_of(excess);
    EXPECT_LT(over.mean, over.standard_error * student_threshold(double(over.count - 1)));
    EXPECT_TRUE(agrees(estimate_of(half_errors), 0, kRounding));
}

TEST(ClosedRoom, FillsWithLightGeometrically) {
    // Under the same irradiance E everywhere, n sweeps leave E (rho + ... + rho^n) everywhere,
    // whatever the rays are, since all of them meet the same light. The limit is rho E / (1 - rho).
    const LitScene scene(inward_box(Vec3(1, 2, 1.5)), {}, {directional_light(Vec3::UnitZ(), 2)});
    const TexelAtlas atlas = build_atlas(scene.mesh, 30, 20);
    DirectLight even;
    even.irradiance = Rgbf::Constant(2);
    even.cos_i = 1;
    const std::vector<std::vector<DirectLight>> direct = {
        std::vector<DirectLight>(atlas.texels.size(), even)};
    const Rgb albedo(0.3, 0.6, 0.8);
    const std::vector<Reflectance> maps(atlas.texels.size(), {albedo, 0, 0.2});
    GatheredLight light(
        scene.surface(), atlas, lamp_block(scene.lights, direct), maps, GatherOptions{});
    // Rays that slip through an edge of the box are fewer than 1e-5.
    constexpr double kLoss = 1e-5;
    Rgb expected = Rgb::Zero();  // of a lamp of unit strength
    for (int n = 1; n <= 30; ++n) {
        light.sweep(1);
        expected = albedo * (1 + expected);
        Rgb mean = Rgb::Zero();
        for (const auto& lanes : light.halves()[0]) {
            mean += Rgb(lanes[0][0], lanes[1][0], lanes[2][0]) / double(atlas.texels.size());
        }
        for (Eigen::Index c = 0; c < 3; ++c) {
            EXPECT_NEAR(mean[c] / expected[c], 1, std::min(n, 5) * (kLoss + kRounding))
                << "sweep " << n << ", channel " << c;
        }
    }
    EXPECT_NEAR(expected[2], 0.8 / 0.2, 4 * std::pow(0.8, 30)) << "has not converged";
}

TEST(ConvexObject, GathersNothing) {
    const Reflectance material{Rgb(0.5, 0.5, 0.5), 0.5, 0.2};
    const LitScene scene(sphere(1, 32, 16, SphereSide::outward, true),
                         material,
                         {directional_light(Vec3::UnitZ(), 1)});
    const TexelAtlas atlas = build_atlas(scene.mesh, 48, 24);
    const std::vector<std::vector<DirectLight>> direct = {
        direct_light(scene.surface(), atlas, scene.lights.front())};
    const std::vector<Reflectance> maps(atlas.texels.size(), material);
    ViewDirections view;
    for (const Texel& texel : atlas.texels) view.push_back(texel.point.normal.cast<float>());
    GatheredLight light(scene.surface(),
                        atlas,
                        lamp_block(scene.lights, direct),
                        maps,
                        GatherOptions{},
                        std::span(&view, 1));
    light.sweep(2);
    EXPECT_TRUE(light.graph().irradiance.hits.empty());
    EXPECT_TRUE(light.graph().lobes.front().hits.empty());
    for (TexelId texel = 0; texel < atlas.texels.size(); ++texel) {
        EXPECT_EQ(light.irradiance(texel), 0);
        EXPECT_EQ(light.lobe(texel, view[texel], 0.2), (std::array<double, 3>{}));
    }
}

// --- A channel of three glossy plates ------------------------------------------------------------

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
    const ReflectanceField field =
        ReflectanceField::per_texel(channel_->scene.mesh, channel_->atlas, channel_->maps);
    const std::vector<TexelId> looked_at = channel_->looked_at();
    const double sigma = channel_->maps[looked_at.front()].roughness;
    for (std::size_t k = 0; k < kLobeWidths.size(); ++k) {
        const auto reference_of = [&](bool with_indirect) {
            return randomised_mean(128, 1024, k, [&](SobolSampler& sampler) {
                const TexelId texel = random_texel(looked_at, sampler);
                const OutgoingRadiance radiance =
                    sample_through_lobe(channel_->scene,
                                        field,
                                        channel_->atlas.texels[texel].point,
                                        Channel::towards_camera(),
                                        kLobeWidths[k].factor * sigma,
                                        sampler);
                return (radiance.direct + (with_indirect ? 1.0 : 0.0) * radiance.indirect).mean();
            });
        };
        // Where the widest lobe has fallen below 1 %, light is left out: 1 % of the lobe's.
        const double left_out = kLobeWidths[k].factor == 2 ? 0.01 : 0.0;
        const std::string name = kLobeWidths[k].name;
        const std::vector<double>& first = (*runs_)[0].lobe[k];
        const std::vector<double>& converged = (*runs_)[1].lobe[k];
        expect_close(first, reference_of(false), kChannelBias + left_out, name + ", first bounce");
        expect_close(converged,
                     reference_of(true),
                     kChannelBias + left_out + spread_bias(first, converged),
                     name + ", converged");
    }
}

TEST_F(GatherChannel, IsTheSameForAnyNumberOfThreads) {
    const auto light = [&](int threads) {
        const ThreadLimit limit(threads);
        GatheredLight result = gather(GatherOptions{});
        result.sweep(2);
        return result;
    };
    const GatheredLight one = light(1);
    const GatheredLight two = light(2);
    ASSERT_GT(one.graph().irradiance.hits.size(), 10'000U);
    ASSERT_GT(one.graph().lobes.front().hits.size(), 1'000U);
    EXPECT_TRUE(same_bytes(one.graph().irradiance.begin, two.graph().irradiance.begin));
    EXPECT_TRUE(same_bytes(one.graph().irradiance.hits, two.graph().irradiance.hits));
    EXPECT_TRUE(same_bytes(one.graph().lobes.front().hits, two.graph().lobes.front().hits));
    ASSERT_GT(one.graph().irradiance.glossy.size(), 1'000U);
    EXPECT_TRUE(same_bytes(one.graph().irradiance.glossy, two.graph().irradiance.glossy));
    for (const std::size_t half : {0U, 1U}) {
        EXPECT_TRUE(same_bytes(one.halves()[half], two.halves()[half]));
    }
}

}  // namespace
}  // namespace patina
