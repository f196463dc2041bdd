#include "patina/transport/gather_sweep.h"
#include "patina/transport/photon_lanes.h"

#include <gtest/gtest.h>

#include "support/gathered_light.h"
#include "support/lit_scene.h"
#include "support/scenes.h"
#include <algorithm>
#include <cmath>
#include <vector>

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
    std::vector<LargeVector<DirectLight>> direct_{
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

TEST_F(LitFloor, IsLitByMoreRaysThanGoInOneWave) {
    GatherOptions options;
    options.rays = 4 * int(kWaveSize);
    GatheredLight light(
        scene_.surface(), atlas_, lamp_block(scene_.lights, direct_), maps_, options);
    light.sweep(1);
    std::vector<double> errors;
    double mean = 0;
    const GatherRows& rows = light.graph().irradiance;
    for (const TexelId texel : wall_) {
        errors.push_back(light.irradiance(texel) - exact(texel));
        mean += exact(texel) / double(wall_.size());
        const std::size_t num_hits = rows.of(texel).size();
        const auto first = rows.glossy.begin() + std::ptrdiff_t(rows.glossy_begin[texel]);
        const auto last = rows.glossy.begin() + std::ptrdiff_t(rows.glossy_begin[texel + 1]);
        EXPECT_TRUE(std::is_sorted(
            first, last, [](const GlossyHit& a, const GlossyHit& b) { return a.hit < b.hit; }));
        EXPECT_TRUE(first == last || (last - 1)->hit < num_hits);
    }
    const SampleMean error = estimate_of(errors);
    EXPECT_TRUE(agrees(error, 0, kRounding * mean));
    EXPECT_LT(error.standard_error, 0.0005 * mean) << "the test would see nothing";
}

TEST(ClosedRoom, FillsWithLightGeometrically) {
    // Under the same irradiance E everywhere, n sweeps leave E (rho + ... + rho^n) everywhere,
    // whatever the rays are, since all of them meet the same light. The limit is rho E / (1 - rho).
    const LitScene scene(inward_box(Vec3(1, 2, 1.5)), {}, {directional_light(Vec3::UnitZ(), 2)});
    const TexelAtlas atlas = build_atlas(scene.mesh, 30, 20);
    DirectLight even;
    even.irradiance = Rgbf::Constant(2);
    even.cos_i = 1;
    const std::vector<LargeVector<DirectLight>> direct = {
        LargeVector<DirectLight>(atlas.texels.size(), even)};
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
    const std::vector<LargeVector<DirectLight>> direct = {
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

}  // namespace
}  // namespace patina
