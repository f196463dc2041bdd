#include "patina/transport/narrow_lobes.h"

#include <gtest/gtest.h>

#include "support/narrow_channel.h"
#include "support/same_bytes.h"
#include <cmath>
#include <memory>

namespace patina {
namespace {

constexpr std::size_t kNumRuns = 64;  // independent graphs and sets of photons
class NarrowLobesOfAChannel : public testing::Test {
  protected:
    // What the lamps send to the plates over one lobe, per run.
    struct Runs {
        std::array<std::vector<double>, kNumPlates> photons, rest, all_swept;
    };

    static void SetUpTestSuite() {
        channel_ = std::make_unique<NarrowChannel>();
        runs_ = std::make_unique<Runs>();
        for (std::size_t run = 0; run < kNumRuns; ++run) add_run(run);
    }
    static void TearDownTestSuite() {
        runs_.reset();
        channel_.reset();
    }

    static void add_run(std::uint64_t seed) {
        const NarrowChannel& channel = *channel_;
        const GatherGraph graph = channel.graph(seed);
        NarrowLobes narrow = channel.narrow_lobes(seed);
        ASSERT_TRUE(narrow.follow(channel.maps));
        const SweptLight rest = channel.swept(graph, narrow.shares());
        const SweptLight all = channel.swept(graph, {});
        const NarrowLobes::Irradiance photons = narrow.irradiance(0);
        for (std::size_t plate = 0; plate < kNumPlates; ++plate) {
            const std::vector<TexelId>& texels = channel.plates[plate];
            runs_->rest[plate].push_back(channel.swept_mean(texels, rest));
            runs_->all_swept[plate].push_back(channel.swept_mean(texels, all));
            runs_->photons[plate].push_back(channel.photon_mean(texels, photons));
        }
    }
    // By path tracing.
    static SampleMean reference(std::size_t plate, const std::vector<Reflectance>& maps) {
        return traced_irradiance(*channel_, channel_->plates[plate], maps, 1, 8192, plate);
    }
    static std::vector<double> sum_of(const std::vector<double>& a, const std::vector<double>& b) {
        std::vector<double> sum = a;
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += b[i];
        return sum;
    }

    static std::unique_ptr<NarrowChannel> channel_;
    static std::unique_ptr<Runs> runs_;
};

std::unique_ptr<NarrowChannel> NarrowLobesOfAChannel::channel_;
std::unique_ptr<NarrowLobesOfAChannel::Runs> NarrowLobesOfAChannel::runs_;

TEST_F(NarrowLobesOfAChannel, AreNeitherCountedTwiceNorLost) {
    for (std::size_t plate = 0; plate < kNumPlates; ++plate) {
        const SampleMean both = estimate_of(sum_of(runs_->photons[plate], runs_->rest[plate]));
        const SampleMean exact = reference(plate, channel_->maps);
        const SampleMean error = difference(both, exact);
        const double bias = NarrowChannel::bias(kRoughness[1]);
        EXPECT_TRUE(agrees(error, 0, bias * exact.mean))
            << "plate " << plate << ": " << both.mean << " +- " << both.standard_error << ", "
            << exact.mean << " +- " << exact.standard_error;
        EXPECT_LT(bias * exact.mean + 3 * error.standard_error, 0.1 * exact.mean)
            << "the test would see nothing";
    }
    // On the floor both classes count.
    const double photons = estimate_of(runs_->photons[0]).mean;
    const double rest = estimate_of(runs_->rest[0]).mean;
    EXPECT_GT(photons, 0.1 * (photons + rest));
    EXPECT_GT(rest, 0.1 * (photons + rest));
}

TEST_F(NarrowLobesOfAChannel, AreSplitExactlyBetweenPhotonsAndSweeps) {
    // The same light by sweeps alone: share 0 everywhere.
    for (std::size_t plate = 0; plate < kNumPlates; ++plate) {
        const SampleMean both = estimate_of(sum_of(runs_->photons[plate], runs_->rest[plate]));
        const SampleMean swept = estimate_of(runs_->all_swept[plate]);
        const SampleMean error = difference(both, swept);
        const double bias = NarrowChannel::bias(kRoughness[1]);
        EXPECT_TRUE(agrees(error, 0, bias * swept.mean))
            << "plate " << plate << ": " << both.mean << " +- " << both.standard_error << ", "
            << swept.mean << " +- " << swept.standard_error;
        EXPECT_LT(bias * swept.mean + 3 * error.standard_error, 0.1 * swept.mean)
            << "the test would see nothing";
    }
}

TEST_F(NarrowLobesOfAChannel, FollowMapsThatMove) {
    // Photons of the first maps, weighed for others, in which some lobes are narrower, some wider
    // and some that were wide have become narrow: the sweeps' part of those stays whole.
    std::vector<Reflectance> moved = channel_->maps;
    for (std::size_t plate = 0; plate < kNumPlates; ++plate) {
        const double sigma = std::array{0.09, 0.06, 0.11}[plate];
        for (const TexelId texel : channel_->plates[plate]) moved[texel].roughness = sigma;
    }
    for (const TexelId texel : channel_->plates[0]) {
        moved[texel].specular = 1 / (2 * square(moved[texel].roughness));
    }
    // Photons of both walls arrive on the floor.
    std::vector<double> old_photons;
    std::vector<double> new_photons;
    for (std::size_t run = 0; run < kNumRuns; ++run) {
        NarrowLobes followed = channel_->narrow_lobes(run);
        (void)followed.follow(channel_->maps);
        std::vector<Reflectance> walls = moved;
        for (const TexelId texel : channel_->plates[0]) walls[texel] = channel_->maps[texel];
        EXPECT_FALSE(followed.follow(walls));
        NarrowLobes fresh = channel_->narrow_lobes(kNumRuns + run);
        EXPECT_TRUE(fresh.follow(walls));
        EXPECT_TRUE(std::equal(followed.shares().begin(),
                               followed.shares().end(),
                               fresh.shares().begin(),
                               fresh.shares().end()));
        const auto on_floor = [&](const NarrowLobes::Irradiance& light) {
            return channel_->photon_mean(channel_->plates[0], light);
        };
        old_photons.push_back(on_floor(followed.irradiance(0)));
        new_photons.push_back(on_floor(fresh.irradiance(0)));
        if (run == 0) {
            // Photons start on less than half of the light that they should carry.
            EXPECT_TRUE(followed.follow(moved));
        }
    }
    const SampleMean fresh = estimate_of(new_photons);
    const SampleMean error = difference(estimate_of(old_photons), fresh);
    EXPECT_TRUE(agrees(error, 0));
    EXPECT_LT(3 * error.standard_error, 0.05 * fresh.mean) << "the test would see nothing";
}

TEST_F(NarrowLobesOfAChannel, AreSeenThroughALobeAsThePathTracerSeesThem) {
    // The image in the left wall's narrow lobe, seen from above in the floor's wide one.
    std::vector<Reflectance> maps = channel_->maps;
    for (const TexelId texel : channel_->plates[2]) maps[texel].specular = 0;
    std::vector<TexelId> middle;
    std::vector<std::uint8_t> wanted(maps.size(), 0);
    for (const TexelId texel : channel_->plates[0]) {
        const Texel& at = channel_->atlas.texels[texel];
        if (std::abs(at.column - kFine * 16) > kFine * 8) continue;
        if (std::abs(at.row - kFine * 16) > kFine * 8) continue;
        middle.push_back(texel);
        wanted[texel] = 1;
    }
    const Vec3 w_v = Channel::towards_camera();
    const std::vector<Vec3f> view(maps.size(), w_v.cast<float>());
    std::vector<double> seen;
    for (std::size_t run = 0; run < kNumRuns; ++run) {
        NarrowLobes narrow = channel_->narrow_lobes(run);
        (void)narrow.follow(maps);
        double sum = 0;
        for (std::size_t lamp = 0; lamp < channel_->scene.lights.size(); ++lamp) {
            std::vector<IndirectLobe> lobe(maps.size());
            narrow.add_lobe(0, lamp, view, maps, wanted, {lobe.data()});
            sum +=
                mean_over(middle, [&](TexelId texel) { return double(lobe[texel].same.mean()); });
        }
        seen.push_back(sum);
    }
    const ReflectanceField field =
        ReflectanceField::per_texel(channel_->scene.mesh, channel_->atlas, maps);
    const SampleMean exact = randomised_mean(128, 8192, 5, [&](SobolSampler& sampler) {
        const TexelId texel = random_texel(middle, sampler);
        return sample_through_lobe(channel_->scene,
                                   field,
                                   channel_->atlas.texels[texel].point,
                                   w_v,
                                   kRoughness[0],
                                   sampler)
            .direct.mean();
    });
    const SampleMean photons = estimate_of(seen);
    const SampleMean error = difference(photons, exact);
    const double bias = NarrowChannel::bias(kRoughness[1]);
    EXPECT_TRUE(agrees(error, 0, bias * exact.mean))
        << photons.mean << " +- " << photons.standard_error << ", " << exact.mean << " +- "
        << exact.standard_error;
    EXPECT_LT(bias * exact.mean + 3 * error.standard_error, 0.1 * exact.mean)
        << "the test would see nothing";
}

TEST_F(NarrowLobesOfAChannel, AreTheSameForAnyNumberOfThreads) {
    const auto light = [&](int threads) {
        const ThreadLimit limit(threads);
        NarrowLobes narrow = channel_->narrow_lobes(3);
        (void)narrow.follow(channel_->maps);
        (void)narrow.follow(channel_->maps);
        return narrow;
    };
    const NarrowLobes one = light(1);
    const NarrowLobes two = light(2);
    EXPECT_TRUE(same_bytes(one.irradiance(0), two.irradiance(0)));
    const std::vector<Vec3f> view(channel_->maps.size(), Channel::towards_camera().cast<float>());
    const std::vector<std::uint8_t> wanted(channel_->maps.size(), 1);
    const auto seen = [&](const NarrowLobes& narrow) {
        std::vector<IndirectLobe> lobe(channel_->maps.size());
        narrow.add_lobe(0, 0, view, channel_->maps, wanted, {lobe.data()});
        return lobe;
    };
    EXPECT_TRUE(same_bytes(seen(one), seen(two)));
}

TEST(NarrowLobes, CostNothingWhereThereAreNone) {
    const Channel channel;
    NarrowLobes narrow(channel.scene.surface(),
                       channel.atlas,
                       {lamp_block(channel.scene.lights, channel.direct)},
                       NarrowLobeOptions{});
    EXPECT_FALSE(narrow.follow(channel.maps));
    EXPECT_TRUE(narrow.shares().empty());
}

TEST(NarrowLobes, SplitSmoothlyFromAllToNothing) {
    EXPECT_EQ(photon_share(kMinRoughness), 1);
    EXPECT_EQ(photon_share(kMaxRoughness), 0);
    EXPECT_EQ(photon_share(0.15), 0) << "Channel has no narrow lobes";
    constexpr double kStep = 1e-4;
    for (double sigma = kMinRoughness; sigma < 0.2; sigma += kStep) {
        const double before = photon_share(sigma);
        const double after = photon_share(sigma + kStep);
        EXPECT_LE(after, before);
        // A cubic from 1 to 0 over 0.04 rad is nowhere steeper than 1.5 / 0.04.
        EXPECT_LE(before - after, 1.5 / 0.04 * kStep * (1 + 1e-9));
    }
}

}  // namespace
}  // namespace patina
