#include "patina/transport/photon_columns.h"

#include "patina/math/warp.h"
#include "patina/transport/lane_directions.h"

#include <gtest/gtest.h>

#include "support/lit_scene.h"
#include "support/narrow_channel.h"
#include <array>
#include <cmath>
#include <vector>

namespace patina {
namespace {

// A texel of the channel's left wall, seen by the scanner from aside, and a lamp that turns.
class PhotonsOfAColumn : public testing::Test {
  protected:
    PhotonsOfAColumn() : wall_(channel_.plates[Channel::left][kFine * Channel::kSide * 20]) {
        channel_.atlas.texels[wall_].azimuth = 0.7;
        for (Reflectance& map : channel_.maps) map.diffuse = Rgb::Zero();
    }

    static constexpr std::size_t kNumRuns = 64;
    NarrowChannel channel_{0.17};
    TexelId wall_;
};

TEST_F(PhotonsOfAColumn, HaveTheDensityThatTheyAreDrawnFrom) {
    const PhotonScene scene(channel_.scene.surface(), channel_.atlas, channel_.maps);
    const Light& lamp = channel_.scene.lights.front();
    const PhotonColumns columns(scene, lamp);
    const Texel& texel = channel_.atlas.texels[wall_];
    const PhotonTexel& at = scene.texel(wall_);
    // 1 and the direction, summed over photons that are sent and integrated over their density.
    for (int moment = 0; moment < 4; ++moment) {
        const auto value = [&](const Vec3f& w) {
            return moment == 0 ? 1.0 : double(w[moment - 1]);
        };
        const SampleMean sent = randomised_mean(kNumRuns, 1024, 1, [&](SobolSampler& sampler) {
            const auto [choice, tooth] = sampler.next_pair();
            const double azimuth =
                texel.azimuth + double(PhotonColumns::offset(float(choice), float(tooth)));
            const Vec3 w_i = sample_light(lamp, texel.point.position, azimuth).w_i;
            if (!faces(texel.point, w_i)) return 0.0;
            const Vec3 mirror = 2 * texel.point.normal.dot(w_i) * texel.point.normal - w_i;
            const auto [u, v] = sampler.next_pair();
            const auto [x, y, z] =
                lane_direction(true,
                               {float(mirror.x()), float(mirror.y()), float(mirror.z())},
                               at.concentration,
                               float(u),
                               float(v));
            return value(Vec3f(x, y, z));
        });
        const SampleMean integral = randomised_mean(kNumRuns, 8192, 2, [&](SobolSampler& sampler) {
            const auto [u, v] = sampler.next_pair();
            const double z = 1 - 2 * u;
            const double radius = std::sqrt(std::max(0.0, 1 - z * z));
            const Vec3f w = Vec3(radius * std::cos(2 * kPi * v), radius * std::sin(2 * kPi * v), z)
                                .cast<float>();
            return 4 * kPi * double(columns.density(at, w)) * value(w);
        });
        const SampleMean error = difference(sent, integral);
        EXPECT_TRUE(agrees(error, 0)) << "moment " << moment << ": " << sent.mean << ", "
                                      << integral.mean << " +- " << error.standard_error;
        if (moment > 0) continue;
        EXPECT_GT(sent.mean, 0.5);
        EXPECT_LT(sent.mean, 1) << "some teeth leave the wall dark";
        EXPECT_LT(3 * error.standard_error, 0.02 * sent.mean) << "the test would see nothing";
    }
}

}  // namespace
}  // namespace patina
