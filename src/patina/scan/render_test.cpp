#include "patina/scan/render.h"

#include "patina/base/parallel.h"
#include "patina/scan/rig.h"

#include <gtest/gtest.h>

#include "support/false_alarms.h"
#include <numeric>

namespace patina {
namespace {

RenderOptions some_options(std::size_t num_lamps) {
    RenderOptions options;
    options.samples_per_pixel = 4;
    options.lamp_numbers.resize(num_lamps);
    std::iota(options.lamp_numbers.begin(), options.lamp_numbers.end(), 0u);
    return options;
}

RenderedImages render_with_threads(const SimulatedObject& object, const ScanRig& rig, int threads) {
    const ThreadLimit limit(threads);
    Progress progress;
    return render_lamps(
        object, rig.cameras[0], std::span(rig.candidates).first(2), some_options(2), progress);
}

TEST(Render, BytesDoNotDependOnTheThreads) {
    const SimulatedObject object = make_object(ObjectKind::c, 32, 24);
    const ScanRig rig = make_rig(object, 32, 24);
    const RenderedImages one = render_with_threads(object, rig, 1);
    const RenderedImages two = render_with_threads(object, rig, 2);
    EXPECT_EQ(one.seen.data, two.seen.data);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(one.radiance[i].data, two.radiance[i].data);
    EXPECT_GT(std::accumulate(one.radiance[0].data.begin(), one.radiance[0].data.end(), 0.0f), 0);
}

TEST(Render, ImageDoesNotDependOnTheOtherLamps) {
    const SimulatedObject object = make_object(ObjectKind::a, 16, 16);
    const ScanRig rig = make_rig(object, 16, 16);
    Progress progress;
    const RenderedImages both = render_with_threads(object, rig, 2);
    RenderOptions options = some_options(1);
    options.lamp_numbers = {1};
    const RenderedImages alone = render_lamps(
        object, rig.cameras[0], std::span(rig.candidates).subspan(1, 1), options, progress);
    EXPECT_EQ(both.radiance[1].data, alone.radiance[0].data);
}

// In the groove no light is lost but through its opening: what leaves lies between the direct light
// and the sum of the geometric series of Pd, with the strongest light there is.
TEST(Render, InterreflectionAddsWhatTheAlbedoAllows) {
    constexpr int kSide = 8;
    const SimulatedObject object = make_object(ObjectKind::v45, kSide, kSide);
    const ScanRig rig = make_rig(object, kSide, kSide);
    const Light& lamp = rig.heldout;
    RenderOptions options = some_options(1);
    options.samples_per_pixel = 64;
    Progress progress;
    const RenderedImages images =
        render_lamps(object, rig.cameras[0], std::span(&lamp, 1), options, progress);
    const double height = lamp.position.y() - kGrooveSide;
    const double strongest = lamp.intensity[0] / square(height);
    for (int row = 0; row < kSide; ++row) {
        for (int column = 0; column < kSide; ++column) {
            const Vec2 center(column + 0.5, row + 0.5);
            const SurfacePoint point = *point_at_pixel(object, kSide, kSide, center);
            const LightSample light = sample_light(lamp, point.position, 0);
            const double direct =
                kGrooveDiffuse / kPi * light.irradiance[0] * point.normal.dot(light.w_i);
            const double found = double(images.radiance[0].at(column, row));
            // Within a pixel, 75 mm of 0.9 m, the direct light is curved by less than 1 %.
            EXPECT_GT(found, 0.99 * direct);
            EXPECT_LT(found, kGrooveDiffuse / (1 - kGrooveDiffuse) / kPi * strongest);
        }
    }
}

// A lit corner of 8 x 8 pixels, adaptive or not.
std::vector<float> render_corner(std::uint64_t seed, bool adaptive) {
    constexpr int kSide = 8;
    const SimulatedObject object = make_object(ObjectKind::a, kSide, kSide);
    const ScanRig rig = make_rig(object, kSide, kSide);
    RenderOptions options = some_options(1);
    options.samples_per_pixel = 256;
    options.adaptive = adaptive;
    options.seed = seed;
    Progress progress;
    return render_lamps(object, rig.cameras[0], std::span(&rig.heldout, 1), options, progress)
        .radiance[0]
        .data;
}

TEST(Render, AdaptiveImagesAreThoseOfUniformOnesInTheMean) {
    constexpr std::size_t kNumPairs = 100;
    std::vector<double> excess(kNumPairs);
    for (std::size_t pair = 0; pair < kNumPairs; ++pair) {
        const std::vector<float> adaptive = render_corner(pair, true);
        const std::vector<float> uniform = render_corner(kNumPairs + pair, false);
        excess[pair] = std::accumulate(adaptive.begin(), adaptive.end(), 0.0) -
                       std::accumulate(uniform.begin(), uniform.end(), 0.0);
    }
    EXPECT_TRUE(agrees(estimate_of(excess), 0));
}

TEST(Render, AdaptiveBytesDoNotDependOnTheThreads) {
    const auto render_with = [](int threads) {
        const ThreadLimit limit(threads);
        return render_corner(1, true);
    };
    EXPECT_EQ(render_with(1), render_with(2));
}

TEST(Render, ShiftedImagesShowWhatLiesBesideEachPixel) {
    constexpr int kSide = 16;
    const SimulatedObject object = make_object(ObjectKind::a, kSide, kSide);
    const ScanRig rig = make_rig(object, kSide, kSide);
    RenderOptions options = some_options(1);
    Progress progress;
    const auto render = [&] {
        return render_lamps(
            object, rig.cameras[0], std::span(rig.candidates).first(1), options, progress);
    };
    const RenderedImages straight = render();
    options.image_shift = {0, kSide};
    const RenderedImages beyond = render();
    EXPECT_GT(std::accumulate(straight.seen.data.begin(), straight.seen.data.end(), 0.0f), 0);
    EXPECT_EQ(std::accumulate(beyond.seen.data.begin(), beyond.seen.data.end(), 0.0f), 0);
}

}  // namespace
}  // namespace patina
