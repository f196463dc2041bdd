#include "patina/scene/range_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace patina {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Camera orthographic(int width, int height, double pixel_size) {
    Camera camera;
    camera.model = CameraModel::orthographic;
    camera.width = width;
    camera.height = height;
    camera.pixel_size = pixel_size;
    return camera;
}

RangeFrame orthographic_frame(int width, int height, double pixel_size = 1) {
    RangeFrame frame;
    frame.projection = RangeProjection::camera;
    frame.camera = orthographic(width, height, pixel_size);
    return frame;
}

double total_area(const Mesh& mesh) {
    double sum = 0;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) sum += triangle_area(mesh, t);
    return sum;
}

double uv_area(const Mesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec2 a = (mesh.uvs[t[1]] - mesh.uvs[t[0]]).cast<double>();
        const Vec2 b = (mesh.uvs[t[2]] - mesh.uvs[t[0]]).cast<double>();
        sum += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
    }
    return sum;
}

// Largest angle between the vertex normals and the given true ones [rad], over vertices that
// `counts`.
template <typename Truth, typename Counts>
double largest_normal_error(const Mesh& mesh, const Truth& truth, const Counts& counts) {
    double largest = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3 p = mesh.positions[i].cast<double>();
        if (!counts(p)) continue;
        const Vec3 n = mesh.normals[i].cast<double>();
        largest = std::max(largest, std::atan2(n.cross(truth(p)).norm(), n.dot(truth(p))));
    }
    return largest;
}

TEST(RangeImage, CylinderPixelsLieWhereTheFormatSays) {
    RangeFrame frame;
    frame.azimuth_begin = radians(10);
    frame.azimuth_end = radians(50);
    frame.height_begin = 1;
    frame.height_end = 3;
    const Mesh mesh = mesh_from_range(frame, Image(4, 2, 1, 5.0f));
    ASSERT_EQ(mesh.positions.size(), 8u);
    EXPECT_EQ(mesh.triangles.size(), 6u);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec2 uv = mesh.uvs[i].cast<double>();
        const double phi = radians(10 + 40 * uv.x());
        const double y = 1 + 2 * uv.y();
        EXPECT_LT((mesh.positions[i].cast<double>() - Vec3(5 * std::sin(phi), y, 5 * std::cos(phi)))
                      .norm(),
                  1e-5);
    }
    EXPECT_NEAR(column_azimuth(frame, 4, 0), radians(15), 1e-12);
}

class CylinderSense : public testing::TestWithParam<std::array<double, 4>> {};

TEST_P(CylinderSense, NormalsPointAwayFromTheAxis) {
    const auto [a0, a1, y0, y1] = GetParam();
    RangeFrame frame;
    frame.azimuth_begin = a0;
    frame.azimuth_end = a1;
    frame.height_begin = y0;
    frame.height_end = y1;
    const Mesh mesh = mesh_from_range(frame, Image(24, 5, 1, 2.0f));
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const SurfacePoint point = surface_point(mesh, t, Vec2f(0.3f, 0.3f));
        const Vec3 outwards = Vec3(point.position.x(), 0, point.position.z()).normalized();
        EXPECT_GT(point.geometric_normal.dot(outwards), 0.9);
        EXPECT_GT(point.normal.dot(outwards), 0.9);
    }
}

INSTANTIATE_TEST_SUITE_P(Frames,
                         CylinderSense,
                         testing::Values(std::array{0.0, 2 * kPi, 0.0, 1.0},
                                         std::array{2 * kPi, 0.0, 0.0, 1.0},
                                         std::array{-1.0, 1.0, 1.0, -1.0},
                                         std::array{1.0, -1.0, 1.0, -1.0}));

TEST(RangeImage, FullTurnIsClosedAndCoversTheDomainToItsBorders) {
    constexpr int kWidth = 16;
    constexpr int kHeight = 4;
    RangeFrame frame;
    ASSERT_TRUE(frame.wraps_around());
    const Mesh mesh = mesh_from_range(frame, Image(kWidth, kHeight, 1, 1.0f));
    // A prism of 16 sides over the rows between the outermost centres.
    const double side = 2 * std::sin(kPi / kWidth);
    EXPECT_NEAR(total_area(mesh), kWidth * side * (kHeight - 1.0) / kHeight, 1e-5);
    EXPECT_NEAR(uv_area(mesh), (kHeight - 1.0) / kHeight, 1e-6);
    for (const Vec2f& uv : mesh.uvs) {
        EXPECT_GE(uv.x(), 0.0f);
        EXPECT_LE(uv.x(), 1.0f);
    }
    for (const Triangle& t : mesh.triangles) {
        const auto [low, high] =
            std::minmax({mesh.uvs[t[0]].x(), mesh.uvs[t[1]].x(), mesh.uvs[t[2]].x()});
        EXPECT_LE(high - low, 1.0f / kWidth + 1e-6f);
    }
}

TEST(RangeImage, PartOfATurnStaysOpen) {
    RangeFrame frame;
    frame.azimuth_end = radians(350);
    EXPECT_FALSE(frame.wraps_around());
    EXPECT_EQ(mesh_from_range(frame, Image(16, 4, 1, 1.0f)).triangles.size(), 2u * 15 * 3);
}

TEST(RangeImage, PinholeDepthIsZAndFacesTheCamera) {
    RangeFrame frame;
    frame.projection = RangeProjection::camera;
    Camera& camera = frame.camera;
    camera.width = camera.height = 10;
    camera.fx = camera.fy = 20;
    camera.cx = camera.cy = 5;
    camera.world_from_camera.rotation = Eigen::AngleAxisd(1, Vec3::UnitX()).toRotationMatrix();
    camera.world_from_camera.translation = Vec3(1, 2, 3);
    Image range(10, 10, 1, 4.0f);
    range.at(9, 9) = 0;
    const Mesh mesh = mesh_from_range(frame, range);
    ASSERT_EQ(mesh.positions.size(), 99u);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3 p = mesh.positions[i].cast<double>();
        EXPECT_NEAR(camera.depth_of(p), 4, 1e-5);
        const auto pixel = camera.project(p);
        ASSERT_TRUE(pixel);
        EXPECT_NEAR(pixel->x() / 10, double(mesh.uvs[i].x()), 1e-5);
        EXPECT_NEAR(1 - pixel->y() / 10, double(mesh.uvs[i].y()), 1e-5);
        EXPECT_GT(mesh.normals[i].cast<double>().dot(camera.direction_from(p, 0)), 0.5);
    }
    EXPECT_GT(surface_point(mesh, 0, Vec2f(0, 0))
                  .geometric_normal.dot(camera.direction_from(mesh.positions[0].cast<double>(), 0)),
              0.5);
}

TEST(RangeImage, OrthographicDepthMayBeZeroOrNegative) {
    Image range(3, 2, 1, 0.0f);
    range.at(0, 0) = -0.5f;
    EXPECT_EQ(mesh_from_range(orthographic_frame(3, 2), range).positions.size(), 6u);
}

TEST(RangeImage, QuadOfThreeMeasuredCornersGivesOneTriangle) {
    Image range(2, 2, 1, 1.0f);
    range.at(1, 0) = kNan;
    const Mesh mesh = mesh_from_range(orthographic_frame(2, 2), range);
    EXPECT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.positions.size(), 3u);
    EXPECT_LT((mesh.normals[0].cast<double>() + Vec3::UnitZ()).norm(), 1e-6);
}

TEST(RangeImage, CutsAlongTheShorterDiagonal) {
    Image range(2, 2, 1, 0.0f);
    range.at(0, 0) = 1.0f;  // the diagonal from here is longer than the other
    RangeFrame frame = orthographic_frame(2, 2);
    frame.max_step = 10;
    const Mesh mesh = mesh_from_range(frame, range);
    ASSERT_EQ(mesh.triangles.size(), 2u);
    // The raised corner belongs to one triangle only.
    int uses = 0;
    for (const Triangle& t : mesh.triangles) {
        for (const std::uint32_t v : t) uses += mesh.positions[v].z() == 1.0f ? 1 : 0;
    }
    EXPECT_EQ(uses, 1);
}

TEST(RangeImage, DoesNotJoinAcrossSteps) {
    // Two plates of 4 x 5 pixels, one above the other; by default a step above 4 pixels is a
    // border.
    const auto triangles_with_step = [](float step) {
        Image range(8, 5, 1, 10.0f);
        for (int j = 0; j < 5; ++j) {
            for (int i = 4; i < 8; ++i) range.at(i, j) += step;
        }
        return mesh_from_range(orthographic_frame(8, 5), range).triangles.size();
    };
    EXPECT_EQ(triangles_with_step(5.0f), 2u * (3 * 4 + 3 * 4));
    EXPECT_EQ(triangles_with_step(3.0f), 2u * 7 * 4);
}

TEST(RangeImage, LeavesOutPixelsThatStandAlone) {
    Image range(5, 3, 1, kNan);
    for (int j = 0; j < 3; ++j) range.at(0, j) = range.at(1, j) = 1.0f;
    range.at(4, 1) = 1.0f;
    EXPECT_EQ(mesh_from_range(orthographic_frame(5, 3), range).positions.size(), 6u);
    EXPECT_TRUE(mesh_from_range(orthographic_frame(5, 3), Image(5, 3, 1, kNan)).triangles.empty());
}

// Central differences of azimuth on a circle have the exact direction: only rounding is left.
TEST(RangeImage, NormalsOfACylinderAreExact) {
    const Mesh mesh = mesh_from_range(RangeFrame{}, Image(64, 8, 1, 1.0f));
    const double error = largest_normal_error(
        mesh,
        [](const Vec3& p) { return Vec3(p.x(), 0, p.z()).normalized(); },
        [](const Vec3&) { return true; });
    EXPECT_LT(error, 1e-6);
}

Mesh sphere_seen_from_afar(int num_pixels) {
    Image range(num_pixels, num_pixels, 1, kNan);
    const double pixel_size = 2.0 / num_pixels;
    for (int j = 0; j < num_pixels; ++j) {
        for (int i = 0; i < num_pixels; ++i) {
            const double x = (i + 0.5) * pixel_size - 1;
            const double y = (j + 0.5) * pixel_size - 1;
            const double z2 = 1 - x * x - y * y;
            if (z2 > 0) range.at(i, j) = static_cast<float>(2 - std::sqrt(z2));
        }
    }
    return mesh_from_range(orthographic_frame(num_pixels, num_pixels, pixel_size), range);
}

// On z = sqrt(1 - r^2) the central difference errs by h^2/6 d3z/dx3 in the slope; within r < 0.6,
// d3z/dx3 = 3x (1 - y^2) / z^5 < 5.5, and the angle errs by at most the slope: below h^2 per axis.
TEST(RangeImage, NormalsOfASphereAreOfSecondOrder) {
    const auto error_at = [](int num_pixels) {
        return largest_normal_error(
            sphere_seen_from_afar(num_pixels),
            [](const Vec3& p) { return (p - Vec3(0, 0, 2)).normalized(); },
            [](const Vec3& p) { return p.head<2>().norm() < 0.6; });
    };
    const double coarse = error_at(32);
    const double fine = error_at(64);
    EXPECT_LT(coarse, 2 * square(2.0 / 32));
    // Twice the resolution, a quarter of the error; the outermost pixels move within r < 0.6 a
    // little.
    EXPECT_NEAR(coarse / fine, 4, 1);
}

}  // namespace
}  // namespace patina
