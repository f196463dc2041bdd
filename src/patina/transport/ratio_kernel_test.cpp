#include "patina/transport/ratio_kernel.h"

#include "patina/base/parallel.h"
#include "patina/base/random.h"

#include <gtest/gtest.h>

#include "support/false_alarms.h"
#include "support/scenes.h"
#include <cmath>

namespace patina {
namespace {

// Weights are stored in single precision: each rounds by 6e-8, relatively.
constexpr double kFloatError = 2e-7;

struct KernelScene {
    const char* name;
    Mesh mesh;
    int width;
    int height;
};

// Two halves of a unit square in the plane z = 0 that lie `gap` apart along x and `step` along z;
// their charts touch in the uv domain, as on both sides of a step of a range image.
Mesh two_halves(double gap, double step) {
    Mesh mesh = rectangle(Vec3::Zero(), {0.5, 0, 0}, Vec3::UnitY(), {{0, 0}, {0.5, 1}});
    append(mesh, rectangle({0.5 + gap, 0, step}, {0.5, 0, 0}, Vec3::UnitY(), {{0.5, 0}, {1, 1}}));
    return mesh;
}

// The whole square, its halves in charts of 12 x 24 texels of 28 x 24, four columns apart.
constexpr int kSeamWidth = 28;
Mesh seam() {
    Mesh mesh =
        rectangle(Vec3::Zero(), {0.5, 0, 0}, Vec3::UnitY(), {{0, 0}, {12.0 / kSeamWidth, 1}});
    append(mesh,
           rectangle({0.5, 0, 0}, {0.5, 0, 0}, Vec3::UnitY(), {{16.0 / kSeamWidth, 0}, {1, 1}}));
    return mesh;
}

// One ridge along y between two squares that fall off to both sides at 45 degrees.
Mesh convex_edge() {
    const Vec3 left = Vec3(-1, 0, -1).normalized();
    const Vec3 right = Vec3(1, 0, -1).normalized();
    Mesh mesh = rectangle(left, -left, Vec3::UnitY(), {{0, 0}, {0.5, 1}});
    append(mesh, rectangle(Vec3::Zero(), right, Vec3::UnitY(), {{0.5, 0}, {1, 1}}));
    return mesh;
}

std::vector<KernelScene> kernel_scenes() {
    return {{"seam", seam(), kSeamWidth, 24},
            {"gap", two_halves(0.5, 0), 24, 24},
            {"step", two_halves(0, -0.3), 24, 24},
            {"concave corner", perpendicular_unit_squares(), 24, 48},
            {"convex edge", convex_edge(), 48, 24},
            {"box", inward_box(Vec3(1, 2, 1.5)), 60, 40},
            {"smooth sphere", sphere(1, 32, 16, SphereSide::inward, true), 48, 24}};
}

std::vector<double> arrivals_of(const TexelAtlas& atlas, double value) {
    return std::vector<double>(atlas.texels.size(), value);
}

TEST(RatioKernel, WeightsTimesAreasAddUpToOne) {
    for (const KernelScene& scene : kernel_scenes()) {
        const TexelAtlas atlas = build_atlas(scene.mesh, scene.width, scene.height);
        const RatioKernel kernel = build_ratio_kernel(atlas, arrivals_of(atlas, 5), {});
        ASSERT_EQ(kernel.begin.size(), atlas.texels.size() + 1) << scene.name;
        for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
            double sum = 0;
            for (std::size_t k = kernel.begin[i]; k < kernel.begin[i + 1]; ++k) {
                EXPECT_GT(kernel.weight[k], 0.0F);
                sum += double(kernel.weight[k]) * atlas.texels[kernel.texel[k]].area;
            }
            EXPECT_NEAR(sum, 1, kFloatError) << scene.name << ", texel " << i;
        }
    }
}

TEST(RatioKernel, MakesAUniformDensityAUniformIrradianceEverywhere) {
    // Every texel, at edges, in corners and beside seams too, receives power in proportion to its
    // area, the halves 3 and 1 shares of four.
    for (const KernelScene& scene : kernel_scenes()) {
        const TexelAtlas atlas = build_atlas(scene.mesh, scene.width, scene.height);
        const RatioKernel kernel = build_ratio_kernel(atlas, arrivals_of(atlas, 5), {});
        PhotonPaths paths;
        std::vector<Rgbf> power;
        paths.arrivals_begin.push_back(0);
        for (const Texel& texel : atlas.texels) {
            for (std::uint8_t half = 0; half < 2; ++half) {
                paths.arrival_half.push_back(half);
                power.push_back(Rgbf(1, 2, 4) * float(texel.area) * (half == 0 ? 0.75F : 0.25F));
            }
            paths.arrivals_begin.push_back(std::uint32_t(power.size()));
        }
        const std::vector<IndirectIrradiance> irradiance =
            indirect_irradiance(kernel, paths, power);
        // Sums of at most 160 terms in single precision.
        constexpr double kSumError = 160 * 6e-8;
        for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
            const Rgb error = irradiance[i].mean() / Rgb(1, 2, 4) - 1;
            EXPECT_LT(error.abs().maxCoeff(), kSumError) << scene.name << ", texel " << i;
            EXPECT_NEAR(irradiance[i].variance()[0], 0.25, 4 * kSumError);
        }
    }
}

// Number of kernels that hold texels of two charts.
std::size_t num_kernels_across(const Mesh& mesh, int width, int height) {
    const TexelAtlas atlas = build_atlas(mesh, width, height);
    const RatioKernel kernel = build_ratio_kernel(atlas, arrivals_of(atlas, 1), {});
    std::size_t count = 0;
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        bool across = false;
        for (std::size_t k = kernel.begin[i]; k < kernel.begin[i + 1]; ++k) {
            across |= atlas.texels[kernel.texel[k]].chart != atlas.texels[i].chart;
        }
        count += across ? 1 : 0;
    }
    return count;
}

TEST(RatioKernel, StopsAtCreasesCracksAndSteps) {
    EXPECT_EQ(num_kernels_across(perpendicular_unit_squares(), 24, 48), 0U);
    EXPECT_EQ(num_kernels_across(convex_edge(), 48, 24), 0U);
    EXPECT_EQ(num_kernels_across(two_halves(0.5, 0), 24, 24), 0U) << "a crack of 12 texels";
    EXPECT_EQ(num_kernels_across(two_halves(0, -0.035), 24, 24), 0U) << "a step of 0.84 texels";
}

TEST(RatioKernel, StaysNearTheTangentPlane) {
    // One chart: a plate, a ramp of 40 degrees, which the normals' predicate lets through, and a
    // plate three texels higher.
    constexpr double kTexel = 1.0 / 24;
    const double rise = 3 * kTexel;
    const double run = rise / std::tan(radians(40.0));
    Mesh mesh = rectangle(Vec3::Zero(), {0.5, 0, 0}, Vec3::UnitY(), {{0, 0}, {0.4, 1}});
    append(mesh, rectangle({0.5, 0, 0}, {run, 0, rise}, Vec3::UnitY(), {{0.4, 0}, {0.6, 1}}));
    append(mesh, rectangle({0.5 + run, 0, rise}, {0.5, 0, 0}, Vec3::UnitY(), {{0.6, 0}, {1, 1}}));
    const TexelAtlas atlas = build_atlas(mesh, 30, 24);
    const RatioKernel kernel = build_ratio_kernel(atlas, arrivals_of(atlas, 1), {});
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        const Texel& center = atlas.texels[i];
        const double reach = RatioKernelOptions().max_radius * std::sqrt(center.area);
        for (std::size_t k = kernel.begin[i]; k < kernel.begin[i + 1]; ++k) {
            const Vec3 offset =
                atlas.texels[kernel.texel[k]].point.position - center.point.position;
            EXPECT_LE(std::abs(offset.dot(center.point.normal)), 0.1 * reach) << "texel " << i;
        }
    }
}

TEST(RatioKernel, SpreadsAcrossSeams) {
    // 150 arrivals, one per texel, make a radius of sqrt(150 / pi) = 6.9 texels, so that the six
    // columns on either side reach over the seam in every row.
    EXPECT_GE(num_kernels_across(seam(), kSeamWidth, 24), std::size_t(2 * 6 * 24));
}

TEST(RatioKernel, GrowsUntilItHoldsTheArrivalsAskedFor) {
    const Mesh mesh = rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    const TexelAtlas atlas = build_atlas(mesh, 31, 31);
    const TexelId middle = atlas.cell_texel[15 * 31 + 15];
    const auto size_with = [&](double arrivals, const RatioKernelOptions& options = {}) {
        const RatioKernel kernel = build_ratio_kernel(atlas, arrivals_of(atlas, arrivals), options);
        return kernel.begin[middle + 1] - kernel.begin[middle];
    };
    // At most the texels at one distance, 12, are taken beyond what is needed, and those within 5 %
    // of the radius.
    const auto ring = [](double count) { return 12 + 0.11 * count; };
    EXPECT_NEAR(double(size_with(3)), 50, ring(50));
    EXPECT_NEAR(double(size_with(1.5)), 100, ring(100));
    // A smallest radius of 1.6 texels is met by the texels at a distance of 2: 13 lie so near.
    RatioKernelOptions wide;
    wide.min_radius = 1.6;
    EXPECT_EQ(size_with(1000, wide), 13U);
    RatioKernelOptions few;
    few.max_texels = 20;
    EXPECT_LE(size_with(1, few), 20U);
}

TEST(RatioKernel, IsEmptyWhereNoPhotonIsInReach) {
    const Mesh mesh = rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    const TexelAtlas atlas = build_atlas(mesh, 24, 24);
    std::vector<double> arrivals = arrivals_of(atlas, 0);
    arrivals[atlas.cell_texel[0]] = 1000;
    const RatioKernel kernel = build_ratio_kernel(atlas, arrivals, {});
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        const Texel& texel = atlas.texels[i];
        const double distance = std::hypot(texel.column, texel.row);
        if (distance == 7) continue;  // rounding decides
        EXPECT_EQ(kernel.begin[i + 1] > kernel.begin[i], distance < 7)
            << texel.column << ", " << texel.row;
    }
}

TEST(RatioKernel, IsTheSameForAnyNumberOfThreads) {
    const Mesh mesh = sphere(1, 64, 32, SphereSide::inward, true);
    const TexelAtlas atlas = build_atlas(mesh, 128, 64);
    std::vector<double> arrivals(atlas.texels.size());
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        Rng rng(1, Pass::tests, i);
        arrivals[i] = 20 * rng.uniform();
    }
    const auto build = [&](int threads) {
        const ThreadLimit limit(threads);
        return build_ratio_kernel(atlas, arrivals, {});
    };
    const RatioKernel one = build(1);
    const RatioKernel two = build(2);
    EXPECT_EQ(one.begin, two.begin);
    EXPECT_EQ(one.texel, two.texel);
    EXPECT_EQ(one.weight, two.weight);
}

// --- Seen through the lobe
// ------------------------------------------------------------------------

// A plate of 5 x 5 texels with random arrivals from the whole hemisphere.
struct RandomArrivals {
    Mesh mesh = rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    TexelAtlas atlas = build_atlas(mesh, 5, 5);
    RatioKernel kernel = build_ratio_kernel(atlas, arrivals_of(atlas, 1), {});
    PhotonPaths paths;
    std::vector<Rgbf> power;

    RandomArrivals(std::uint32_t per_texel, std::uint64_t seed) {
        Rng rng(seed, Pass::tests, 0);
        for (std::uint32_t i = 0; i <= atlas.texels.size(); ++i) {
            paths.arrivals_begin.push_back(i * per_texel);
        }
        for (std::size_t i = 0; i < paths.arrivals_begin.back(); ++i) {
            const double cosine = rng.uniform();
            const double sine = std::sqrt(1 - square(cosine));
            const double azimuth = 2 * kPi * rng.uniform();
            paths.arrival_direction.emplace_back(
                Vec3(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine).cast<float>());
            paths.arrival_half.push_back(i % 2);
            power.emplace_back(Rgbf(1, 2, 3) * float(rng.uniform()));
        }
    }

    [[nodiscard]] IndirectLobe lobe(TexelId texel, const Vec3& w_v, double roughness) const {
        const std::vector<Vec3f> views(atlas.texels.size(), w_v.cast<float>());
        const std::vector<Reflectance> maps(atlas.texels.size(), {Rgb::Zero(), 1, roughness});
        const std::vector<std::uint8_t> wanted(atlas.texels.size(), 1);
        // The second of three that every texel has.
        constexpr std::size_t kStride = 3;
        std::vector<IndirectLobe> lobes(kStride * atlas.texels.size());
        add_indirect_lobe(kernel, paths, power, atlas, views, maps, wanted, {&lobes[1], kStride});
        return lobes[kStride * texel + 1];
    }

    // The sum over all arrivals by the lobe's own functions, in double precision.
    [[nodiscard]] Rgb plain_sum(TexelId texel, const Vec3& w_v, double roughness) const {
        const Vec3& n = atlas.texels[texel].point.normal;
        Rgb sum = Rgb::Zero();
        for (std::size_t k = kernel.begin[texel]; k < kernel.begin[texel + 1]; ++k) {
            const TexelId y = kernel.texel[k];
            for (std::uint32_t a = paths.arrivals_begin[y]; a < paths.arrivals_begin[y + 1]; ++a) {
                const Vec3 w_i = paths.arrival_direction[a].cast<double>();
                sum += power[a].cast<double>() * double(kernel.weight[k]) *
                       lobe_gaussian(mirror_angle_squared(n, w_i, w_v), roughness) *
                       lobe_cosines(n.dot(w_i), n.dot(w_v));
            }
        }
        return sum / square(roughness);
    }
};

TEST(IndirectLobe, EqualsThePlainSumOfFewArrivals) {
    // 25 texels of 7 arrivals are few enough for all of them to be taken.
    const RandomArrivals arrivals(7, 1);
    const TexelId middle = 12;
    for (const double roughness : {0.2, 0.3, 0.6}) {
        for (const double angle : {0.0, 30.0, 60.0, 80.0}) {
            const Vec3 w_v(std::sin(radians(angle)), 0, std::cos(radians(angle)));
            const IndirectLobe lobe = arrivals.lobe(middle, w_v, roughness);
            // Largest error of a channel, relative to its light.
            const auto error = [&](const Rgbf& value, double sigma) {
                return (value.cast<double>() / arrivals.plain_sum(middle, w_v, sigma) - 1)
                    .abs()
                    .maxCoeff();
            };
            // The squared angle errs by 2e-4, and a Gaussian by that times its exponent; where the
            // exponent is above 10 there is no light.
            constexpr double kSeriesError = 2e-4 * 10;
            // Three sigma of the widest lobe: the light beyond it, spread over the hemisphere, is
            // exp(-9/2) of the whole on average, here a sample of few arrivals.
            const double left_out = 3 * std::exp(-4.5);
            SCOPED_TRACE(testing::Message() << roughness << " rad, " << angle << " degrees");
            EXPECT_LT(error(lobe.half, roughness / 2), kSeriesError);
            EXPECT_LT(error(lobe.same, roughness), kSeriesError);
            EXPECT_LT(error(lobe.twice, 2 * roughness), kSeriesError + left_out);
        }
    }
}

TEST(IndirectLobe, KeepsItsLightWhereOnlyEveryNthArrivalIsTaken) {
    constexpr double kRoughness = 0.3;
    const TexelId middle = 12;
    const Vec3 w_v = Vec3(0.5, 0, 0.8).normalized();
    std::vector<double> ratios;
    for (std::uint64_t set = 0; set < 256; ++set) {
        const RandomArrivals arrivals(40, set);
        ratios.push_back(double(arrivals.lobe(middle, w_v, kRoughness).same[0]) /
                         arrivals.plain_sum(middle, w_v, kRoughness)[0]);
    }
    // Counting the first arrival always and rounding the number of those taken up adds at most one
    // arrival in 96, of up to twice the mean weight.
    const SampleMean mean = estimate_of(ratios);
    EXPECT_TRUE(agrees(mean, 1, 2.0 / 96));
    EXPECT_LT(mean.standard_error, 0.02) << "the test would see nothing";
}

}  // namespace
}  // namespace patina
