#include "patina/plan/lamp_study.h"

#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/plan/look_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/lit_scene.h"
#include "support/scenes.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

namespace patina {
namespace {

Camera registered_camera(const std::string& id, const Vec3& position) {
    Camera camera;
    camera.id = id;
    camera.model = CameraModel::registered;
    camera.width = 48;
    camera.height = 24;
    camera.position = position;
    return camera;
}

// A unit sphere seen from +z, under 12 lamps on a helix above it.
Capture sphere_rig() {
    Capture capture;
    capture.description.file = "rig.json";
    capture.mesh = sphere(1, 48, 24, SphereSide::outward, true);
    capture.atlas = build_atlas(capture.mesh, 48, 24);
    capture.description.cameras = {registered_camera("front", {0, 0, 6})};
    for (int i = 0; i < 12; ++i) {
        Light light = point_light({2 * std::cos(1.1 * i), 0.3 * i - 1.6, 4}, 50);
        light.id = "L" + std::to_string(i);
        capture.description.lights.push_back(light);
    }
    return capture;
}

LampStudy study(const Capture& capture,
                const StudyOptions& options = {},
                const std::vector<Camera>& new_cameras = {}) {
    Progress progress;
    return study_lamps(capture, new_cameras, options, progress);
}

Shot shot_of(std::vector<std::size_t> lights) {
    Shot shot;
    shot.lights = std::move(lights);
    return shot;
}

TEST(StudyLamps, PaperRuleIsTheGreedyCover) {
    const Capture capture = sphere_rig();
    StudyOptions options;
    options.rule = PlanRule::paper;
    Progress progress;
    EXPECT_EQ(study(capture, options).plan.chosen,
              plan_lights(capture, options.cover, progress).chosen);
    options.max_lamps = 3;
    EXPECT_EQ(study(capture, options).plan.chosen.size(), 3U);
}

TEST(StudyLamps, StopsWhereALampLowersTheErrorsTooLittle) {
    StudyOptions options;
    options.min_drop = 0.05;
    const LampStudy stopped = study(sphere_rig(), options);
    ASSERT_LT(stopped.plan.chosen.size(), 12U);
    for (const double drop : stopped.drops) EXPECT_GE(drop, options.min_drop);
    ASSERT_TRUE(stopped.plan.next.has_value());
    options.max_lamps = int(stopped.plan.chosen.size()) + 1;
    const LampStudy more = study(sphere_rig(), options);
    EXPECT_EQ(more.plan.chosen.back(), stopped.plan.next->light);
    EXPECT_LT(more.drops.back(), 0.05);
}

TEST(StudyLamps, WorthGrowsWithEveryLampAndEndsWithAll) {
    StudyOptions options;
    options.max_lamps = 12;
    const LampStudy all = study(sphere_rig(), options);
    ASSERT_EQ(all.worth.size(), 13U);
    for (std::size_t n = 1; n < all.worth.size(); ++n) {
        EXPECT_GE(all.worth[n].known, all.worth[n - 1].known);
    }
    EXPECT_EQ(all.worth.back().known, all.worth_with_all.known);
    EXPECT_EQ(all.worth.back().share.specular, all.plan.share_with_all.specular);
    EXPECT_LT(all.errors.diffuse, all.errors_before.diffuse);
    for (const RuleCurve& curve : all.curves) {
        EXPECT_EQ(curve.worth.front().known, 0) << curve.rule;
        if (curve.rule != "paper") {
            EXPECT_EQ(curve.worth.back().known, all.worth_with_all.known) << curve.rule;
        }
    }
}

TEST(StudyLamps, TakenLampsCountThroughEveryCameraLikeShots) {
    Capture capture = sphere_rig();
    StudyOptions options;
    options.cover.taken = {2, 7};
    options.max_lamps = 3;
    const LampStudy taken = study(capture, options);
    capture.description.shots = {shot_of({2}), shot_of({7})};
    options.shots_are_taken = true;
    const LampStudy shot = study(capture, options);
    EXPECT_EQ(taken.plan.chosen, shot.plan.chosen);
    EXPECT_EQ(taken.errors_before.diffuse, shot.errors_before.diffuse);
    EXPECT_LT(shot.errors_before.diffuse, 1);
}

// Two lamps in one exposure say less than two exposures.
TEST(StudyLamps, LampsOfOneShotAreOneLook) {
    Capture capture = sphere_rig();
    StudyOptions options;
    options.cover.taken = {2, 3};
    options.shots_are_taken = true;
    capture.description.shots = {shot_of({2}), shot_of({3})};
    const LampStudy apart = study(capture, options);
    capture.description.shots = {shot_of({2, 3})};
    const LampStudy together = study(capture, options);
    EXPECT_GT(together.errors_before.diffuse, apart.errors_before.diffuse);
}

TEST(StudyLamps, RanksLampsAndNewCamerasByGain) {
    Capture capture = sphere_rig();
    capture.description.shots = {shot_of({2}), shot_of({7})};
    StudyOptions options;
    options.shots_are_taken = true;
    options.cover.taken = {2, 7};
    options.num_next = 100;
    const std::vector<Camera> cameras = {registered_camera("behind", {0, 0, -6}),
                                         registered_camera("aside", {3, 0, 5})};
    const LampStudy ranked = study(capture, options, cameras);
    ASSERT_EQ(ranked.next.size(), 12U);  // ten lamps, two cameras
    for (std::size_t i = 1; i < ranked.next.size(); ++i) {
        EXPECT_LE(ranked.next[i].gain, ranked.next[i - 1].gain);
    }
    // From behind the lamps light nothing that the first camera's texels show.
    EXPECT_TRUE(ranked.next.back().is_camera);
    EXPECT_EQ(ranked.next.back().index, 0U);
    EXPECT_GE(ranked.next.front().known, ranked.worth.front().known);
    const auto best_lamp = std::find_if(ranked.next.begin(),
                                        ranked.next.end(),
                                        [](const NextLook& look) { return !look.is_camera; });
    EXPECT_EQ(best_lamp->index, ranked.plan.chosen.front());
}

TEST(StudyLamps, PlansForMapsWhereThereAreSome) {
    const Capture capture = sphere_rig();
    StudyOptions options;
    options.maps.assign(capture.atlas.texels.size(), Reflectance{Rgb::Constant(0.5), 0, 0.2});
    const LampStudy matte = study(capture, options);
    EXPECT_EQ(matte.worth_with_all.known, 0);
    options.maps.assign(capture.atlas.texels.size(), Reflectance{Rgb::Constant(0.3), 1, 0.2});
    EXPECT_GT(study(capture, options).worth_with_all.known, 0);
}

TEST(StudyLamps, IsTheSameForAnyNumberOfThreads) {
    StudyOptions options;
    options.max_texels = 200;
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        const LampStudy result = study(sphere_rig(), options);
        return std::tuple(result.plan.chosen,
                          result.drops,
                          result.errors.specular,
                          result.curves.back().worth.back().known);
    };
    EXPECT_EQ(run(1), run(4));
}

TEST(SampleTexels, TakesSoManyOfThoseSeenAscending) {
    const Capture capture = sphere_rig();
    Progress progress;
    const RigView rig(capture, progress);
    const PlanTexels some = sample_texels(rig, 50, 1);
    EXPECT_EQ(some.ids.size(), 50U);
    EXPECT_TRUE(std::is_sorted(some.ids.begin(), some.ids.end()));
    EXPECT_NE(some.ids, sample_texels(rig, 50, 2).ids);
    EXPECT_EQ(sample_texels(rig, 0, 1).ids, rig.seen());
    EXPECT_EQ(sample_texels(rig, 1 << 20, 1).ids, rig.seen());
}

TEST(StudyOptions, NamesTheOptionThatIsOutOfRange) {
    const auto expect = [](const char* option, const std::function<void(StudyOptions&)>& change) {
        StudyOptions options;
        change(options);
        try {
            validate(options, 3);
            FAIL() << option;
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), testing::StartsWith(option));
        }
    };
    expect("--prior-diffuse", [](auto& o) { o.prior_diffuse = 0; });
    expect("--prior-specular-albedo", [](auto& o) { o.prior_specular_albedo = -1; });
    expect("--lamps", [](auto& o) { o.max_lamps = -1; });
    expect("--min-drop", [](auto& o) { o.min_drop = 1; });
    expect("--plan-texels", [](auto& o) { o.max_texels = -1; });
    expect("--draws", [](auto& o) { o.num_draws = 0; });
    expect("--next-looks", [](auto& o) { o.num_next = -1; });
    expect("--roughness", [](auto& o) { o.cover.roughness = 0; });
}

}  // namespace
}  // namespace patina
