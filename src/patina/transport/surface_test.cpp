#include "patina/transport/surface.h"

#include <gtest/gtest.h>

#include "support/lit_scene.h"
#include "support/scenes.h"

namespace patina {
namespace {

Mesh unit_square() { return rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()); }

TEST(ReflectanceField, IsLinearOverATriangle) {
    const Mesh mesh = unit_square();
    const std::vector<Reflectance> vertices = {{Rgb(0.1, 0.2, 0.3), 0.0, 0.1},
                                               {Rgb(0.5, 0.6, 0.7), 1.0, 0.3},
                                               {Rgb(0.9, 0.8, 0.7), 2.0, 0.5},
                                               {}};
    const Reflectance r = ReflectanceField::per_vertex(mesh, vertices).at(0, Vec2f(0.25F, 0.5F));
    EXPECT_NEAR(r.diffuse[0], 0.25 * 0.1 + 0.25 * 0.5 + 0.5 * 0.9, 1e-15);
    EXPECT_NEAR(r.diffuse[1], 0.25 * 0.2 + 0.25 * 0.6 + 0.5 * 0.8, 1e-15);
    EXPECT_NEAR(r.specular, 0.25 * 1 + 0.5 * 2, 1e-15);
    EXPECT_NEAR(r.roughness, 0.25 * 0.1 + 0.25 * 0.3 + 0.5 * 0.5, 1e-15);
}

TEST(ReflectanceField, PerTexelIsTheTexelOfThePoint) {
    const Mesh mesh = unit_square();
    const TexelAtlas atlas = build_atlas(mesh, 4, 4);
    std::vector<Reflectance> texels(atlas.texels.size());
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i].specular = double(i);
    const ReflectanceField field = ReflectanceField::per_texel(mesh, atlas, texels);
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const SurfacePoint& point = atlas.texels[i].point;
        EXPECT_EQ(field.at(point.triangle, point.barycentric).specular, double(i));
    }
}

TEST(ReflectanceField, PerTexelAndPerVertexAgreeOnAConstantMaterial) {
    const Reflectance material{Rgb(0.3, 0.5, 0.7), 0.4, 0.15};
    const LitScene scene(inward_box(Vec3(1, 2, 3)), material, {});
    const TexelAtlas atlas = build_atlas(scene.mesh, 48, 32);
    const std::vector<Reflectance> texels(atlas.texels.size(), material);
    const ReflectanceField per_texel = ReflectanceField::per_texel(scene.mesh, atlas, texels);
    const AreaSampler points(scene.mesh);
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(1, Pass::tests, i);
        const double choice = rng.uniform();
        const double u = rng.uniform();
        const SurfacePoint point = points.sample(choice, {u, rng.uniform()});
        const Reflectance a = per_texel.at(point.triangle, point.barycentric);
        const Reflectance b = scene.field().at(point.triangle, point.barycentric);
        EXPECT_LE((a.diffuse - b.diffuse).abs().maxCoeff(), 1e-15);
        EXPECT_NEAR(a.specular, b.specular, 1e-15);
        EXPECT_NEAR(a.roughness, b.roughness, 1e-15);
    }
}

TEST(IsLit, AnswersForBothNormalsAndForWhatIsInBetween) {
    // A square at z = 0 facing up, and a smaller one above half of it.
    Mesh mesh = unit_square();
    append(mesh, rectangle(Vec3(0.5, 0, 0.5), Vec3(0.5, 0, 0), Vec3::UnitY()));
    const LitScene scene(mesh, lambertian(0.5), {});
    const Light above = point_light(Vec3(0.25, 0.5, 1), 1);
    const auto lit = [&](const Light& light, SurfacePoint point) {
        return is_lit(scene.surface(), point, sample_light(light, point.position, 0));
    };
    const SurfacePoint open = surface_point(scene.mesh, 1, Vec2f(0.25F, 0.5F));
    EXPECT_TRUE(lit(above, open));
    EXPECT_FALSE(lit(point_light(Vec3(0.25, 0.5, -1), 1), open)) << "a light behind";

    const SurfacePoint covered = surface_point(scene.mesh, 0, Vec2f(0.25F, 0.5F));
    ASSERT_GT(covered.position.x(), 0.5);
    EXPECT_FALSE(lit(point_light(Vec3(0.75, 0.5, 1), 1), covered)) << "the back stops light";
    EXPECT_TRUE(lit(point_light(Vec3(0.75, 0.5, 0.25), 1), covered)) << "a light below the cover";

    SurfacePoint tilted = open;
    tilted.normal = Vec3(0.8, 0, -0.6);
    EXPECT_FALSE(lit(above, tilted)) << "the smooth normal turns away";
}

TEST(DirectIrradiance, IsTheSmoothCosineTimesEveryLampThatShines) {
    const LitScene scene(
        unit_square(),
        lambertian(0.5),
        {point_light(Vec3(0.5, 0.5, 2), 3), directional_light(Vec3(0.6, 0, 0.8), 5)});
    SurfacePoint point = surface_point(scene.mesh, 0, Vec2f(0, 0.5F));
    ASSERT_TRUE(point.position.isApprox(Vec3(0.5, 0.5, 0)));
    const auto irradiance = [&] {
        return direct_irradiance(scene.surface(), scene.lights, 0, point)[1];
    };
    EXPECT_NEAR(irradiance(), 3.0 / 4 + 5 * 0.8, 1e-12);
    point.normal = Vec3(0.6, 0, 0.8);
    EXPECT_NEAR(irradiance(), 3.0 / 4 * 0.8 + 5, 1e-12);
}

TEST(DirectRadiance, IsReflectanceTimesIrradianceInFrontAndZeroBehind) {
    const Reflectance material{Rgb(0.3, 0.5, 0.7), 0.4, 0.15};
    const LitScene scene(unit_square(), material, {directional_light(Vec3(0.6, 0, 0.8), 5)});
    const SurfacePoint point = surface_point(scene.mesh, 0, Vec2f(0, 0.5F));
    const Vec3 w_o(-0.48, 0.6, 0.64);
    const auto radiance = [&](const Vec3& w) {
        return direct_radiance(scene.surface(), material, scene.lights, 0, point, w);
    };
    const Rgb expected = 5 * 0.8 * evaluate(material, Vec3::UnitZ(), Vec3(0.6, 0, 0.8), w_o);
    EXPECT_LE((radiance(w_o) - expected).abs().maxCoeff(), 1e-12);
    EXPECT_TRUE((radiance(Vec3(-0.48, 0.6, -0.64)) == 0).all());
}

}  // namespace
}  // namespace patina
