#include "patina/plan/greedy_cover.h"

#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/base/random.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/lit_scene.h"
#include "support/scenes.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace patina {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kTexels = 32;

// A unit square facing +z, seen by one registered camera.
Capture seen_square(const Vec3& camera_position) {
    Capture capture;
    capture.description.file = "rig.json";
    capture.mesh = rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    capture.atlas = build_atlas(capture.mesh, kTexels, kTexels);
    Camera camera;
    camera.id = "front";
    camera.model = CameraModel::registered;
    camera.width = kTexels;
    camera.height = kTexels;
    camera.position = camera_position;
    capture.description.cameras = {camera};
    return capture;
}

// Straight above and far away: the view is +z within a hundred-thousandth everywhere.
Capture square_from_afar() { return seen_square(Vec3(0.5, 0.5, 1e5)); }

// A directional lamp this far from the normal: its theta_r from afar is this angle, everywhere.
Light lamp_at(double angle_degrees) {
    const double angle = radians(angle_degrees);
    return directional_light(Vec3(std::sin(angle), 0, std::cos(angle)), 1);
}

LightPlan plan(const Capture& capture, const CoverOptions& options = {}) {
    Progress progress;
    return plan_lights(capture, options, progress);
}

Measurability measure(const Capture& capture, const CoverOptions& options = {}) {
    Progress progress;
    return measure_candidates(capture, options, progress);
}

std::size_t count(const std::vector<std::uint8_t>& shows, std::uint8_t bit) {
    std::size_t sum = 0;
    for (const std::uint8_t bits : shows) sum += std::size_t((bits & bit) != 0);
    return sum;
}

// Lamps that show random texels.
Measurability random_lamps(std::size_t num_lamps, std::size_t num_texels, std::uint64_t seed) {
    Measurability m;
    m.num_seen = num_texels;
    m.shows.resize(num_lamps);
    for (std::size_t light = 0; light < num_lamps; ++light) {
        m.candidates.push_back(light);
        Rng rng(seed, Pass::tests, light);
        const double density = 0.05 + 0.4 * rng.uniform();
        for (std::size_t i = 0; i < num_texels; ++i) {
            const bool diffuse = rng.uniform() < density;
            const bool specular = !diffuse && rng.uniform() < density;
            m.shows[light].push_back(diffuse ? kShowsDiffuse : specular ? kShowsSpecular : 0);
        }
    }
    return m;
}

// Calls visit with every ascending choice of `size` out of [0, count).
void for_each_subset(std::size_t count,
                     std::size_t size,
                     const std::function<void(const std::vector<std::size_t>&)>& visit) {
    for (std::size_t bits = 0; bits < (std::size_t(1) << count); ++bits) {
        std::vector<std::size_t> subset;
        for (std::size_t i = 0; i < count; ++i) {
            if ((bits >> i & 1) != 0) subset.push_back(i);
        }
        if (subset.size() == size) visit(subset);
    }
}

TEST(MeasureCandidates, AnglesDecideWhatALampShows) {
    // 2 sigma0 = 17.2 degrees, 3.5 sigma0 = 30.1 degrees; theta_i ends at 80 degrees.
    Capture capture = square_from_afar();
    for (const double angle : {17.0, 17.4, 29.9, 30.3, 79.8, 80.2, 120.0}) {
        capture.description.lights.push_back(lamp_at(angle));
    }
    const Measurability m = measure(capture);
    const std::size_t all = std::size_t(kTexels) * kTexels;
    EXPECT_EQ(m.num_seen, all);
    const std::vector<std::uint8_t> expected = {
        kShowsSpecular, 0, 0, kShowsDiffuse, kShowsDiffuse, 0, 0};
    for (std::size_t light = 0; light < expected.size(); ++light) {
        EXPECT_EQ(count(m.shows[light], kShowsSpecular),
                  expected[light] == kShowsSpecular ? all : 0)
            << "lamp " << light;
        EXPECT_EQ(count(m.shows[light], kShowsDiffuse), expected[light] == kShowsDiffuse ? all : 0)
            << "lamp " << light;
    }
}

TEST(MeasureCandidates, ALampAtTheCameraShowsTheHighlightInADisc) {
    // Light and view share a direction at angle theta from the normal, so theta_r = 2 theta.
    const double height = 2;
    const Vec3 place(0.5, 0.5, height);
    Capture capture = seen_square(place);
    capture.description.lights = {point_light(place, 1)};
    const Measurability m = measure(capture);
    std::size_t num_specular = 0;
    std::size_t num_diffuse = 0;
    for (std::size_t i = 0; i < capture.atlas.texels.size(); ++i) {
        const Vec3& p = capture.atlas.texels[i].point.position;
        const double theta_r = 2 * std::atan(std::hypot(p.x() - 0.5, p.y() - 0.5) / height);
        const int expected = theta_r < 2 * 0.15     ? kShowsSpecular
                             : theta_r > 3.5 * 0.15 ? kShowsDiffuse
                                                    : 0;
        EXPECT_EQ(m.shows[0][i], expected) << "theta_r " << theta_r;
        num_specular += std::size_t(expected == kShowsSpecular);
        num_diffuse += std::size_t(expected == kShowsDiffuse);
    }
    EXPECT_GT(num_specular, 100U);
    EXPECT_GT(num_diffuse, 100U);
}

TEST(MeasureCandidates, NothingIsShownInShadowOrFromTheSide) {
    Capture capture = square_from_afar();
    capture.description.lights = {lamp_at(45)};
    // A wall along y at x = 0.25, one tenth high, shades a strip as wide as it is high.
    append(capture.mesh,
           rectangle(
               Vec3(0.25, 0, 0), Vec3(0, 0, 0.1), Vec3(0, 1, 0), {Vec2(-2, -2), Vec2(-1.5, -1.5)}));
    capture.description.lights[0].direction =
        Vec3(-std::sin(radians(45)), 0, std::cos(radians(45)));
    // The atlas is still that of the square alone: the wall only casts its shadow.
    const double texel = 1.0 / kTexels;
    const Measurability m = measure(capture);
    for (std::size_t i = 0; i < capture.atlas.texels.size(); ++i) {
        const double x = capture.atlas.texels[i].point.position.x();
        const bool in_shadow = x > 0.25 && x < 0.35;
        const bool clear = x < 0.25 - 2 * texel || x > 0.35 + 2 * texel;
        if (in_shadow) {
            EXPECT_EQ(m.shows[0][i], 0) << "x " << x;
        }
        if (clear) {
            EXPECT_EQ(m.shows[0][i], kShowsDiffuse) << "x " << x;
        }
    }

    Capture grazing = seen_square(Vec3(0.5, -10, 10 * std::tan(radians(90 - 76))));
    grazing.description.lights = {lamp_at(0)};
    EXPECT_EQ(count(measure(grazing).shows[0], kShowsDiffuse | kShowsSpecular), 0U);
}

TEST(MeasureCandidates, LampsThatTurnNeedACameraThatTurns) {
    Capture capture = square_from_afar();
    capture.description.lights = {lamp_at(40)};
    capture.description.lights[0].frame = FrameOfReference::scanner;
    EXPECT_EQ(count(measure(capture).shows[0], kShowsDiffuse), 0U);
    capture.description.cameras[0].frame = FrameOfReference::scanner;
    EXPECT_EQ(count(measure(capture).shows[0], kShowsDiffuse), capture.atlas.texels.size());
}

TEST(MeasureCandidates, LampsOfHeldOutShotsAloneAreNoCandidates) {
    Capture capture = square_from_afar();
    capture.description.lights = {lamp_at(10), lamp_at(40), lamp_at(50)};
    Shot used;
    used.lights = {0, 1};
    Shot heldout;
    heldout.lights = {1, 2};
    heldout.heldout = true;
    capture.description.shots = {used, heldout};
    EXPECT_THAT(measure(capture).candidates, ElementsAre(0, 1));
}

TEST(MeasureCandidates, RefusesRigsWithoutCandidatesOrViews) {
    EXPECT_THROW(measure(square_from_afar()), Error);
    Capture from_behind = seen_square(Vec3(0.5, 0.5, -1));
    from_behind.description.lights = {lamp_at(10)};
    EXPECT_THROW(measure(from_behind), Error);
}

TEST(MeasureCandidates, IsTheSameForAnyNumberOfThreads) {
    Capture capture = seen_square(Vec3(0.2, 0.3, 4));
    capture.mesh = sphere(1, 48, 24, SphereSide::outward, true);
    capture.atlas = build_atlas(capture.mesh, 64, 32);
    for (int i = 0; i < 12; ++i) {
        capture.description.lights.push_back(
            point_light(Vec3(std::cos(0.5 * i), 0.2 * i - 1, 3), 1));
    }
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        return std::pair(measure(capture).shows, plan(capture).chosen);
    };
    EXPECT_EQ(run(1), run(4));
}

TEST(ChooseLights, AHighlightNeedsTwoLampsTheDiffusePartOne) {
    Capture capture = square_from_afar();
    for (const double angle : {50.0, 10.0, 40.0, 12.0, 14.0, 25.0}) {
        capture.description.lights.push_back(lamp_at(angle));
    }
    const LightPlan p = plan(capture);
    EXPECT_THAT(p.chosen, ElementsAre(0, 1, 3));
    EXPECT_THAT(p.chosen_for_diffuse, ElementsAre(0));
    EXPECT_EQ(p.stop, CoverStop::enough);
    ASSERT_EQ(p.shares.size(), 3U);
    EXPECT_EQ(p.shares[0].diffuse, 1);
    EXPECT_EQ(p.shares[0].specular, 0);
    EXPECT_EQ(p.shares[1].specular, 0);
    EXPECT_EQ(p.shares[2].specular, 1);
    EXPECT_EQ(p.share_with_all.diffuse, 1);
    EXPECT_EQ(p.share_with_all.specular, 1);
    ASSERT_TRUE(p.next.has_value());
    EXPECT_EQ(p.next->light, 2U);
}

TEST(ChooseLights, LampsTakenAlreadyCountAndAreNotChosenAgain) {
    Capture capture = square_from_afar();
    for (const double angle : {50.0, 10.0, 12.0, 14.0}) {
        capture.description.lights.push_back(lamp_at(angle));
    }
    CoverOptions options;
    options.taken = {0, 2};
    const LightPlan p = plan(capture, options);
    EXPECT_EQ(p.share_before.diffuse, 1);
    EXPECT_EQ(p.share_before.specular, 0);
    EXPECT_THAT(p.candidates, ElementsAre(1, 3));
    EXPECT_THAT(p.chosen, ElementsAre(1));
    EXPECT_THAT(p.chosen_for_diffuse, IsEmpty());
    EXPECT_EQ(p.share().specular, 1);
}

TEST(ChooseLights, StopsWhenALampAddsTooLittle) {
    // The second lamp shows 4 of 1000 texels more than the first; there is no highlight anywhere.
    Measurability m;
    m.num_seen = 1000;
    m.candidates = {0, 1};
    m.shows.assign(2, std::vector<std::uint8_t>(1000, 0));
    for (std::size_t i = 0; i < 500; ++i) m.shows[0][i] = kShowsDiffuse;
    for (std::size_t i = 496; i < 504; ++i) m.shows[1][i] = kShowsDiffuse;
    CoverOptions options;
    options.enough = 1;
    const LightPlan stopped = choose_lights(m, options);
    EXPECT_THAT(stopped.chosen, ElementsAre(0));
    EXPECT_EQ(stopped.stop, CoverStop::small_gain);
    ASSERT_TRUE(stopped.next.has_value());
    EXPECT_EQ(stopped.next->share.diffuse, 0.504);
    options.min_gain = 0.004;
    const LightPlan all = choose_lights(m, options);
    EXPECT_THAT(all.chosen, ElementsAre(0, 1));
    EXPECT_EQ(all.stop, CoverStop::enough);
    EXPECT_FALSE(all.next.has_value());
    options.min_gain = 0;
    options.enough = 0.99;
    EXPECT_THAT(choose_lights(m, options).chosen, ElementsAre(0));
}

TEST(Coverage, IsMonotoneAndSubmodular) {
    const CoverOptions options;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Measurability m = random_lamps(6, 60, seed);
        const auto f = [&](const std::vector<std::size_t>& lights) {
            return coverage(m, lights, options);
        };
        // A is the first of B's elements; `added` is the last lamp.
        for (std::size_t size = 0; size <= 5; ++size) {
            for_each_subset(5, size, [&](const std::vector<std::size_t>& b) {
                std::vector<std::size_t> b_added = b;
                b_added.push_back(5);
                ASSERT_GE(f(b_added), f(b));
                for (std::size_t shorter = 0; shorter < size; ++shorter) {
                    const std::vector<std::size_t> a(b.begin(),
                                                     b.begin() + std::ptrdiff_t(shorter));
                    std::vector<std::size_t> a_added = a;
                    a_added.push_back(5);
                    ASSERT_GE(f(a_added) - f(a), f(b_added) - f(b));
                }
            });
        }
    }
}

TEST(ChooseLights, ReachesTheGreedyBoundOfTheBestChoice) {
    CoverOptions options;
    options.min_gain = 0;
    options.enough = 1;
    for (std::uint64_t seed = 100; seed < 120; ++seed) {
        const Measurability m = random_lamps(9, 80, seed);
        const LightPlan p = choose_lights(m, options);
        for (std::size_t size = 1; size <= std::min<std::size_t>(4, p.chosen.size()); ++size) {
            std::uint64_t best = 0;
            for_each_subset(9, size, [&](const std::vector<std::size_t>& subset) {
                best = std::max(best, coverage(m, subset, options));
            });
            const std::uint64_t greedy = coverage(m, std::span(p.chosen).first(size), options);
            EXPECT_GE(double(greedy), (1 - std::exp(-1.0)) * double(best)) << "seed " << seed;
            EXPECT_LE(greedy, best);
            if (size == 1) {
                EXPECT_EQ(greedy, best);
            }
        }
    }
}

TEST(Validate, NamesTheOptionThatIsOutOfRange) {
    const auto message = [](const std::function<void(CoverOptions&)>& change) {
        CoverOptions options;
        change(options);
        try {
            validate(options, 3);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(message([](CoverOptions&) {}), "");
    const auto expect = [&](const char* option, const std::function<void(CoverOptions&)>& change) {
        EXPECT_THAT(message(change), testing::StartsWith(option));
    };
    expect("--max-light-angle", [](auto& o) { o.max_light_angle = 0; });
    expect("--max-view-angle", [](auto& o) { o.max_view_angle = radians(91); });
    expect("--roughness", [](auto& o) { o.roughness = std::nan(""); });
    expect("--specular-reach", [](auto& o) { o.specular_reach = -1; });
    expect("--diffuse-reach", [](auto& o) { o.diffuse_reach = 1; });
    expect("--specular-need", [](auto& o) { o.specular_need = 0; });
    expect("--diffuse-need", [](auto& o) { o.diffuse_need = 256; });
    expect("--min-gain", [](auto& o) { o.min_gain = -0.1; });
    expect("--enough", [](auto& o) { o.enough = 1.5; });
    expect("--taken", [](auto& o) { o.taken = {3}; });
    expect("--taken", [](auto& o) { o.taken = {1, 1}; });
}

}  // namespace
}  // namespace patina
