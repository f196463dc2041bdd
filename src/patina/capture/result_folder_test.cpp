#include "patina/capture/result_folder.h"

#include "patina/base/error.h"
#include "patina/base/output_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>

namespace patina {
namespace {

namespace fs = std::filesystem;

constexpr const char* kJson = R"({"format": "patina-result", "version": 1, "name": "square"})";
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Two texels on the surface, one measured and one filled, and two off it.
Result small_result() {
    Result result;
    ReflectanceMaps& maps = result.maps;
    maps.diffuse = Image(2, 2, 3);
    maps.specular = maps.roughness = maps.status = Image(2, 2, 1);
    maps.diffuse_stderr = Image(2, 2, 3);
    maps.specular_stderr = maps.roughness_stderr = Image(2, 2, 1);
    maps.measurability = Image(2, 2, 3);
    maps.reason = Image(2, 2, 1);
    for (const int x : {0, 1}) {
        for (int c = 0; c < 3; ++c) {
            maps.diffuse.at(x, 0, c) = 0.25F * float(c + 1);
            maps.diffuse_stderr.at(x, 0, c) = 0.01F;
        }
        maps.specular.at(x, 0) = 0.125F;
        maps.roughness.at(x, 0) = 0.2F;
        maps.specular_stderr.at(x, 0) = x == 0 ? 0.5F : kInfinity;
        maps.roughness_stderr.at(x, 0) = x == 0 ? 0.05F : kInfinity;
        maps.status.at(x, 0) = x == 0 ? 1 : 2;
        maps.reason.at(x, 0) = x == 0 ? 1 : 4;
        for (int c = 0; c < 3; ++c) {
            maps.measurability.at(x, 0, c) = x == 0 || c == 0 ? 0.1F : kInfinity;
        }
    }
    result.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    result.mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    result.mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
    result.mesh.triangles = {{0, 1, 2}};
    result.json = kJson;
    return result;
}

class ResultFolder : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::path(::testing::TempDir()) / "patina_result_XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
        write_result(folder_, small_result());
    }
    void TearDown() override {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }

    [[nodiscard]] std::string error_line() const {
        try {
            static_cast<void>(read_result(folder_));
        } catch (const Error& error) {
            const std::string prefix = folder_.string() + "/";
            const std::string line = error.what();
            return line.starts_with(prefix) ? line.substr(prefix.size()) : line;
        }
        return "";
    }

    fs::path folder_;
};

TEST_F(ResultFolder, ReadsBackWhatWasWritten) {
    const Result expected = small_result();
    const Result result = read_result(folder_);
    EXPECT_EQ(result.name, "square");
    EXPECT_EQ(result.json, kJson);
    EXPECT_EQ(result.maps.diffuse.data, expected.maps.diffuse.data);
    EXPECT_EQ(result.maps.specular.data, expected.maps.specular.data);
    EXPECT_EQ(result.maps.roughness.data, expected.maps.roughness.data);
    EXPECT_EQ(result.maps.diffuse_stderr.data, expected.maps.diffuse_stderr.data);
    EXPECT_EQ(result.maps.specular_stderr.data, expected.maps.specular_stderr.data);
    EXPECT_EQ(result.maps.roughness_stderr.data, expected.maps.roughness_stderr.data);
    EXPECT_EQ(result.maps.status.data, expected.maps.status.data);
    EXPECT_EQ(result.maps.measurability.data, expected.maps.measurability.data);
    EXPECT_EQ(result.maps.reason.data, expected.maps.reason.data);
    EXPECT_EQ(result.mesh.triangles.size(), 1U);
}

TEST_F(ResultFolder, KnowsHowStrongTheLampsAre) {
    EXPECT_EQ(read_result(folder_).lamp_factor, 1);
    Result result = small_result();
    result.json = R"({"format": "patina-result", "version": 1, "name": "square",
                      "scale": {"told": true, "factor": 1.5, "standard_error": 0.01}})";
    write_result(folder_, result);
    EXPECT_EQ(read_result(folder_).lamp_factor, 1.5);
}

TEST_F(ResultFolder, ReadsFromTheNameOfItsJson) {
    EXPECT_EQ(read_result(folder_ / "result.json").name, "square");
}

TEST_F(ResultFolder, StoresSpecularAsThreeEqualChannels) {
    const Image stored = read_image(folder_ / "specular.exr").image;
    ASSERT_EQ(stored.channels, 3);
    EXPECT_EQ(stored.at(0, 0, 0), 0.125F);
    EXPECT_EQ(stored.at(0, 0, 1), 0.125F);
    EXPECT_EQ(stored.at(0, 0, 2), 0.125F);
}

TEST_F(ResultFolder, GivesTheSameBytesForTheSameMaps) {
    const std::string first = read_file(folder_ / "diffuse.exr");
    write_result_maps(folder_, small_result().maps);
    EXPECT_EQ(read_file(folder_ / "diffuse.exr"), first);
}

TEST_F(ResultFolder, NamesTheMapThatIsMissing) {
    fs::remove(folder_ / "roughness_stderr.exr");
    EXPECT_EQ(error_line(),
              "roughness_stderr.exr: does not exist (expected an OpenEXR, PNG, TIFF or PFM image)");
}

TEST_F(ResultFolder, NamesTheMapOfAnotherSize) {
    write_exr(folder_ / "roughness.exr", Image(3, 2, 1));
    EXPECT_EQ(error_line(),
              "roughness.exr: has 3 x 2 pixels (expected 2 x 2, the size of status.exr)");
}

TEST_F(ResultFolder, NamesTheMapOfOtherChannels) {
    write_exr(folder_ / "diffuse.exr", Image(2, 2, 1));
    EXPECT_EQ(error_line(), "diffuse.exr: has 1 channels (expected 3 channels)");
}

TEST_F(ResultFolder, RefusesColouredSpecular) {
    Image specular(2, 2, 3);
    specular.at(1, 0, 2) = 0.5F;
    write_exr(folder_ / "specular.exr", specular);
    EXPECT_EQ(error_line(),
              "specular.exr: pixel (1, 0) has a colour (expected three equal channels)");
}

TEST_F(ResultFolder, RefusesNan) {
    Image roughness = small_result().maps.roughness;
    roughness.at(1, 0) = std::nanf("");
    write_exr(folder_ / "roughness.exr", roughness);
    EXPECT_EQ(error_line(), "roughness.exr: pixel (1, 0) is NaN (expected a number)");
}

TEST_F(ResultFolder, RefusesStatusesThatAreNone) {
    Image status = small_result().maps.status;
    status.at(0, 0) = 1.5F;
    write_exr(folder_ / "status.exr", status);
    EXPECT_EQ(error_line(), "status.exr: pixel (0, 0) is no status (expected 0, 1, 2 or 3)");
}

TEST_F(ResultFolder, RefusesReasonsThatAreNone) {
    Image reason = small_result().maps.reason;
    reason.at(0, 0) = 9;
    write_exr(folder_ / "reason.exr", reason);
    EXPECT_EQ(error_line(),
              "reason.exr: pixel (0, 0) is no reason (expected a whole number from 0 to 8)");
}

TEST_F(ResultFolder, NeedsNoWordOfWhatCouldBeMeasured) {
    fs::remove(folder_ / "measurability.exr");
    fs::remove(folder_ / "reason.exr");
    const Result result = read_result(folder_);
    EXPECT_TRUE(result.maps.measurability.empty());
    EXPECT_TRUE(result.maps.reason.empty());
}

TEST_F(ResultFolder, RefusesValuesOffTheSurface) {
    Image roughness = small_result().maps.roughness;
    roughness.at(0, 1) = 0.1F;
    write_exr(folder_ / "roughness.exr", roughness);
    EXPECT_EQ(error_line(),
              "roughness.exr: pixel (0, 1) is not 0 where the status is 0 (expected 0 off the "
              "surface)");
}

TEST_F(ResultFolder, RefusesOtherFormatsAndVersions) {
    write_file(folder_ / "result.json", R"({"format": "patina-capture", "version": 1})");
    EXPECT_EQ(error_line(),
              R"(result.json: format: is "patina-capture" (expected "patina-result"))");
    write_file(folder_ / "result.json", R"({"format": "patina-result", "version": 2})");
    EXPECT_EQ(error_line(), "result.json: version: is 2 (expected 1)");
    write_file(folder_ / "result.json", R"({"format": "patina-result", "version": 1})");
    EXPECT_EQ(error_line(), "result.json: name: is missing (expected text)");
}

TEST_F(ResultFolder, NamesTheFolderThatIsNone) {
    fs::remove(folder_ / "result.json");
    EXPECT_EQ(error_line(), "result.json: does not exist (expected a file)");
}

TEST(WriteResultMapsDeathTest, RefusesNanOfOurOwn) {
    // Image libraries keep threads, which a plain fork does not take along.
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    ReflectanceMaps maps = small_result().maps;
    maps.diffuse.at(0, 0, 1) = std::nanf("");
    EXPECT_DEATH(write_result_maps(::testing::TempDir(), maps), "is NaN");
}

}  // namespace
}  // namespace patina
