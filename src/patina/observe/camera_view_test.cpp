#include "patina/observe/camera_view.h"

#include <gtest/gtest.h>

#include "support/scenes.h"

namespace patina {
namespace {

// The square [-1, 1]^2 of the plane z = 0 facing +z, and a smaller one floating above its right
// half.
Mesh plane_under_a_tile() {
    Mesh mesh;
    append(mesh, rectangle({-1, -1, 0}, 2 * Vec3::UnitX(), 2 * Vec3::UnitY(), {{0, 0}, {0.5, 1}}));
    append(mesh,
           rectangle({0.2, -0.5, 0.5}, 0.5 * Vec3::UnitX(), Vec3::UnitY(), {{0.6, 0}, {1, 1}}));
    return mesh;
}

// Looks down -z from above, y up in the world is up in the image.
Camera orthographic_from_above() {
    Camera camera;
    camera.model = CameraModel::orthographic;
    camera.width = 100;
    camera.height = 100;
    camera.pixel_size = 0.02;
    camera.world_from_camera.rotation = Vec3(1, -1, -1).asDiagonal();
    camera.world_from_camera.translation = {0, 0, 3};
    return camera;
}

TEST(CameraView, SeesWhatLiesInFrontAndNotWhatIsCovered) {
    const Mesh mesh = plane_under_a_tile();
    const TexelAtlas atlas = build_atlas(mesh, 200, 200);
    const Tracer tracer(mesh);
    const auto views = view_texels(mesh, tracer, atlas, orthographic_from_above());
    int num_hidden = 0;
    int num_edge = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const Vec3& p = atlas.texels[i].point.position;
        const bool on_plane = p.z() < 0.1;
        const bool covered = on_plane && p.x() > 0.2 && p.x() < 0.7 && std::abs(p.y()) < 0.5;
        EXPECT_EQ(views[i].state == ViewState::hidden, covered);
        num_hidden += covered;
        if (views[i].state == ViewState::hidden) continue;
        EXPECT_NEAR(views[i].cos_v, 1, 1e-6);
        EXPECT_NEAR(views[i].pixel.x(), 50 + p.x() / 0.02, 1e-3);
        EXPECT_NEAR(views[i].pixel.y(), 50 - p.y() / 0.02, 1e-3);
        // Two pixels (0.04) from every border of the tile nothing mixes.
        const double to_border = std::max({0.2 - p.x(), p.x() - 0.7, std::abs(p.y()) - 0.5});
        const bool far_from_tile = on_plane ? to_border > 0.04 : to_border < -0.04;
        const bool far_from_rim = std::max(std::abs(p.x()), std::abs(p.y())) < 0.96;
        if (far_from_tile && far_from_rim) {
            EXPECT_EQ(views[i].state, ViewState::clear);
        }
        // Half a pixel inside the tile's border the footprint holds both surfaces. (The plane's
        // texels lie on pixel centres and read one pixel each.)
        if (!on_plane && to_border > -0.01) {
            EXPECT_EQ(views[i].state, ViewState::edge);
            ++num_edge;
        }
    }
    EXPECT_GT(num_hidden, 0);
    EXPECT_GT(num_edge, 0);
}

TEST(CameraView, BackOfTheSurfaceIsHidden) {
    const Mesh mesh = plane_under_a_tile();
    const TexelAtlas atlas = build_atlas(mesh, 16, 16);
    const Tracer tracer(mesh);
    Camera camera = orthographic_from_above();
    camera.world_from_camera.rotation = Mat3::Identity();
    camera.world_from_camera.translation = {0, 0, -3};
    for (const TexelView& view : view_texels(mesh, tracer, atlas, camera)) {
        EXPECT_EQ(view.state, ViewState::hidden);
    }
}

TEST(CameraView, RegisteredCameraReadsTheTexelItself) {
    const Mesh mesh = plane_under_a_tile();
    const TexelAtlas atlas = build_atlas(mesh, 16, 16);
    const Tracer tracer(mesh);
    Camera camera;
    camera.model = CameraModel::registered;
    camera.width = camera.height = 16;
    camera.position = {0, 0, 5};
    const auto views = view_texels(mesh, tracer, atlas, camera);
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (views[i].state == ViewState::hidden) continue;
        EXPECT_EQ(views[i].state, ViewState::clear);
        EXPECT_EQ(views[i].pixel.x(), float(atlas.texels[i].column) + 0.5f);
        EXPECT_EQ(views[i].pixel.y(), float(atlas.texels[i].row) + 0.5f);
    }
    EXPECT_EQ(pixel_over_texel(atlas, camera, views), 1);
}

TEST(CameraView, PixelOverTexelComparesSizesOnTheSurface) {
    Mesh mesh;
    append(mesh, rectangle({-1, -1, 0}, 2 * Vec3::UnitX(), 2 * Vec3::UnitY(), {{0, 0}, {1, 1}}));
    const TexelAtlas atlas = build_atlas(mesh, 50, 50);
    const Tracer tracer(mesh);
    const Camera camera = orthographic_from_above();
    const auto views = view_texels(mesh, tracer, atlas, camera);
    // Pixels of 0.02 against texels of 2/50 = 0.04.
    EXPECT_NEAR(pixel_over_texel(atlas, camera, views), 0.5, 1e-6);
}

}  // namespace
}  // namespace patina
