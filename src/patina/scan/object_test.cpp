#include "patina/scan/object.h"

#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/base/random.h"
#include "patina/math/warp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace patina {
namespace {

using testing::HasSubstr;

template <typename Work>
std::string message_of(const Work& work) {
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

// Spectral radius of (Pd times form factors) by power iteration on a grid of texels, with form
// factors from cosine-distributed rays.
double interreflection_radius(const SimulatedObject& object, double diffuse) {
    constexpr int kColumns = 32;
    constexpr int kRows = 20;
    constexpr int kRays = 256;
    constexpr int kIterations = 30;
    constexpr std::size_t kTexels = kColumns * kRows;
    std::vector<std::vector<std::size_t>> hits(kTexels);
    parallel_for(kTexels, [&](std::size_t i) {
        const Vec2 pixel(double(i % kColumns) + 0.5, double(i / kColumns) + 0.5);
        const SurfacePoint point = *point_at_pixel(object, kColumns, kRows, pixel);
        const Frame frame(point.normal);
        for (std::uint32_t ray = 0; ray < kRays; ++ray) {
            SobolSampler sampler(1, Pass::tests, i, ray);
            const Vec3 w = frame.to_world(square_to_cosine_hemisphere(sampler.next_pair()));
            const auto hit = object.tracer.intersect(object.tracer.offset(point, w), w);
            if (!hit) continue;
            const Vec2 uv = surface_uv(object.mesh, hit->triangle, hit->barycentric);
            const int column = std::clamp(int(uv.x() * kColumns), 0, kColumns - 1);
            const int row = std::clamp(int((1 - uv.y()) * kRows), 0, kRows - 1);
            hits[i].push_back(std::size_t(row * kColumns + column));
        }
    });
    std::vector<double> radiosity(kTexels, 1);
    double radius = 0;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        std::vector<double> next(kTexels, 0);
        double largest = 0;
        for (std::size_t i = 0; i < kTexels; ++i) {
            for (const std::size_t hit : hits[i]) next[i] += diffuse / kRays * radiosity[hit];
            largest = std::max(largest, next[i]);
        }
        for (double& value : next) value /= largest;
        radius = largest;
        radiosity = next;
    }
    return radius;
}

TEST(Object, NamesAreUnderstoodInEitherCase) {
    EXPECT_EQ(object_kind_from_name("A"), ObjectKind::a);
    EXPECT_EQ(object_kind_from_name("b"), ObjectKind::b);
    EXPECT_EQ(object_kind_from_name("C"), ObjectKind::c);
    EXPECT_EQ(object_kind_from_name("v45"), ObjectKind::v45);
    EXPECT_EQ(object_kind_from_name("U"), ObjectKind::u);
    EXPECT_EQ(message_of([] { (void)object_kind_from_name("D"); }),
              "OBJECT: 'D' is not known (expected A, B, C, V45 or U)");
}

TEST(Object, RowsMustDivideAmongThePanels) {
    EXPECT_THAT(message_of([] { (void)make_object(ObjectKind::a, 16, 15); }),
                HasSubstr("--texels: 16 x 15"));
    EXPECT_THAT(message_of([] { (void)make_object(ObjectKind::u, 16, 16); }),
                HasSubstr("a multiple of 5"));
    EXPECT_THAT(message_of([] { (void)make_object(ObjectKind::b, 0, 16); }),
                HasSubstr("at least one column"));
}

// The paper's loop contracts by lambda / (1 - lambda) only: above one half it diverges.
TEST(Object, GroovesReflectMoreThanHalfOfTheirLightOntoThemselves) {
    EXPECT_GT(interreflection_radius(make_object(ObjectKind::v45, 8, 8), kGrooveDiffuse), 0.5);
    EXPECT_GT(interreflection_radius(make_object(ObjectKind::u, 8, 10), kGrooveDiffuse), 0.5);
}

TEST(Object, PlatesFaceEachOther) {
    const SimulatedObject object = make_object(ObjectKind::a, 8, 8);
    const SurfacePoint standing = *point_at_pixel(object, 8, 8, {4, 2});
    const SurfacePoint lying = *point_at_pixel(object, 8, 8, {4, 6});
    EXPECT_TRUE(standing.normal.isApprox(Vec3::UnitZ(), 1e-6));
    EXPECT_TRUE(lying.normal.isApprox(Vec3::UnitY(), 1e-6));
    EXPECT_TRUE(faces(standing, lying.position - standing.position));
    EXPECT_TRUE(faces(lying, standing.position - lying.position));
    EXPECT_FALSE(point_at_pixel(object, 8, 8, {8.5, 2}).has_value());
}

TEST(Object, ScannedPointsLieAtTheirPixelsAzimuthAndHeight) {
    const SimulatedObject object = make_object(ObjectKind::b, 16, 16);
    const RangeFrame& frame = *object.range_frame;
    int num_found = 0;
    for (int row = 0; row < 16; ++row) {
        for (int column = 0; column < 16; ++column) {
            const auto point = point_at_pixel(object, 16, 16, {column + 0.5, row + 0.5});
            if (!point) continue;
            ++num_found;
            const double azimuth = column_azimuth(frame, 16, column);
            const Vec3 turned_back = rotate_about_y(-azimuth, point->position);
            // Rays are single precision: 2^-24 of half a metre.
            EXPECT_NEAR(turned_back.x(), 0, 1e-6);
            EXPECT_GT(turned_back.z(), 0);
            const double share = (row + 0.5) / 16;
            const double height =
                frame.height_end - share * (frame.height_end - frame.height_begin);
            EXPECT_NEAR(turned_back.y(), height, 1e-6);
        }
    }
    EXPECT_GT(num_found, 16 * 12);
}

}  // namespace
}  // namespace patina
