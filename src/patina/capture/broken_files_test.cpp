// Captures whose files are missing, damaged, of the wrong size or do not make a surface: each gives
// its own one line.
#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/capture/capture.h"
#include "patina/capture/capture_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace patina {
namespace {

namespace fs = std::filesystem;

const char* const kPathExpected = " (expected a path inside the capture's folder, with '/')";

std::string line_after(const Changes& changes) {
    CaptureFixture fixture;
    fixture.change(changes);
    return fixture.error_line();
}

std::string line_of_document(const std::string& json) {
    CaptureFixture fixture;
    fixture.set_json(json);
    return fixture.error_line();
}

std::string line_of_mesh(const std::string& obj) {
    CaptureFixture fixture;
    fixture.write("quad.obj", obj);
    return fixture.error_line();
}

std::string line_of_range(const Changes& changes, const std::string& name, const Image& range) {
    CaptureFixture fixture;
    fixture.change(changes);
    write_exr(fixture.folder() / name, range);
    return fixture.error_line();
}

std::string error_of(const fs::path& path) {
    try {
        static_cast<void>(read_capture_description(path));
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(BrokenDocument, GivesLineAndColumn) {
    EXPECT_EQ(line_of_document(""),
              "capture.json: line 1, column 1: unexpected end of input; expected '[', '{', or a "
              "literal (expected JSON)");
    EXPECT_EQ(line_of_document("{\n  \"format\": patina\n}"),
              "capture.json: line 2, column 13: invalid literal; last read: '\"format\": p' "
              "(expected JSON)");
    EXPECT_EQ(line_of_document("{\n  \"format\": \"patina-capture\",\n}"),
              "capture.json: line 3, column 1: unexpected '}'; expected string literal "
              "(expected JSON)");
    EXPECT_EQ(line_of_document("{\"version\": NaN}"),
              "capture.json: line 1, column 13: invalid literal; last read: '\"version\": N' "
              "(expected JSON)");
}

TEST(BrokenDocument, RefusesNumbersBeyondDouble) {
    EXPECT_EQ(line_of_document("{\"version\": 1e999}"),
              "capture.json: line 1, column 17: number overflow parsing '1e999' (expected JSON)");
}

TEST(BrokenDocument, RefusesAnythingButAnObject) {
    EXPECT_EQ(line_of_document("[]"), "capture.json: is a list of 0 (expected an object)");
}

TEST(BrokenDocument, RefusesDeepNesting) {
    EXPECT_EQ(line_of_document(std::string(100000, '[')),
              "capture.json: is nested too deeply (expected 64 levels)");
}

TEST(BrokenPlace, NamesTheFolderThatIsMissing) {
    const CaptureFixture fixture;
    const std::string missing = (fixture.folder() / "nothing").string();
    EXPECT_EQ(error_of(missing),
              missing + ": does not exist (expected a folder with a capture.json)");
}

TEST(BrokenPlace, NamesTheFileThatTheFolderLacks) {
    const CaptureFixture fixture;
    const fs::path empty = fixture.folder() / "empty";
    fs::create_directory(empty);
    EXPECT_EQ(error_of(empty),
              (empty / "capture.json").string() + ": does not exist (expected a file)");
}

TEST(BrokenPath, MayNotLeaveTheFolder) {
    const std::string image = R"("image": "image.exr")";
    EXPECT_EQ(line_after({{image, R"("image": "none.exr")"}}),
              R"(capture.json: shots[0].image: "none.exr" does not exist (expected a file))");
    EXPECT_EQ(line_after({{image, R"("image": "../image.exr")"}}),
              std::string(R"(capture.json: shots[0].image: "../image.exr" leaves the folder)") +
                  kPathExpected);
    EXPECT_EQ(
        line_after({{image, R"("image": "a/../../capture/image.exr")"}}),
        std::string(
            R"(capture.json: shots[0].image: "a/../../capture/image.exr" leaves the folder)") +
            kPathExpected);
    EXPECT_EQ(line_after({{image, R"("image": "/tmp/image.exr")"}}),
              std::string(R"(capture.json: shots[0].image: is "/tmp/image.exr")") + kPathExpected);
    EXPECT_EQ(
        line_after({{image, R"("image": "images\\image.exr")"}}),
        std::string(R"(capture.json: shots[0].image: is "images\\image.exr")") + kPathExpected);
    EXPECT_EQ(line_after({{image, R"("image": "")"}}),
              std::string(R"(capture.json: shots[0].image: is "")") + kPathExpected);
    EXPECT_EQ(line_after({{image, R"("image": ".")"}}),
              R"(capture.json: shots[0].image: "." is no file (expected a file))");
}

TEST(BrokenPath, MayNotLeaveTheFolderThroughALink) {
    CaptureFixture fixture;
    const fs::path outside = fixture.folder().parent_path() / "outside.exr";
    write_exr(outside, Image(4, 3, 3));
    fs::create_symlink(outside, fixture.folder() / "link.exr");
    fixture.change({{R"("image": "image.exr")", R"("image": "link.exr")"}});
    EXPECT_EQ(fixture.error_line(),
              std::string(R"(capture.json: shots[0].image: "link.exr" leads out of the folder)") +
                  kPathExpected);
}

TEST(BrokenImage, OfAnotherSize) {
    const std::string exposure = R"("exposure": 1)";
    EXPECT_EQ(line_after({{R"("image": "image.exr")", R"("image": "grid.exr")"}}),
              R"(capture.json: shots[0].image: "grid.exr" has 4 x 4 pixels )"
              R"((expected 4 x 3, the size of camera "front"))");
    EXPECT_EQ(line_after({{exposure, exposure + R"(, "mask": "grid.exr")"}}),
              R"(capture.json: shots[0].mask: "grid.exr" has 4 x 4 pixels )"
              R"((expected 4 x 3, the size of camera "front"))");
    EXPECT_EQ(line_after({{exposure, exposure + R"(, "dark": "grid.exr")"}}),
              R"(capture.json: shots[0].dark: "grid.exr" has 4 x 4 pixels )"
              R"((expected 4 x 3, the size of camera "front"))");
}

TEST(BrokenImage, OfAnotherSizeThanTheTexelDomain) {
    EXPECT_EQ(
        line_after(
            {{R"("model": "pinhole", "width": 4, "height": 3, "fx": 5, "fy": 5, )"
              R"("cx": 2, "cy": 1.5,)",
              R"("model": "registered", "position": [0, 0, 2])"},
             {R"("world_from_camera": [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 2, 0, 0, 0, 1])", ""}}),
        R"(capture.json: shots[0].image: "image.exr" has 4 x 3 pixels )"
        "(expected 4 x 4, the size of the texel domain)");
    EXPECT_EQ(line_after({{R"("radiometry")",
                           R"("truth": {"diffuse": "image.exr", "specular": "grid.exr",
                                        "roughness": "grid.exr"}, "radiometry")"}}),
              R"(capture.json: truth.diffuse: "image.exr" has 4 x 3 pixels )"
              "(expected 4 x 4, the size of the texel domain)");
    EXPECT_EQ(
        line_after({{R"({"mesh": "quad.obj", "texels": [4, 4]})",
                     R"({"range": "range.exr", "projection": "camera", "camera": "front"})"}}),
        R"(capture.json: geometry.range: "range.exr" has 8 x 4 pixels )"
        R"((expected 4 x 3, the size of camera "front"))");
}

TEST(BrokenImage, Truncated) {
    const CaptureFixture fixture;
    const fs::path image = fixture.folder() / "image.exr";
    fs::resize_file(image, fs::file_size(image) - 8);
    EXPECT_THAT(fixture.error_line(),
                ::testing::StartsWith("image.exr: shots[0].image: is damaged or truncated: "));
}

TEST(BrokenImage, TruncatedMask) {
    CaptureFixture fixture;
    fixture.change({{R"("exposure": 1)", R"("exposure": 1, "mask": "mask.png")"}});
    const fs::path mask = fixture.folder() / "mask.png";
    fs::resize_file(mask, fs::file_size(mask) - 12);
    EXPECT_THAT(fixture.error_line(),
                ::testing::StartsWith("mask.png: shots[0].mask: is damaged or truncated"));
}

TEST(BrokenImage, MaskThatIsNotOf8Bits) {
    CaptureFixture fixture;
    fixture.change({{R"("exposure": 1)", R"("exposure": 1, "mask": "image.exr")"}});
    EXPECT_EQ(fixture.error_line(),
              R"(capture.json: shots[0].mask: "image.exr" is not an image of 8 bits )"
              "(expected an image of 8 bits)");
}

TEST(BrokenImage, OfAKindNotUnderstood) {
    EXPECT_EQ(line_after({{R"("image": "image.exr")", R"("image": "quad.obj")"}}),
              "quad.obj: shots[0].image: is of a kind not understood (expected an OpenEXR, PNG, "
              "TIFF or PFM image)");
}

const char* const kCorners = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
const char* const kUvs = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

TEST(BrokenMesh, WithoutUvs) {
    EXPECT_EQ(line_of_mesh(std::string(kCorners) + "f 1 2 3\nf 1 3 4\n"),
              R"(quad.obj: geometry.mesh: has no texture coordinates (expected UVs, or )"
              R"("unwrap": true beside "mesh"))");
}

TEST(BrokenMesh, WithUvsOutsideTheSquare) {
    EXPECT_EQ(line_of_mesh(std::string(kCorners) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1.1\n" +
                           "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"),
              "quad.obj: geometry.mesh: triangle 1 has texture coordinates outside the unit square "
              "(1 of 2 triangles) (expected u and v from 0 to 1)");
}

TEST(BrokenMesh, WithTrianglesOfNoArea) {
    EXPECT_EQ(line_of_mesh(std::string(kCorners) + kUvs +
                           "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 1/1 2/2 2/3\nf 3/1 3/2 4/3\n"),
              "quad.obj: geometry.mesh: triangle 2 has no area (2 of 4 triangles) (expected no "
              "degenerate triangles)");
}

TEST(BrokenMesh, WithPointsBeyondMeasure) {
    EXPECT_EQ(
        line_of_mesh("v 0 0 0\nv 1 -2e9 0\nv 1 1 0\n" + std::string(kUvs) + "f 1/1 2/2 3/3\n"),
        "quad.obj: geometry.mesh: has a point at (1, -2e+09, 0) (expected coordinates of at "
        "most 1e+09 in size)");
}

TEST(BrokenMesh, WithUvTrianglesOfNoArea) {
    EXPECT_EQ(line_of_mesh(std::string(kCorners) + kUvs + "f 1/1 2/2 3/3\nf 1/1 3/3 4/3\n"),
              "quad.obj: geometry.mesh: triangle 1 has no area in the texture (1 of 2 triangles) "
              "(expected a place of its own for every triangle)");
}

TEST(BrokenMesh, WithOverlappingCharts) {
    EXPECT_EQ(line_of_mesh(std::string(kCorners) + kUvs + "f 1/1 2/2 3/3\nf 1/1 3/2 4/4\n"),
              "quad.obj: geometry.mesh: triangles 0 and 1 overlap in the texture (expected a place "
              "of its own for every triangle, or \"unwrap\": true and no UVs)");
}

TEST(BrokenMesh, WithIndicesOfNothing) {
    EXPECT_THAT(line_of_mesh(std::string(kCorners) + kUvs + "f 1/1 2/2 9/3\n"),
                ::testing::StartsWith("quad.obj: geometry.mesh: "));
}

TEST(BrokenMesh, TooFewTexelsToUnwrap) {
    CaptureFixture fixture;
    fixture.write("quad.obj", std::string(kCorners) + "f 1 2 3\nf 1 3 4\n");
    fixture.change({{R"("texels": [4, 4])", R"("texels": [2, 2], "unwrap": true)"}});
    EXPECT_EQ(
        fixture.error_line(),
        "capture.json: geometry.texels: are too few to unwrap 2 triangles (expected at least 9 "
        "texels for every 2 triangles, and some to spare)");
}

TEST(BrokenMesh, TooFewTexels) {
    CaptureFixture fixture;
    fixture.write("quad.obj",
                  std::string(kCorners) + "vt 0 0\nvt 0.1 0\nvt 0.1 0.1\nvt 0 0.1\n" +
                      "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
    EXPECT_EQ(
        fixture.error_line(),
        "capture.json: geometry: has no texel whose centre lies on the surface (expected more "
        "texels)");
}

TEST(BrokenRange, WithNegativeRadius) {
    Image range(8, 4, 1, 0.5F);
    range.at(3, 1) = -0.25F;
    EXPECT_EQ(
        line_of_range(cylinder_changes(), "range.exr", range),
        "range.exr: geometry.range: pixel (3, 1) is -0.25 (expected a distance above 0, or NaN "
        "where nothing was measured)");
}

TEST(BrokenRange, WithInfiniteDepth) {
    Image range(4, 3, 1, 2.0F);
    range.at(0, 2) = std::numeric_limits<float>::infinity();
    EXPECT_EQ(line_of_range(depth_changes(), "depth.exr", range),
              "depth.exr: geometry.range: pixel (0, 2) is inf (expected a distance above 0, or NaN "
              "where nothing was measured)");
}

TEST(BrokenRange, WithPointsBeyondMeasure) {
    EXPECT_THAT(
        line_of_range(cylinder_changes(), "range.exr", Image(8, 4, 1, 2e12F)),
        ::testing::AllOf(::testing::StartsWith("range.exr: geometry.range: has a point at ("),
                         ::testing::EndsWith("(expected coordinates of at most 1e+09 in size)")));
}

TEST(BrokenRange, OfThreeChannels) {
    EXPECT_EQ(line_of_range(cylinder_changes(), "range.exr", Image(8, 4, 3, 0.5F)),
              R"(capture.json: geometry.range: "range.exr" has 3 channels (expected 1 channel))");
}

TEST(BrokenRange, OfIntegers) {
    CaptureFixture fixture;
    fixture.change(depth_changes());
    write_png(fixture.folder() / "depth.exr", Image(4, 3, 1, 0.5F), 16);
    EXPECT_EQ(fixture.error_line(),
              "depth.exr: geometry.range: holds integers (expected an image of floating-point "
              "numbers)");
}

TEST(BrokenRange, WhereNothingWasMeasured) {
    EXPECT_EQ(line_of_range(cylinder_changes(), "range.exr", Image(8, 4, 1, std::nanf(""))),
              "range.exr: geometry.range: has no surface: no measured pixels are joined (expected "
              "measured neighbours nearer than max_step)");
}

}  // namespace
}  // namespace patina
