#include "patina/transport/photon_paths.h"

#include "patina/transport/path_tracer.h"
#include "patina/transport/ratio_kernel.h"

#include <gtest/gtest.h>

#include "support/lit_scene.h"
#include "support/scenes.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>

namespace patina {
namespace {

// --- A channel of three glossy plates ------------------------------------------------------------

constexpr int kSide = 32;              // texels along a plate's side
constexpr int kPitch = kSide + 4;      // columns from plate to plate
constexpr std::size_t kNumRuns = 128;  // independent sets of photons
constexpr double kNarrowest = 0.15;    // sigma of the right wall [rad]

// Plates of 32 x 32 texels; texel borders are cell borders.
UvRectangle plate_uv(int plate) {
    const double width = 3 * kPitch;
    return {Vec2(plate * kPitch / width, 0), Vec2((plate * kPitch + kSide) / width, 1)};
}

// A floor between two walls, with gaps in the corners: light that a texel sends on is computed for
// its centre, which is wrong close to an edge. Two lamps above, nothing shadowed.
struct Channel {
    enum Plate { floor, left, right };

    LitScene scene = [] {
        Mesh mesh = rectangle({-0.35, 0, 0}, {0.7, 0, 0}, Vec3::UnitY(), plate_uv(floor));
        append(mesh, rectangle({-0.5, 0, 0.2}, Vec3::UnitY(), {0, 0, 0.8}, plate_uv(left)));
        append(mesh, rectangle({0.5, 1, 0.2}, -Vec3::UnitY(), {0, 0, 0.8}, plate_uv(right)));
        return LitScene(
            mesh, {}, {point_light(Vec3(-0.1, 0.4, 1.6), 1), point_light(Vec3(0.1, 0.7, 1.8), 2)});
    }();
    TexelAtlas atlas = build_atlas(scene.mesh, 3 * kPitch, kSide);
    std::vector<std::vector<DirectLight>> direct;
    LampSet lamps;
    RatioKernel kernel;
    std::vector<Reflectance> maps;   // what the surfaces are
    std::vector<Reflectance> guide;  // something else

    Channel() {
        for (const Light& light : scene.lights) {
            direct.push_back(direct_light(scene.surface(), atlas, light));
            lamps.lights.push_back(&light);
        }
        for (const auto& lamp : direct) lamps.direct.push_back(&lamp);
        // A kernel that does not depend on the photons keeps the estimate linear in their power.
        RatioKernelOptions options;
        options.arrivals = 1e-9;
        options.min_radius = options.max_radius = 2;
        kernel = build_ratio_kernel(atlas, std::vector<double>(atlas.texels.size(), 1.0), options);
        const std::array<Reflectance, 3> of_plate = {
            Reflectance{Rgb(0.5, 0.4, 0.3), 0.8, 0.25},
            Reflectance{Rgb(0.2, 0.3, 0.4), 1.0, 0.3},
            Reflectance{Rgb(0.3, 0.2, 0.3), 4.0, kNarrowest},
        };
        for (const Texel& texel : atlas.texels) {
            maps.push_back(of_plate[std::size_t(texel.column / kPitch)]);
            guide.push_back({Rgb(0.5, 0.5, 0.3), 0.5, 0.3});
        }
    }

    [[nodiscard]] PhotonPaths trace(std::span<const Reflectance> guides,
                                    std::uint64_t photons,
                                    std::uint64_t seed) const {
        PhotonOptions options;
        options.photons = photons;
        options.seed = seed;
        Progress progress;
        return trace_photons(scene.surface(), atlas, lamps, guides, options, 0, progress);
    }
    // Texels of a plate; columns and rows from begin to end - 1, counted from the plate's corner.
    [[nodiscard]] std::vector<TexelId> patch(
        Plate plate, int column_begin, int column_end, int row_begin, int row_end) const {
        std::vector<TexelId> texels;
        for (int row = row_begin; row < row_end; ++row) {
            for (int column = column_begin; column < column_end; ++column) {
                texels.push_back(
                    atlas.cell_texel[std::size_t(row * atlas.width + plate * kPitch + column)]);
            }
        }
        return texels;
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

// Light sent on is summed over texel centres. By Euler and Maclaurin that differs from the integral
// by h^2 / 24 times the difference of the first derivative at the ends, in either direction. The
// sharpest function is the image of a lobe, a Gaussian of the width s = sigma D, whose derivative
// is at most 0.242 / s^2 of its integral; with two ends and two directions 4 x 0.242 / 24 (h /
// s)^2. h: side of a texel, 1/32; D: mean distance between the plates, 0.7 or more.
const double kStartBias = 4 * 0.242 / 24 * square(1.0 / kSide / (kNarrowest * 0.7));

double mean_over(const std::vector<TexelId>& patch, const auto& value) {
    double sum = 0;
    for (const TexelId texel : patch) sum += value(texel);
    return sum / double(patch.size());
}

struct LobeWidth {
    const char* name;
    double factor;  // of sigma
    Rgbf IndirectLobe::*member;
};
constexpr std::array<LobeWidth, 3> kLobeWidths = {{{"half", 0.5, &IndirectLobe::half},
                                                   {"same", 1.0, &IndirectLobe::same},
                                                   {"twice", 2.0, &IndirectLobe::twice}}};

// The photons of all runs, in numbers: what the tests of the channel compare.
class PhotonChannel : public testing::Test {
  protected:
    // The floor in two halves, and the walls.
    static constexpr std::size_t kNumPatches = 4;
    struct Runs {
        std::array<std::vector<double>, kNumPatches> irradiance;
        std::array<std::vector<double>, kLobeWidths.size()> lobe;
    };

    static void SetUpTestSuite() {
        channel_ = std::make_unique<Channel>();
        patches_ = {channel_->patch(Channel::floor, 0, 16, 0, kSide),
                    channel_->patch(Channel::floor, 16, 32, 0, kSide),
                    channel_->patch(Channel::left, 0, kSide, 0, kSide),
                    channel_->patch(Channel::right, 0, kSide, 0, kSide)};
        looked_at_ = channel_->patch(Channel::floor, 8, 24, 8, 24);
        own_ = run(channel_->maps, 1);
    }
    static void TearDownTestSuite() { channel_.reset(); }

    // Photons that follow `guide`, weighted for the channel's maps.
    static Runs run(std::span<const Reflectance> guide, std::uint64_t seed) {
        Runs runs;
        const std::size_t num_texels = channel_->atlas.texels.size();
        std::vector<std::uint8_t> wanted(num_texels, 0);
        for (const TexelId texel : looked_at_) wanted[texel] = 1;
        const std::vector<Vec3f> w_v(num_texels, towards_camera().cast<float>());
        for (std::size_t i = 0; i < kNumRuns; ++i) {
            const PhotonPaths paths = channel_->trace(guide, 8192, seed * kNumRuns + i);
            const PhotonPower power = photon_power(paths, channel_->maps);
            const IndirectIrradiance irradiance =
                indirect_irradiance(channel_->kernel, paths, power.arrivals);
            for (std::size_t k = 0; k < kNumPatches; ++k) {
                runs.irradiance[k].push_back(mean_over(
                    patches_[k], [&](TexelId texel) { return irradiance.mean(texel).mean(); }));
            }
            const std::vector<IndirectLobe> lobe = indirect_lobe(channel_->kernel,
                                                                 paths,
                                                                 power.arrivals,
                                                                 channel_->atlas,
                                                                 w_v,
                                                                 channel_->maps,
                                                                 wanted);
            for (std::size_t k = 0; k < kLobeWidths.size(); ++k) {
                runs.lobe[k].push_back(mean_over(looked_at_, [&](TexelId texel) {
                    return double((lobe[texel].*kLobeWidths[k].member).mean());
                }));
            }
        }
        return runs;
    }

    // Its mirror image is seen in the left wall's middle.
    static Vec3 towards_camera() { return Vec3(0.6, 0.1, 0.8).normalized(); }

    static std::unique_ptr<Channel> channel_;
    static std::array<std::vector<TexelId>, kNumPatches> patches_;
    static std::vector<TexelId> looked_at_;
    static Runs own_;
};

std::unique_ptr<Channel> PhotonChannel::channel_;
std::array<std::vector<TexelId>, PhotonChannel::kNumPatches> PhotonChannel::patches_;
std::vector<TexelId> PhotonChannel::looked_at_;
PhotonChannel::Runs PhotonChannel::own_;

Estimate difference(const Estimate& a, const Estimate& b) {
    return {a.mean - b.mean,
            std::hypot(a.standard_error, b.standard_error),
            std::min(a.count, b.count)};
}

TexelId random_texel(const std::vector<TexelId>& patch, SobolSampler& sampler) {
    const auto [choice, unused] = sampler.next_pair();
    return patch[std::min(std::size_t(choice * double(patch.size())), patch.size() - 1)];
}

TEST_F(PhotonChannel, HasTheIrradianceOfThePathTracer) {
    const Channel& channel = *channel_;
    const ReflectanceField field =
        ReflectanceField::per_texel(channel.scene.mesh, channel.atlas, channel.maps);
    for (std::size_t k = 0; k < kNumPatches; ++k) {
        const Estimate reference = randomised_mean(128, 2048, k, [&](SobolSampler& sampler) {
            const TexelId texel = random_texel(patches_[k], sampler);
            const SurfacePoint point = channel.point_in_kernel(texel, sampler);
            return trace_indirect_irradiance(
                       channel.scene.surface(), field, channel.scene.lights, 0, point, {}, sampler)
                .mean();
        });
        const Estimate photons = estimate_of(own_.irradiance[k]);
        const Estimate error = difference(photons, reference);
        EXPECT_TRUE(agrees(error, 0, kStartBias * reference.mean))
            << "patch " << k << ": " << photons.mean << " +- " << photons.standard_error << ", "
            << reference.mean << " +- " << reference.standard_error;
        EXPECT_LT(3 * error.standard_error, 0.02 * reference.mean) << "the test would see nothing";
    }
}

TEST_F(PhotonChannel, IsSeenThroughTheLobeAsThePathTracerSeesIt) {
    // Directions drawn from the lobe itself, the radiance they meet by path tracing.
    const Channel& channel = *channel_;
    const ReflectanceField field =
        ReflectanceField::per_texel(channel.scene.mesh, channel.atlas, channel.maps);
    const double sigma = channel.maps[looked_at_.front()].roughness;
    for (std::size_t k = 0; k < kLobeWidths.size(); ++k) {
        const Reflectance lobe{Rgb::Zero(), 1, kLobeWidths[k].factor * sigma};
        const Estimate reference = randomised_mean(128, 512, k, [&](SobolSampler& sampler) {
            const TexelId texel = random_texel(looked_at_, sampler);
            const SurfacePoint point = channel.point_in_kernel(texel, sampler);
            const LobeSample sample =
                sample_lobe(lobe, point.normal, towards_camera(), 0, sampler.next_pair());
            if (sample.pdf <= 0) return 0.0;
            const auto hit = channel.scene.tracer.intersect(
                channel.scene.tracer.offset(point, sample.w_o), sample.w_o);
            if (!hit) return 0.0;
            const OutgoingRadiance radiance =
                trace_path(channel.scene.surface(),
                           field,
                           channel.scene.lights,
                           0,
                           surface_point(channel.scene.mesh, hit->triangle, hit->barycentric),
                           -sample.w_o,
                           {},
                           sampler);
            return kPi * (sample.weight * (radiance.direct + radiance.indirect)).mean() /
                   square(lobe.roughness);
        });
        const Estimate photons = estimate_of(own_.lobe[k]);
        const Estimate error = difference(photons, reference);
        // Arrivals beyond three sigma of the widest lobe are left out: exp(-9/2) of its light.
        const double left_out = kLobeWidths[k].factor == 2 ? std::exp(-4.5) : 0.0;
        EXPECT_TRUE(agrees(error, 0, (kStartBias + left_out) * reference.mean))
            << kLobeWidths[k].name << ": " << photons.mean << " +- " << photons.standard_error
            << ", " << reference.mean << " +- " << reference.standard_error;
        EXPECT_LT(3 * error.standard_error, 0.05 * reference.mean) << "the test would see nothing";
    }
}

TEST_F(PhotonChannel, WeighsPhotonsOfOtherMapsToTheSameLight) {
    const Runs other = run(channel_->guide, 2);
    for (std::size_t k = 0; k < kNumPatches; ++k) {
        const Estimate error =
            difference(estimate_of(other.irradiance[k]), estimate_of(own_.irradiance[k]));
        const double mean = estimate_of(own_.irradiance[k]).mean;
        EXPECT_TRUE(agrees(error, 0)) << "patch " << k;
        EXPECT_LT(3 * error.standard_error, 0.02 * mean) << "the test would see nothing";
    }
}

template <typename Value>
bool same_bytes(const std::vector<Value>& a, const std::vector<Value>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Value)) == 0;
}

TEST_F(PhotonChannel, IsTheSameForAnyNumberOfThreads) {
    struct Light {
        PhotonPaths paths;
        PhotonPower power;
        IndirectIrradiance irradiance;
    };
    const auto light = [&](int threads) {
        const ThreadLimit limit(threads);
        Light result;
        result.paths = channel_->trace(channel_->guide, 30'000, 3);
        result.power = photon_power(result.paths, channel_->maps);
        result.irradiance =
            indirect_irradiance(channel_->kernel, result.paths, result.power.arrivals);
        return result;
    };
    const Light one = light(1);
    const Light two = light(2);
    ASSERT_GT(one.paths.bounces.size(), 10'000U);
    EXPECT_TRUE(same_bytes(one.paths.bounces, two.paths.bounces));
    EXPECT_TRUE(same_bytes(one.paths.arrivals_begin, two.paths.arrivals_begin));
    EXPECT_TRUE(same_bytes(one.paths.arrival_direction, two.paths.arrival_direction));
    EXPECT_TRUE(same_bytes(one.power.arrivals, two.power.arrivals));
    EXPECT_EQ(one.power.by_bounce, two.power.by_bounce);
    for (int half = 0; half < 2; ++half) {
        EXPECT_TRUE(same_bytes(one.irradiance.halves[half], two.irradiance.halves[half]));
    }
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
        trace_photons(scene.surface(), atlas, lamps, guide, options, 0, progress);
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

// A fluted column about the y axis, radius 1 + 0.4 cos(3 longitude), height 1.
constexpr int kColumns = 126;
constexpr int kRows = 20;

Mesh fluted_column() {
    Mesh mesh;
    for (int row = 0; row <= 1; ++row) {
        for (int column = 0; column <= kColumns; ++column) {
            const double longitude = 2 * kPi * (column % kColumns) / kColumns;
            const double radius = 1 + 0.4 * std::cos(3 * longitude);
            mesh.positions.push_back(rotate_about_y(longitude, Vec3(0, row, radius)).cast<float>());
            mesh.normals.push_back(Vec3f::Zero());
            mesh.uvs.emplace_back(float(column) / kColumns, float(row));
        }
    }
    for (std::uint32_t i = 0; i < kColumns; ++i) {
        const std::uint32_t above = i + kColumns + 1;
        mesh.triangles.push_back({i, i + 1, above + 1});
        mesh.triangles.push_back({i, above + 1, above});
    }
    return mesh;
}

TEST(TurningLamp, LightsEveryColumnFromItsOwnAzimuth) {
    constexpr double kWindow = radians(10.0);
    Light lamp = point_light(Vec3(0.5, 0.7, 4), 10);
    lamp.frame = FrameOfReference::scanner;
    const Reflectance material{Rgb(0.6, 0.5, 0.4), 1, 0.3};
    const LitScene scene(fluted_column(), material, {lamp});
    TexelAtlas atlas = build_atlas(scene.mesh, kColumns, kRows);
    for (Texel& texel : atlas.texels) texel.azimuth = 2 * kPi * (texel.column + 0.5) / kColumns;
    const auto direct = direct_light(scene.surface(), atlas, scene.lights.front());
    LampSet lamps;
    lamps.lights = {&scene.lights.front()};
    lamps.direct = {&direct};
    lamps.turns_with_scanner = true;
    const std::vector<Reflectance> maps(atlas.texels.size(), material);
    // Columns deep in a flute (about longitude 60 degrees), the same in all three.
    std::vector<TexelId> flute;
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        const int column = atlas.texels[i].column % (kColumns / 3);
        if (column >= 17 && column < 25) flute.push_back(TexelId(i));
    }
    PhotonOptions options;
    options.photons = 12'288;
    options.azimuth_window = kWindow;
    std::vector<double> runs;
    Progress progress;
    for (std::size_t run = 0; run < kNumRuns; ++run) {
        options.seed = run;
        const PhotonPaths paths =
            trace_photons(scene.surface(), atlas, lamps, maps, options, 0, progress);
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
                (v - 0.5) / kRows * Vec3::UnitY();
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
    const Estimate reference = reference_at(0, 1);
    // The window's variance is w^2 / 5, so that it errs by w^2 / 10 |H''|; H'' w^2 as the second
    // difference over the window.
    const Estimate before = reference_at(-kWindow, 2);
    const Estimate after = reference_at(kWindow, 3);
    const double window_bias = std::abs(before.mean - 2 * reference.mean + after.mean) / 10;
    // As in the channel: sums over texel centres, h = 0.08 on the flanks, of what lies at a
    // distance of about 0.4 and is as wide as the lobe, sigma = 0.3, makes it.
    const double start_bias = 4 * 0.242 / 24 * square(0.08 / (0.3 * 0.4)) * reference.mean;
    const Estimate photons = estimate_of(runs);
    const Estimate error = difference(photons, reference);
    EXPECT_TRUE(agrees(error, 0, window_bias + start_bias))
        << photons.mean << " +- " << photons.standard_error << ", " << reference.mean << " +- "
        << reference.standard_error;
    EXPECT_LT(window_bias + 3 * error.standard_error, 0.1 * reference.mean)
        << "the test would see nothing";
}

}  // namespace
}  // namespace patina
