#include "patina/transport/direct.h"

#include <gtest/gtest.h>

#include "support/lit_scene.h"
#include "support/scenes.h"
#include <cmath>

namespace patina {
namespace {

// Numbers are stored in single precision; a product of five factors rounds by a few units of 6e-8.
constexpr double kFloatError = 1e-6;
constexpr int kSize = 16;  // texels along a side

TEST(DirectLight, OfAPointLampFallsWithTheSquareOfItsDistance) {
    const Vec3 lamp(0.3, 0.8, 1.5);
    constexpr double kIntensity = 2;
    const LitScene scene(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()),
                         lambertian(0.5),
                         {point_light(lamp, kIntensity)});
    const TexelAtlas atlas = build_atlas(scene.mesh, kSize, kSize);
    const LargeVector<DirectLight> direct =
        direct_light(scene.surface(), atlas, scene.lights.front());
    ASSERT_EQ(direct.size(), std::size_t(kSize * kSize));
    for (std::size_t i = 0; i < direct.size(); ++i) {
        const Vec3 to_lamp = lamp - atlas.texels[i].point.position;
        const double distance = to_lamp.norm();
        const double expected = kIntensity * lamp.z() / std::pow(distance, 3);
        EXPECT_NEAR(double(direct[i].irradiance[0]), expected, kFloatError * expected);
        EXPECT_NEAR(double(direct[i].cos_i), lamp.z() / distance, kFloatError);
        EXPECT_LT((direct[i].w_i.cast<double>() - to_lamp / distance).norm(), kFloatError);
        EXPECT_EQ(direct[i].state, ShadowState::lit);
    }
}

TEST(DirectLight, NeverReachesASurfaceThatFacesAway) {
    const LitScene scene(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()),
                         lambertian(0.5),
                         {directional_light(-Vec3::UnitZ(), 1)});
    const TexelAtlas atlas = build_atlas(scene.mesh, kSize, kSize);
    for (const DirectLight& direct : direct_light(scene.surface(), atlas, scene.lights.front())) {
        EXPECT_EQ(direct.state, ShadowState::dark);
        EXPECT_TRUE((direct.irradiance == 0).all());
    }
}

TEST(DirectLight, OfATurningLampComesFromEveryTexelsOwnAzimuth) {
    const LitScene scene(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()),
                         lambertian(0.5),
                         {point_light(Vec3(0, 0, 3), 1)});
    TexelAtlas atlas = build_atlas(scene.mesh, kSize, kSize);
    for (Texel& texel : atlas.texels) texel.azimuth = 0.05 * texel.column;
    Light lamp = scene.lights.front();
    lamp.frame = FrameOfReference::scanner;
    const LargeVector<DirectLight> direct = direct_light(scene.surface(), atlas, lamp);
    for (std::size_t i = 0; i < direct.size(); ++i) {
        const Vec3 position = rotate_about_y(atlas.texels[i].azimuth, lamp.position);
        const Vec3 w_i = (position - atlas.texels[i].point.position).normalized();
        EXPECT_LT((direct[i].w_i.cast<double>() - w_i).norm(), kFloatError);
    }
}

// A floor under light from above, half of it below a roof that ends over the middle of a texel's
// border: columns 0 to 7 are dark.
struct RoofedFloor {
    LitScene scene = [] {
        Mesh mesh = rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), {{0, 0}, {0.5, 1}});
        append(mesh,
               rectangle(
                   Vec3(-1, -1, 0.5), Vec3(1.5, 0, 0), Vec3(0, 3, 0), {{0.75, 0.25}, {1, 0.75}}));
        return LitScene(mesh, lambertian(0.5), {directional_light(Vec3::UnitZ(), 1)});
    }();
    TexelAtlas atlas = build_atlas(scene.mesh, 2 * kSize, kSize);
};

// Columns from begin to end - 1 are edge; those before are dark and those after lit.
void expect_edge_columns(const RoofedFloor& floor, int rings, int begin, int end) {
    const LargeVector<DirectLight> direct =
        direct_light(floor.scene.surface(), floor.atlas, floor.scene.lights.front(), rings);
    for (std::size_t i = 0; i < direct.size(); ++i) {
        const Texel& texel = floor.atlas.texels[i];
        if (texel.column >= kSize) continue;  // the roof
        const ShadowState expected = texel.column < begin ? ShadowState::dark
                                     : texel.column < end ? ShadowState::edge
                                                          : ShadowState::lit;
        EXPECT_EQ(direct[i].state, expected) << texel.column << ", " << texel.row;
        EXPECT_EQ(direct[i].irradiance[0], texel.column < kSize / 2 ? 0.0F : 1.0F);
    }
}

TEST(DirectLight, MarksOneTexelOnEitherSideOfAShadowsEdge) {
    expect_edge_columns(RoofedFloor(), 1, 7, 9);
}

TEST(DirectLight, MarksAsManyRingsAsAskedFor) { expect_edge_columns(RoofedFloor(), 3, 5, 11); }

}  // namespace
}  // namespace patina
