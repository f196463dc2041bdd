#include "patina/estimate/gather_engine.h"

#include <gtest/gtest.h>

#include "support/channel.h"
#include "support/same_bytes.h"
#include "support/scenes.h"
#include <numeric>

namespace patina {
namespace {

// One lamp more than a block holds, and as many that turn with the scanner.
constexpr std::size_t kNumLamps = 2 * (kLampLanes + 1);
// Sums of at most kNumLamps numbers in single precision, some of them twice.
constexpr double kFloatSum = 2 * kNumLamps * 6e-8;

// A glossy channel under many lamps, in shots of one lamp each and of all at once.
class ManyLamps : public testing::Test {
  protected:
    ManyLamps() {
        for (std::size_t i = 0; i < kNumLamps; ++i) {
            const double share = double(i) / kNumLamps;
            Light light = point_light(Vec3(0.6 * share - 0.3, share, 1.6 + 0.2 * share), 1);
            light.intensity = Rgb(1 + share, 1, 2 - share);
            if (i % 2 == 1) light.frame = FrameOfReference::scanner;
            lights_.push_back(light);
        }
        for (const Light& light : lights_) {
            direct_.push_back(direct_light(channel_.scene.surface(), channel_.atlas, light));
        }
        for (const TexelId texel : channel_.looked_at()) seen_[texel] = 1;
    }

    // One shot for each set of lamps.
    [[nodiscard]] SceneView scene(const std::vector<std::vector<std::size_t>>& sets) const {
        SceneView scene;
        TexelView view;
        view.w_v = Channel::towards_camera().cast<float>();
        view.state = ViewState::clear;
        scene.views = {std::vector<TexelView>(channel_.atlas.texels.size(), view)};
        for (const Light& light : lights_) scene.lights.push_back(&light);
        scene.direct.resize(kNumLamps);
        for (std::size_t set = 0; set < sets.size(); ++set) {
            scene.shots.push_back(set);
            scene.camera_of_shot.push_back(0);
            scene.lamp_set_of_shot.push_back(set);
            LampSet& lamps = scene.lamp_sets.emplace_back();
            lamps.indices = sets[set];
            for (const std::size_t light : sets[set]) scene.direct[light] = direct_[light];
        }
        return scene;
    }
    // Of all lamp sets or shots the light of one.
    template <typename Value>
    [[nodiscard]] std::vector<Value> column(const TexelTable<Value>& table,
                                            std::size_t number) const {
        std::vector<Value> values;
        for (std::size_t i = 0; i < channel_.atlas.texels.size(); ++i) {
            values.push_back(table.of(i)[number]);
        }
        return values;
    }
    // After two turns.
    [[nodiscard]] IndirectLight gather(const SceneView& scene) const {
        EstimateOptions options;
        options.gather.rays = 8;
        options.gather.lobe_rays = 8;
        Progress progress;
        GatherEngine engine(channel_.scene.surface(), channel_.atlas, scene, options, progress);
        (void)engine.evaluate(channel_.maps, seen_, true);
        return engine.evaluate(channel_.maps, seen_, true);
    }

    Channel channel_;
    std::vector<Light> lights_;
    std::vector<LargeVector<DirectLight>> direct_;
    std::vector<std::uint8_t> seen_ = std::vector<std::uint8_t>(channel_.atlas.texels.size(), 0);
};

TEST_F(ManyLamps, EachSendsWhatItSendsAlone) {
    std::vector<std::vector<std::size_t>> sets;
    for (std::size_t i = 0; i < kNumLamps; ++i) sets.push_back({i});
    const IndirectLight together = gather(scene(sets));
    ASSERT_EQ(together.irradiance.columns(), kNumLamps);
    // The first and the last of the blocks, of lamps that stand and of lamps that turn.
    for (const std::size_t i : {std::size_t(0), std::size_t(1), kNumLamps - 2, kNumLamps - 1}) {
        const IndirectLight alone = gather(scene({{i}}));
        EXPECT_TRUE(same_bytes(column(together.irradiance, i), column(alone.irradiance, 0))) << i;
        EXPECT_TRUE(same_bytes(column(together.lobe, i), column(alone.lobe, 0))) << i;
        const TexelId texel = channel_.looked_at().front();
        EXPECT_GT(alone.irradiance.of(texel)[0].mean().minCoeff(), 0);
        EXPECT_GT(alone.lobe.of(texel)[0].same.minCoeff(), 0);
    }
}

TEST_F(ManyLamps, SendTogetherTheSumOfWhatTheySend) {
    std::vector<std::vector<std::size_t>> sets(1, std::vector<std::size_t>(kNumLamps));
    std::iota(sets[0].begin(), sets[0].end(), std::size_t(0));
    for (std::size_t i = 0; i < kNumLamps; ++i) sets.push_back({i});
    const IndirectLight light = gather(scene(sets));
    const auto expect_sum = [&](const auto& value_of_set) {
        Rgb sum = Rgb::Zero();
        for (std::size_t set = 1; set < sets.size(); ++set) sum += value_of_set(set);
        for (Eigen::Index c = 0; c < 3; ++c) {
            EXPECT_NEAR(value_of_set(0)[c], sum[c], kFloatSum * sum[c]);
        }
    };
    for (const TexelId texel : channel_.looked_at()) {
        expect_sum([&](std::size_t set) { return light.irradiance.of(texel)[set].mean(); });
        expect_sum(
            [&](std::size_t set) { return Rgb(light.lobe.of(texel)[set].same.cast<double>()); });
    }
}

TEST_F(ManyLamps, SendTheSameWhereTheirLightAtTheHitsIsNotKept) {
    std::vector<std::vector<std::size_t>> sets(1, std::vector<std::size_t>(kNumLamps));
    std::iota(sets[0].begin(), sets[0].end(), std::size_t(0));
    const SceneView view = scene(sets);
    const auto two_turns = [&](std::size_t kept_blocks) {
        EstimateOptions options;
        options.gather.rays = 8;
        options.gather.lobe_rays = 8;
        Progress progress;
        GatherEngine engine(
            channel_.scene.surface(), channel_.atlas, view, options, progress, kept_blocks);
        (void)engine.evaluate(channel_.maps, seen_, true);
        return engine.evaluate(channel_.maps, seen_, true);
    };
    const IndirectLight kept = two_turns(4);  // two blocks that turn and two that stand
    for (const std::size_t kept_blocks : {0U, 1U, 2U, 3U}) {
        const IndirectLight again = two_turns(kept_blocks);
        EXPECT_TRUE(same_bytes(column(kept.irradiance, 0), column(again.irradiance, 0)));
        EXPECT_TRUE(same_bytes(column(kept.lobe, 0), column(again.lobe, 0)));
    }
}

TEST_F(ManyLamps, SendTheSameAgainAfterARestart) {
    EstimateOptions options;
    options.gather.rays = 8;
    options.gather.lobe_rays = 8;
    Progress progress;
    const SceneView view = scene({{0}, {1}});
    GatherEngine engine(channel_.scene.surface(), channel_.atlas, view, options, progress);
    const IndirectLight first = engine.evaluate(channel_.maps, seen_, true);
    const IndirectLight second = engine.evaluate(channel_.maps, seen_, true);
    engine.restart();
    const IndirectLight again = engine.evaluate(channel_.maps, seen_, true);
    for (const std::size_t set : {0U, 1U}) {
        EXPECT_TRUE(same_bytes(column(first.irradiance, set), column(again.irradiance, set)));
        EXPECT_FALSE(same_bytes(column(first.irradiance, set), column(second.irradiance, set)));
        EXPECT_TRUE(same_bytes(column(first.lobe, set), column(again.lobe, set)));
    }
    EXPECT_EQ(again.spectral_radius, 0);
    EXPECT_EQ(engine.evaluate(channel_.maps, seen_, true).spectral_radius, 0);
}

TEST_F(ManyLamps, TellHowMuchOfTheLastChangeTheNextOneKeeps) {
    EstimateOptions options;
    options.gather.rays = 8;
    options.gather.lobe_rays = 8;
    Progress progress;
    const SceneView view = scene({{0}, {2}});
    GatherEngine engine(channel_.scene.surface(), channel_.atlas, view, options, progress);
    const std::vector<Reflectance> maps(channel_.atlas.texels.size(), lambertian(0.5));
    // One sweep knows nothing of it, two know one change.
    EXPECT_EQ(engine.evaluate(maps, seen_, false).spectral_radius, 0);
    EXPECT_EQ(engine.evaluate(maps, seen_, false).spectral_radius, 0);
    // What a surface keeps of a change is no more than what it reflects, and grows with that.
    std::array<double, 2> radius{};
    for (const std::size_t k : {0U, 1U}) {
        const double albedo = k == 0 ? 0.4 : 0.8;
        const std::vector<Reflectance> grey(maps.size(), lambertian(albedo));
        GatherEngine fresh(channel_.scene.surface(), channel_.atlas, view, options, progress);
        for (int turn = 0; turn < 4; ++turn) {
            radius[k] = fresh.evaluate(grey, seen_, false).spectral_radius;
        }
        EXPECT_LE(radius[k], albedo);
    }
    EXPECT_GT(radius[0], 0);
    EXPECT_GT(radius[1], radius[0]);
}

// A lamp that stands and one that turns with the scanner and is at the same place for azimuth 0,
// which all texels of the channel have.
class NarrowLobesUnderBothKinds : public ManyLamps {
  protected:
    NarrowLobesUnderBothKinds() {
        lights_ = {point_light(Vec3(-0.1, 0.4, 1.6), 1), point_light(Vec3(-0.1, 0.4, 1.6), 1)};
        lights_[1].frame = FrameOfReference::scanner;
        direct_.clear();
        for (const Light& light : lights_) {
            direct_.push_back(direct_light(channel_.scene.surface(), channel_.atlas, light));
        }
        for (const TexelId texel : plate(Channel::left)) {
            maps_[texel] = {Rgb::Constant(0.2), kLobeAlbedo / (2 * square(kSigma)), kSigma};
        }
    }
    [[nodiscard]] std::vector<TexelId> plate(Channel::Plate of) const {
        return channel_.patch(of, 0, Channel::kSide, 0, Channel::kSide);
    }
    // Mean over the floor under either lamp.
    [[nodiscard]] std::array<double, 2> floor_light(const IndirectLight& light) const {
        return floor_means([&](std::size_t set, TexelId texel) {
            return light.irradiance.of(texel)[set].mean()[1];
        });
    }
    // The same by two sweeps alone, without photons.
    [[nodiscard]] std::array<double, 2> swept_floor_light(const EstimateOptions& options) const {
        GatherOptions gather = options.gather;
        gather.seed = options.photons.seed;
        Progress progress;
        const GatherGraph graph =
            trace_gather_graph(channel_.scene.surface(), channel_.atlas, {}, gather, progress);
        const SurfaceFilter filter = build_surface_filter(channel_.atlas, options.filter_radius);
        const RadiantTexels texels(channel_.atlas, maps_, true);
        std::array<SweptLight, 2> swept;
        for (const std::size_t set : {0U, 1U}) {
            LampBlockLight light(channel_.scene.surface(),
                                 channel_.atlas,
                                 graph,
                                 {{&lights_[set]}, {&direct_[set]}},
                                 set == 1);
            for (int turn = 0; turn < 2; ++turn) light.sweep(graph, texels, filter, swept[set]);
        }
        return floor_means([&](std::size_t set, TexelId texel) {
            double sum = 0;
            for (const IndirectLanes& half : swept[set].halves) sum += double(half[texel][1][0]);
            return 0.5 * lamp_color(lights_[set])[1] * sum;
        });
    }
    [[nodiscard]] std::array<double, 2> floor_means(const auto& value) const {
        const std::vector<TexelId> floor = plate(Channel::floor);
        std::array<double, 2> means{};
        for (const std::size_t set : {0U, 1U}) {
            means[set] = mean_over(floor, [&](TexelId texel) { return value(set, texel); });
        }
        return means;
    }

    static constexpr double kSigma = 0.05;      // of the left wall [rad]
    static constexpr double kLobeAlbedo = 0.3;  // 2 sigma^2 Ps of it
    std::vector<Reflectance> maps_ = channel_.maps;
};

TEST_F(NarrowLobesUnderBothKinds, SendTheSameByPhotonsAndBySweeps) {
    constexpr std::size_t kNumRuns = 32;
    // docs/uncertainty.md states of the indirect light a bias of so much of it.
    constexpr double kStatedBias = 0.02;
    const SceneView view = scene({{0}, {1}});
    std::vector<Reflectance> matte = maps_;
    for (const TexelId texel : plate(Channel::left)) matte[texel].specular = 0;
    std::array<std::vector<double>, 2> by_photons;
    std::array<std::vector<double>, 2> by_sweeps;
    std::array<double, 2> without{};
    for (std::size_t run = 0; run < kNumRuns; ++run) {
        EstimateOptions options;
        options.photons.seed = run;
        Progress progress;
        GatherEngine engine(channel_.scene.surface(), channel_.atlas, view, options, progress);
        EXPECT_TRUE(engine.evaluate(maps_, seen_, true).retraced);
        const IndirectLight light = engine.evaluate(maps_, seen_, true);
        EXPECT_FALSE(light.retraced);
        engine.restart();
        (void)engine.evaluate(matte, seen_, true);
        const IndirectLight dull = engine.evaluate(matte, seen_, true);
        const std::array<double, 2> swept = swept_floor_light(options);
        for (const std::size_t set : {0U, 1U}) {
            by_photons[set].push_back(floor_light(light)[set]);
            by_sweeps[set].push_back(swept[set]);
            without[set] += floor_light(dull)[set] / kNumRuns;
        }
    }
    for (const std::size_t set : {0U, 1U}) {
        const SampleMean swept = estimate_of(by_sweeps[set]);
        const SampleMean error = difference(estimate_of(by_photons[set]), swept);
        EXPECT_TRUE(agrees(error, 0, kStatedBias * swept.mean))
            << estimate_of(by_photons[set]).mean << ", " << swept.mean << " +- "
            << error.standard_error;
        EXPECT_GT(swept.mean - without[set],
                  2 * (kStatedBias * swept.mean + 6 * error.standard_error))
            << "the test would see nothing";
    }
}

TEST_F(ManyLamps, NeedNoPhotonsWhereNoLobeIsNarrow) {
    EstimateOptions options;
    options.gather.rays = 8;
    options.gather.lobe_rays = 8;
    Progress progress;
    const SceneView view = scene({{0}, {1}});
    GatherEngine engine(channel_.scene.surface(), channel_.atlas, view, options, progress);
    const IndirectLight light = engine.evaluate(channel_.maps, seen_, true);
    EXPECT_FALSE(light.retraced);
    // The sweep alone, lamp 0 in its own color.
    GatherOptions gather = options.gather;
    gather.seed = options.photons.seed;
    const GatherGraph graph = trace_gather_graph(
        channel_.scene.surface(), channel_.atlas, view_directions(view), gather, progress);
    LampBlockLight block(
        channel_.scene.surface(), channel_.atlas, graph, {{&lights_[0]}, {&direct_[0]}}, false);
    SweptLight swept;
    block.sweep(graph,
                RadiantTexels(channel_.atlas, channel_.maps, true),
                build_surface_filter(channel_.atlas, options.filter_radius),
                swept);
    const Rgbf color = lamp_color(lights_[0]).cast<float>();
    std::vector<IndirectIrradiance> expected(channel_.atlas.texels.size());
    for (std::size_t half = 0; half < 2; ++half) {
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const auto& lanes = swept.halves[half][i];
            expected[i].halves[half] = color * Rgbf(lanes[0][0], lanes[1][0], lanes[2][0]);
        }
    }
    EXPECT_TRUE(same_bytes(column(light.irradiance, 0), expected));
}

// A closed box whose walls reflect nine tenths of the light: so much of a change is left by each
// plain sweep in the end.
class WhiteBox : public testing::Test {
  protected:
    WhiteBox() {
        view_.views = {std::vector<TexelView>(atlas_.texels.size())};
        view_.lights = {&scene_.lights[0]};
        view_.direct = {direct_light(scene_.surface(), atlas_, scene_.lights[0])};
        view_.shots = view_.camera_of_shot = view_.lamp_set_of_shot = {0};
        view_.lamp_sets.resize(1);
        view_.lamp_sets[0].indices = {0};
        options_.gather.rays = 16;
        options_.gather.lobe_rays = 8;
    }

    struct Rest {
        int sweeps = 0;
        double mean = 0;            // irradiance
        double largest_radius = 0;  // told on the way
    };
    // Until a sweep changes the light by less than this, relative.
    [[nodiscard]] Rest sweep_until(double change, bool settled) {
        Progress progress;
        GatherEngine engine(scene_.surface(), atlas_, view_, options_, progress);
        IndirectLight light;
        Rest rest;
        do {
            engine.evaluate(maps_, seen_, false, light, settled);
            ++rest.sweeps;
            rest.largest_radius = std::max(rest.largest_radius, light.spectral_radius);
        } while (light.change > change && rest.sweeps < kMostSweeps);
        std::vector<TexelId> all(atlas_.texels.size());
        std::iota(all.begin(), all.end(), TexelId(0));
        rest.mean =
            mean_over(all, [&](TexelId texel) { return light.irradiance.of(texel)[0].mean()[1]; });
        return rest;
    }

    static constexpr double kAlbedo = 0.9;
    static constexpr int kMostSweeps = 200;
    LitScene scene_{inward_box(Vec3(1, 1, 1)), {}, {point_light(Vec3(0.4, 0.5, 0.6), 1)}};
    TexelAtlas atlas_ = build_atlas(scene_.mesh, 36, 24);
    std::vector<Reflectance> maps_{atlas_.texels.size(), lambertian(kAlbedo)};
    std::vector<std::uint8_t> seen_ = std::vector<std::uint8_t>(atlas_.texels.size(), 1);
    SceneView view_;
    EstimateOptions options_;
};

TEST_F(WhiteBox, IsAtRestInHalfTheSweepsOnceMapsHaveSettled) {
    constexpr double kRest = 1e-3;
    // A loop that keeps so much of its changes is at most this far from its end when one is kRest.
    constexpr double kFar = kRest * kAlbedo / (1 - kAlbedo);
    // Of shares of changes, by rounding what is sent on to 16 bits.
    constexpr double kRounding = 0.01;
    const Rest plain = sweep_until(kRest, false);
    const Rest settled = sweep_until(kRest, true);
    const Rest end = sweep_until(0, false);
    EXPECT_LE(2 * settled.sweeps, plain.sweeps);
    EXPECT_NEAR(settled.mean / end.mean, 1, kFar);
    // No wall keeps more of a change than it reflects, and a leap is not taken for a change kept.
    EXPECT_GT(plain.largest_radius, 0.8);
    EXPECT_LE(plain.largest_radius, kAlbedo + kRounding);
    EXPECT_LE(settled.largest_radius, kAlbedo + kRounding);
}

}  // namespace
}  // namespace patina
