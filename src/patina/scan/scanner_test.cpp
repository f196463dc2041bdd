#include "patina/scan/scanner.h"

#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/base/parallel.h"
#include "patina/math/statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace patina {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Scanner : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(testing::TempDir()) / (std::string("patina_scanner_") + info->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        options_.columns = 24;
        options_.rows = 20;
        options_.samples_per_pixel = 4;
    }
    void TearDown() override { fs::remove_all(folder_); }

    [[nodiscard]] SimulatedObject object(ObjectKind kind) const {
        return make_object(kind, options_.columns, options_.rows);
    }

    CaptureDescription simulate(const SimulatedObject& object, const std::string& name) const {
        const fs::path target = folder_ / name;
        fs::create_directories(target);
        Progress progress;
        constexpr std::array<std::size_t, 2> kChosen = {7, 33};
        return simulate_capture(object, kChosen, options_, progress, target);
    }

    fs::path folder_;
    ScanOptions options_;
};

std::string message_of(const ScanOptions& options) {
    try {
        validate(options);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST_F(Scanner, CylindricalCaptureReadsBack) {
    const SimulatedObject cat = object(ObjectKind::b);
    (void)simulate(cat, "b");
    const Capture capture = load_capture(folder_ / "b");
    ASSERT_EQ(capture.description.shots.size(), 3u);
    EXPECT_FALSE(capture.description.shots[0].heldout);
    EXPECT_TRUE(capture.description.shots[2].heldout);
    EXPECT_EQ(capture.description.lights[0].id, "L07");
    EXPECT_EQ(capture.description.lights[0].frame, FrameOfReference::scanner);
    EXPECT_GT(capture.atlas.texels.size(), 24u * 20u * 3 / 4);
    // The rig in memory has the geometry that the folder gives.
    const Capture rig = simulate_rig(cat, options_);
    EXPECT_EQ(rig.mesh.positions, capture.mesh.positions);
    EXPECT_EQ(rig.atlas.cell_texel, capture.atlas.cell_texel);
    const TruthMaps truth = load_truth(capture.description);
    for (const Texel& texel : capture.atlas.texels) {
        EXPECT_GT(truth.mask.at(texel.column, texel.row), 0.5f);
        EXPECT_GE(truth.diffuse.at(texel.column, texel.row), 0.1f);
        EXPECT_GT(truth.specular.at(texel.column, texel.row), 0);
        EXPECT_GE(truth.roughness.at(texel.column, texel.row), 0.08f);
    }
}

TEST_F(Scanner, ChannelIsSeenByThreeCameras) {
    (void)simulate(object(ObjectKind::u), "u");
    const Capture capture = load_capture(folder_ / "u");
    EXPECT_EQ(capture.description.cameras.size(), 3u);
    EXPECT_EQ(capture.description.shots.size(), 9u);
    EXPECT_EQ(capture.atlas.texels.size(), 24u * 20u);
}

TEST_F(Scanner, TexelsOfThePlatesAreWhereTheTruthSays) {
    (void)simulate(object(ObjectKind::a), "a");
    const Capture capture = load_capture(folder_ / "a");
    const SimulatedObject plates = object(ObjectKind::a);
    ASSERT_EQ(capture.atlas.texels.size(), 24u * 20u);
    for (const Texel& texel : capture.atlas.texels) {
        const auto point = point_at_pixel(plates, 24, 20, {texel.column + 0.5, texel.row + 0.5});
        EXPECT_TRUE(texel.point.position.isApprox(point->position, 1e-5));
    }
}

TEST_F(Scanner, CaptureIsTheSameForAnyNumberOfThreads) {
    const SimulatedObject pig = object(ObjectKind::c);
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        (void)simulate(pig, std::to_string(threads));
    }
    int num_files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "1")) {
        if (!entry.is_regular_file()) continue;
        ++num_files;
        const fs::path name = entry.path().lexically_relative(folder_ / "1");
        EXPECT_EQ(read_file(entry.path()), read_file(folder_ / "2" / name)) << name;
    }
    // capture.json, the range image, four maps, three images and two masks.
    EXPECT_EQ(num_files, 11);
}

TEST_F(Scanner, IntegerImagesHoldTheSameRadiance) {
    options_.noise_read = 0;
    options_.noise_gain = 0;
    const CaptureDescription exact = simulate(object(ObjectKind::a), "float");
    options_.quantize_bits = 16;
    const CaptureDescription rounded = simulate(object(ObjectKind::a), "integer");
    EXPECT_GT(rounded.radiometry.noise_read, 0);
    const RadianceImage first = load_radiance(exact, 0);
    const RadianceImage second = load_radiance(rounded, 0);
    // Half a step of 2 / 65535, and the rounding of floats.
    for (std::size_t i = 0; i < first.radiance.data.size(); ++i) {
        if (second.usable[i / 3] == 0) continue;
        EXPECT_NEAR(first.radiance.data[i], second.radiance.data[i], 1.001 / 65535);
    }
}

TEST_F(Scanner, RangeImageIsTheSolid) {
    const SimulatedObject cat = object(ObjectKind::b);
    const ScannedGeometry geometry = scan_geometry(cat, options_);
    const double half_column = kPi / options_.columns;
    // Rounding to single precision: three coordinates below 0.25 m, and the range.
    const double rounding = 2 * std::ldexp(0.25, -24);
    for (const Vec3f& p : geometry.mesh.positions) {
        const Vec3 position = p.cast<double>();
        // Vertices of the cut seam lie between two pixels.
        if (std::abs(std::atan2(position.x(), position.z())) < 0.99 * half_column) continue;
        EXPECT_LT(std::abs(cat.distance(position)), rounding);
    }
}

TEST_F(Scanner, NormalErrorHasTheStatedSize) {
    options_.normal_error_degrees = 2;
    const SimulatedObject plates = object(ObjectKind::a);
    const Mesh tilted = scan_geometry(plates, options_).mesh;
    double sum = 0;
    for (std::size_t i = 0; i < tilted.normals.size(); ++i) {
        const double cosine = double(tilted.normals[i].dot(plates.mesh.normals[i]));
        sum += 1 / square(cosine) - 1;
    }
    const double expected = square(std::tan(radians(2.0)));
    const double count = 2 * double(tilted.normals.size());
    // The sum of count squares of normal numbers; false-alarm rate 1e-5, two-sided.
    const double z = normal_quantile(1 - 0.5e-5);
    EXPECT_NEAR(sum / count / expected, 1, z * std::sqrt(2 / count));
}

TEST_F(Scanner, CalibrationErrorsAreStatedAndChangeTheImages) {
    const CaptureDescription right = simulate(object(ObjectKind::a), "right");
    options_.lamp_position_error_m = 0.01;
    options_.misregistration_pixels = 0.5;
    const CaptureDescription wrong = simulate(object(ObjectKind::a), "wrong");
    EXPECT_EQ(wrong.lights[0].position_stddev, 0.01);
    EXPECT_EQ(wrong.geometry.registration_stddev, 0.5);
    EXPECT_EQ(wrong.lights[0].position, right.lights[0].position);
    EXPECT_NE(load_radiance(wrong, 0).radiance.data, load_radiance(right, 0).radiance.data);
}

TEST_F(Scanner, RigHasSixtyCandidatesAndNoShots) {
    const Capture rig = simulate_rig(object(ObjectKind::a), options_);
    EXPECT_EQ(rig.description.lights.size(), 60u);
    EXPECT_TRUE(rig.description.shots.empty());
    EXPECT_EQ(rig.atlas.texels.size(), 24u * 20u);
}

TEST_F(Scanner, WrongOptionsAreNamed) {
    ScanOptions options;
    options.samples_per_pixel = 0;
    EXPECT_EQ(message_of(options), "--samples: is 0 (expected at least 1)");
    options = {};
    options.quantize_bits = 12;
    EXPECT_THAT(message_of(options), HasSubstr("--bits: is 12"));
    options = {};
    options.noise_read = -0.1;
    EXPECT_THAT(message_of(options), HasSubstr("--noise-read: is -0.1"));
    options = {};
    options.columns = 4;
    EXPECT_THAT(message_of(options), HasSubstr("--texels: is 4"));
}

TEST_F(Scanner, ChosenLampsMustBeCandidates) {
    const SimulatedObject plates = object(ObjectKind::a);
    Progress progress;
    const auto choose = [&](const std::vector<std::size_t>& chosen) {
        return simulate_capture(plates, chosen, options_, progress, folder_);
    };
    EXPECT_THROW((void)choose({}), Error);
    EXPECT_THROW((void)choose({60}), Error);
    EXPECT_THROW((void)choose({3, 3}), Error);
}

}  // namespace
}  // namespace patina
