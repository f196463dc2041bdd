// The path tracer against pictures of direct light by Mitsuba 3 (mitsuba-data, tests/integrators):
// a plane |x|, |y| <= 1 and a sphere of radius 0.25 about its centre, seen from above.
#include "patina/image/image.h"
#include "patina/transport/path_tracer.h"

#include <gtest/gtest.h>

#include "support/lit_scene.h"
#include "support/scenes.h"
#include "support/shared_data.h"
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patina {
namespace {

constexpr int kSize = 128;  // pixels
constexpr int kNumSamples = 128;

Camera reference_camera() {
    constexpr double kHalfWidth = 0.305941;  // tangent of half the field of view
    Camera camera;
    camera.width = camera.height = kSize;
    camera.fx = camera.fy = 0.5 * kSize / kHalfWidth;
    camera.cx = camera.cy = 0.5 * kSize;
    camera.world_from_camera.rotation = Vec3(1, -1, -1).asDiagonal();
    camera.world_from_camera.translation = Vec3(0, 0, 4);
    return camera;
}

LitScene plane_and_sphere(double plane_albedo, std::vector<Light> lights) {
    Mesh mesh = rectangle(Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0));
    const std::size_t num_plane_vertices = mesh.positions.size();
    append(mesh, sphere(0.25, 256, 128, SphereSide::outward, true));
    LitScene scene(std::move(mesh), lambertian(0.5), std::move(lights));
    std::fill_n(scene.vertices.begin(), num_plane_vertices, lambertian(plane_albedo));
    return scene;
}

// The samples of one pixel, independent of each other.
struct Pixel {
    double mean = 0;
    double variance = 0;  // of one sample
    double smallest = 0;
    double largest = 0;
};

Pixel render_pixel(
    const LitScene& scene, const Camera& camera, const PathTracerOptions& options, int x, int y) {
    std::vector<double> samples;
    for (int i = 0; i < kNumSamples; ++i) {
        SobolSampler sampler(1, Pass::tests, std::uint64_t((y * kSize + x) * kNumSamples + i), 0);
        const std::array<double, 2> inside = sampler.next_pair();
        const Ray ray = camera.ray(Vec2(x + inside[0], y + inside[1]));
        const std::optional<RayHit> hit = scene.tracer.intersect(ray.origin, ray.direction);
        if (!hit) {
            samples.push_back(options.sky_radiance[0]);
            continue;
        }
        const SurfacePoint point = surface_point(scene.mesh, hit->triangle, hit->barycentric);
        const OutgoingRadiance radiance = trace_path(scene.surface(),
                                                     scene.field(),
                                                     scene.lights,
                                                     0,
                                                     point,
                                                     -ray.direction,
                                                     options,
                                                     sampler);
        samples.push_back(radiance.direct[0] + radiance.indirect[0]);
    }
    const auto [smallest, largest] = std::minmax_element(samples.begin(), samples.end());
    const Moments all = moments(samples);
    return {all.mean, all.variance * kNumSamples / (kNumSamples - 1), *smallest, *largest};
}

class ReferenceImage : public testing::Test {
  protected:
    // darkest: what a sample may be in any pixel, however rarely, that sees the surface.
    void compare(const std::string& name,
                 const LitScene& scene,
                 const PathTracerOptions& options,
                 std::optional<double> darkest = std::nullopt) {
        darkest_ = darkest;
        const auto path = shared_data("data/mitsuba_refs/" + name);
        if (!path) GTEST_SKIP() << "no data/mitsuba_refs/" << name << " in PATINA_SHARED";
        reference_ = read_image(*path).image;
        ASSERT_EQ(reference_.width, kSize);
        ASSERT_EQ(reference_.height, kSize);
        const Camera camera = reference_camera();
        pixels_.resize(std::size_t{kSize} * kSize);
        parallel_for(pixels_.size(), [&](std::size_t i) {
            pixels_[i] = render_pixel(scene, camera, options, int(i) % kSize, int(i) / kSize);
        });
        expect_same_pixels();
        expect_same_mean();
    }

  private:
    [[nodiscard]] const Pixel& pixel(int x, int y) const {
        return pixels_[std::size_t(y * kSize + x)];
    }

    // 1 / samples per pixel of the reference, from its own scatter: second differences of
    // neighbours on a piece of open plane, where the picture is smooth, against the variance of one
    // of our samples there. What curvature the picture has makes it larger.
    [[nodiscard]] double reference_noise_share() const {
        double scatter = 0;
        double variance = 0;
        for (int y = 16; y < 40; ++y) {
            for (int x = 16; x < 40; ++x) {
                const double second_difference = double(reference_.at(x - 1, y)) +
                                                 double(reference_.at(x + 1, y)) -
                                                 2 * double(reference_.at(x, y));
                scatter += square(second_difference) / 6;
                variance += pixel(x, y).variance;
            }
        }
        return scatter / variance;
    }

    // Variance of one sample with one more sample's worth of doubt: as far off as any sample of the
    // pixels around. An edge may cross a corner of the pixel that no sample of its own has met.
    [[nodiscard]] double cautious_variance(int x, int y) const {
        double smallest = pixel(x, y).smallest;
        double largest = pixel(x, y).largest;
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, kSize - 1); ++j) {
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, kSize - 1); ++i) {
                smallest = std::min(smallest, pixel(i, j).smallest);
                largest = std::max(largest, pixel(i, j).largest);
            }
        }
        if (darkest_) smallest = std::min(smallest, *darkest_);
        return (kNumSamples * pixel(x, y).variance + square(largest - smallest)) /
               (kNumSamples + 1);
    }

    void expect_same_pixels() const {
        const double threshold =
            student_threshold(kNumSamples - 1, sidak_level(double(pixels_.size())));
        const double share = 1.0 / kNumSamples + reference_noise_share();
        // Float rounding of the picture and of the traced ray.
        constexpr double kRounding = 1e-6;
        int num_different = 0;
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                const double difference = pixel(x, y).mean - double(reference_.at(x, y));
                const double deviation = std::sqrt(cautious_variance(x, y) * share);
                if (std::abs(difference) <= threshold * deviation + kRounding) continue;
                ++num_different;
                ADD_FAILURE() << "pixel " << x << ", " << y << ": " << pixel(x, y).mean << " +- "
                              << deviation << ", reference " << reference_.at(x, y);
                if (num_different == 10) return;
            }
        }
    }

    void expect_same_mean() const {
        double difference = 0;
        double variance = 0;
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                difference += pixel(x, y).mean - double(reference_.at(x, y));
                variance += pixel(x, y).variance;
            }
        }
        const double count = double(pixels_.size());
        const double deviation =
            std::sqrt(variance * (1.0 / kNumSamples + reference_noise_share())) / count;
        // The sphere's facets lie inside it by 8e-5 of its radius, which moves its outline and its
        // shadow's over less than 1e-5 of the picture.
        EXPECT_NEAR(difference / count, 0, normal_threshold() * deviation + 1e-5);
    }

    Image reference_;
    std::optional<double> darkest_;
    std::vector<Pixel> pixels_;
};

TEST_F(ReferenceImage, PointLightShadesAndShadowsAPlaneAndASphere) {
    PathTracerOptions options;
    options.max_bounces = 0;
    compare("point_light_plane_sphere.exr",
            plane_and_sphere(1, {point_light(Vec3(1.25, 0, 1), 5)}),
            options);
}

TEST_F(ReferenceImage, ConstantSkyIsOccludedByASphere) {
    PathTracerOptions options;
    options.max_bounces = 0;
    options.sky_radiance = Rgb::Ones();
    compare("constant_env_plane_sphere.exr", plane_and_sphere(0.5, {}), options, 0.0);
}

}  // namespace
}  // namespace patina
