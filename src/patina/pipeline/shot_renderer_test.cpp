#include "patina/pipeline/shot_renderer.h"

#include "patina/base/error.h"
#include "patina/base/parallel.h"

#include <gtest/gtest.h>

#include "support/false_alarms.h"
#include <limits>

namespace patina {
namespace {

constexpr int kTexels = 4;
constexpr double kDiffuse = 0.6;
constexpr double kIrradiance = 2.0;

// The unit square, facing +z, under a directional light from straight above: every point has the
// radiance Pd E / pi, and no light bounces.
struct FlatScene {
    Capture capture;
    ReflectanceMaps maps;

    FlatScene() {
        Mesh& mesh = capture.mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        mesh.normals.assign(4, Vec3f::UnitZ());
        mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        capture.atlas = build_atlas(mesh, kTexels, kTexels);
        Light light;
        light.type = LightType::directional;
        light.direction = Vec3::UnitZ();
        light.irradiance = Rgb::Constant(kIrradiance);
        capture.description.lights = {light};
        Shot shot;
        shot.lights = {0};
        capture.description.shots = {shot};
        const Image one(kTexels, kTexels, 1);
        const Image three(kTexels, kTexels, 3);
        maps = {Image(kTexels, kTexels, 3, float(kDiffuse)),
                one,
                Image(kTexels, kTexels, 1, 0.2f),
                three,
                one,
                one,
                Image(kTexels, kTexels, 1, 1.0f)};
    }

    [[nodiscard]] RenderedShot render(const Camera& camera, bool with_lobe_errors = false) {
        capture.description.cameras = {camera};
        Progress quiet;
        return ShotRenderer(capture, maps, "result").render(0, {4, 1, with_lobe_errors}, quiet);
    }
};

Camera registered_camera() {
    Camera camera;
    camera.model = CameraModel::registered;
    camera.width = kTexels;
    camera.height = kTexels;
    camera.position = {0.5, 0.5, 2};
    return camera;
}

// Sees [-0.25, 1.25]^2 of the plane on 6 x 6 pixels of a texel's size.
Camera orthographic_camera() {
    Camera camera;
    camera.model = CameraModel::orthographic;
    camera.width = 6;
    camera.height = 6;
    camera.pixel_size = 0.25;
    camera.world_from_camera.rotation = Vec3(1, -1, -1).asDiagonal();
    camera.world_from_camera.translation = {0.5, 0.5, 2};
    return camera;
}

constexpr double kRadiance = kDiffuse * kIrradiance / kPi;
// Radiance is stored in single precision.
constexpr double kRounding = 1e-6;

TEST(ShotRenderer, GivesTheRadianceOfAPlaneToRegisteredCameras) {
    FlatScene scene;
    const RenderedShot shot = scene.render(registered_camera());
    for (const float value : shot.radiance.data) EXPECT_NEAR(value, kRadiance, kRounding);
    for (const std::uint8_t status : shot.status) EXPECT_EQ(status, 1);
}

TEST(ShotRenderer, GivesTheRadianceOfAPlaneToOtherCameras) {
    FlatScene scene;
    const RenderedShot shot = scene.render(orthographic_camera());
    for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 6; ++x) {
            const bool is_inside = x > 0 && x < 5 && y > 0 && y < 5;
            EXPECT_NEAR(shot.radiance.at(x, y), is_inside ? kRadiance : 0, kRounding);
            EXPECT_EQ(shot.status[std::size_t(6 * y + x)], is_inside ? 1 : 0);
        }
    }
}

TEST(ShotRenderer, TellsTheStatusOfWhatAPixelShows) {
    FlatScene scene;
    scene.maps.status.at(2, 1) = 3;
    EXPECT_EQ(scene.render(registered_camera()).status[1 * kTexels + 2], 3);
    // Texel (2, 1) lies under pixel (3, 2) of the orthographic camera.
    EXPECT_EQ(scene.render(orthographic_camera()).status[2 * 6 + 3], 3);
}

// From straight above, under light from there, the lobe of Ps = 1 has its peak, 1 / pi.
TEST(ShotRenderer, CarriesTheErrorsOfLobesThatNoUsedShotShows) {
    FlatScene scene;
    scene.capture.description.shots[0].heldout = true;
    scene.maps.specular_stderr = Image(kTexels, kTexels, 1, 0.2f);
    EXPECT_TRUE(scene.render(orthographic_camera()).lobe_variance.empty());
    const RenderedShot shot = scene.render(orthographic_camera(), true);
    EXPECT_NEAR(shot.lobe_variance.at(3, 2), square(kIrradiance / kPi * 0.2), kRounding);
    EXPECT_EQ(shot.lobe_variance.at(0, 0), 0);
}

TEST(ShotRenderer, TakesUnknownLobesToErrByAllOfThemselves) {
    FlatScene scene;
    scene.capture.description.shots[0].heldout = true;
    scene.maps.specular = Image(kTexels, kTexels, 1, 0.3f);
    scene.maps.specular_stderr = Image(kTexels, kTexels, 1, std::numeric_limits<float>::infinity());
    const RenderedShot shot = scene.render(orthographic_camera(), true);
    EXPECT_NEAR(shot.lobe_variance.at(3, 2), square(kIrradiance / kPi * 0.3), kRounding);
}

// A used shot under the same light has shown the lobe's error in its residuals.
TEST(ShotRenderer, LeavesOutErrorsOfFilledLobesThatUsedShotsShow) {
    FlatScene scene;
    Shot heldout = scene.capture.description.shots[0];
    heldout.heldout = true;
    scene.capture.description.shots.insert(scene.capture.description.shots.begin(), heldout);
    scene.maps.specular_stderr = Image(kTexels, kTexels, 1, 0.2f);
    scene.maps.status = Image(kTexels, kTexels, 1, 2.0f);
    EXPECT_EQ(scene.render(orthographic_camera(), true).lobe_variance.at(3, 2), 0);
    // A lobe that was fitted to that look follows it, whatever it errs.
    scene.maps.status = Image(kTexels, kTexels, 1, 1.0f);
    EXPECT_GT(scene.render(orthographic_camera(), true).lobe_variance.at(3, 2), 0);
}

// A glossy corner: the left half of the texels lies, the right half stands on its edge.
struct CornerScene : FlatScene {
    CornerScene() {
        Mesh& mesh = capture.mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 1}, {1, 1, 1}};
        mesh.positions.insert(mesh.positions.end(), {{1, 0, 0}, {1, 1, 0}});
        mesh.normals.assign(4, Vec3f::UnitZ());
        mesh.normals.insert(mesh.normals.end(), 4, -Vec3f::UnitX());
        mesh.uvs = {{0, 0}, {0.5, 0}, {0.5, 1}, {0, 1}, {1, 0}, {1, 1}, {0.5, 0}, {0.5, 1}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {6, 4, 5}, {6, 5, 7}};
        capture.atlas = build_atlas(mesh, kTexels, kTexels);
        capture.description.lights[0].direction = Vec3(-1, 0, 2).normalized();
        maps.specular = Image(kTexels, kTexels, 1, 0.3f);
        Camera camera = registered_camera();
        camera.position = {-1, 0.5, 2};
        capture.description.cameras = {camera};
    }

    [[nodiscard]] RenderedShot render(std::uint64_t seed, bool adaptive) const {
        ShotRenderOptions options;
        options.samples_per_pixel = 256;
        options.seed = seed;
        options.adaptive = adaptive;
        Progress quiet;
        return ShotRenderer(capture, maps, "result").render(0, options, quiet);
    }
};

double mean_of(const Image& image) {
    double sum = 0;
    for (const float value : image.data) sum += double(value);
    return sum / double(image.data.size());
}

TEST(ShotRenderer, AdaptiveImagesAreThoseOfUniformOnesInTheMean) {
    constexpr std::size_t kNumImages = 200;
    const CornerScene scene;
    std::vector<double> difference(kNumImages);
    for (std::size_t i = 0; i < kNumImages; ++i) {
        difference[i] = mean_of(scene.render(i, true).radiance) -
                        mean_of(scene.render(kNumImages + i, false).radiance);
    }
    EXPECT_TRUE(agrees(estimate_of(difference), 0));
}

// The squared difference of two images has twice the noise's variance in the mean.
TEST(ShotRenderer, StatesTheNoiseOfAdaptiveImages) {
    constexpr std::size_t kNumPairs = 200;
    const CornerScene scene;
    EXPECT_TRUE(scene.render(1, false).noise_variance.empty());
    std::vector<double> excess(kNumPairs);
    for (std::size_t i = 0; i < kNumPairs; ++i) {
        const RenderedShot first = scene.render(2 * i, true);
        const RenderedShot second = scene.render(2 * i + 1, true);
        double squares = 0;
        for (std::size_t k = 0; k < first.radiance.data.size(); ++k) {
            squares += square(double(first.radiance.data[k]) - double(second.radiance.data[k]));
        }
        excess[i] = mean_of(first.noise_variance) + mean_of(second.noise_variance) -
                    squares / double(first.radiance.data.size());
    }
    EXPECT_TRUE(agrees(estimate_of(excess), 0));
}

TEST(ShotRenderer, AdaptiveImagesDoNotDependOnTheThreads) {
    const CornerScene scene;
    const auto render_with = [&](int threads) {
        const ThreadLimit limit(threads);
        return scene.render(1, true).radiance.data;
    };
    EXPECT_EQ(render_with(1), render_with(2));
}

// A pilot of so few paths would tell nothing.
TEST(ShotRenderer, FewPathsAreTheSameForAll) {
    CornerScene scene;
    Progress quiet;
    ShotRenderOptions options;
    options.samples_per_pixel = 64;
    const ShotRenderer renderer(scene.capture, scene.maps, "result");
    const RenderedShot uniform = renderer.render(0, options, quiet);
    options.adaptive = true;
    const RenderedShot adaptive = renderer.render(0, options, quiet);
    EXPECT_EQ(adaptive.radiance.data, uniform.radiance.data);
    EXPECT_TRUE(adaptive.noise_variance.empty());
}

TEST(ShotRenderer, SeesNothingFromBehind) {
    FlatScene scene;
    Camera camera = registered_camera();
    camera.position.z() = -2;
    const RenderedShot shot = scene.render(camera);
    for (const float value : shot.radiance.data) EXPECT_EQ(value, 0);
    for (const std::uint8_t status : shot.status) EXPECT_EQ(status, 0);
}

TEST(ShotRenderer, RejectsMapsOfAnotherSize) {
    FlatScene scene;
    scene.maps.status = Image(3, 3, 1);
    EXPECT_THROW(ShotRenderer(scene.capture, scene.maps, "result"), Error);
}

}  // namespace
}  // namespace patina
