// Every form that the format allows is read, and a description that was written reads back the
// same.
#include "patina/base/output_file.h"
#include "patina/capture/capture.h"
#include "patina/capture/capture_fixture.h"
#include "patina/scene/mesh_io.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace patina {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPinhole =
    R"("model": "pinhole", "width": 4, "height": 3, "fx": 5, "fy": 5, "cx": 2, "cy": 1.5,)";
constexpr const char* kPose =
    R"("world_from_camera": [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 2, 0, 0, 0, 1])";

// A baseline TIFF (revision 6.0): little endian, one strip of 16-bit grey, every pixel `value`.
std::string grey_tiff(std::uint32_t width, std::uint32_t height, std::uint16_t value) {
    std::string bytes;
    const auto put = [&bytes](std::uint32_t number, int num_bytes) {
        for (int i = 0; i < num_bytes; ++i) bytes += char(number >> (8 * i) & 0xff);
    };
    constexpr std::uint32_t kHeaderBytes = 8;
    const std::uint32_t strip_bytes = 2 * width * height;
    bytes = "II";
    put(42, 2);
    put(kHeaderBytes + strip_bytes, 4);
    for (std::uint32_t i = 0; i < width * height; ++i) put(value, 2);
    struct Entry {
        std::uint32_t tag;
        std::uint32_t type;  // 3: 16 bits, 4: 32 bits
        std::uint32_t value;
    };
    const std::vector<Entry> entries = {{256, 4, width},         // ImageWidth
                                        {257, 4, height},        // ImageLength
                                        {258, 3, 16},            // BitsPerSample
                                        {259, 3, 1},             // Compression: none
                                        {262, 3, 1},             // Photometric: 0 is black
                                        {273, 4, kHeaderBytes},  // StripOffsets
                                        {277, 3, 1},             // SamplesPerPixel
                                        {278, 4, height},        // RowsPerStrip
                                        {279, 4, strip_bytes}};  // StripByteCounts
    put(std::uint32_t(entries.size()), 2);
    for (const Entry& entry : entries) {
        put(entry.tag, 2);
        put(entry.type, 2);
        put(1, 4);
        put(entry.value, 4);
    }
    put(0, 4);
    return bytes;
}

CaptureDescription description_after(CaptureFixture& fixture, const Changes& changes) {
    fixture.change(changes);
    EXPECT_EQ(fixture.error_line(), "");
    return read_capture_description(fixture.folder());
}

TEST(ValidCapture, IsReadFromItsFolderAndFromItsFile) {
    const CaptureFixture fixture;
    const Capture capture = load_capture(fixture.folder() / "capture.json");
    EXPECT_EQ(capture.description.name, "square");
    EXPECT_EQ(capture.description.folder, fixture.folder());
    EXPECT_EQ(capture.mesh.triangles.size(), 2U);
    EXPECT_EQ(capture.atlas.texels.size(), 16U);
}

TEST(ValidCapture, OfAPinholeCameraWithDistortion) {
    CaptureFixture fixture;
    const Camera camera =
        description_after(
            fixture, {{R"("cy": 1.5,)", R"("cy": 1.5, "distortion": [0.1, 0, 0.001, 0, -0.01],)"}})
            .cameras[0];
    EXPECT_EQ(camera.model, CameraModel::pinhole);
    EXPECT_EQ(camera.distortion[4], -0.01);
    EXPECT_EQ(camera.world_from_camera.translation, Vec3(0, 0, 2));
}

TEST(ValidCapture, OfAPoseRoundedToFourDigitsIsMadeRigid) {
    CaptureFixture fixture;
    const Camera camera =
        description_after(
            fixture,
            {{kPose,
              R"("world_from_camera": [0.70711, -0.70711, 0, 0, -0.70711, -0.70711, 0, 0,
                                       0, 0, -1, 2, 0, 0, 0, 1])"}})
            .cameras[0];
    const Mat3& rotation = camera.world_from_camera.rotation;
    // A few roundings of double.
    EXPECT_LT((rotation.transpose() * rotation - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_NEAR(rotation(0, 0), 0.70711, 1e-5);
}

TEST(ValidCapture, OfAnOrthographicCamera) {
    CaptureFixture fixture;
    const Camera camera =
        description_after(
            fixture,
            {{kPinhole, R"("model": "orthographic", "width": 4, "height": 3, "pixel_size": 0.5,)"}})
            .cameras[0];
    EXPECT_EQ(camera.pixel_size, 0.5);
}

TEST(ValidCapture, OfARegisteredCameraHasTheSizeOfTheTexelDomain) {
    CaptureFixture fixture;
    const Camera camera =
        description_after(fixture,
                          {{kPinhole, R"("model": "registered", "position": [0, 0, 2])"},
                           {kPose, ""},
                           {R"("image": "image.exr")", R"("image": "grid.exr")"}})
            .cameras[0];
    EXPECT_EQ(camera.width, 4);
    EXPECT_EQ(camera.height, 4);
    EXPECT_EQ(camera.frame, FrameOfReference::world);
}

TEST(ValidCapture, OfACylindricalRangeImageWithLightsThatTurn) {
    CaptureFixture fixture;
    Changes changes = cylinder_changes();
    changes.push_back(
        {R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, 1], "frame": "scanner")"});
    static_cast<void>(description_after(fixture, changes));
    const Capture capture = load_capture(fixture.folder());
    EXPECT_EQ(capture.description.geometry.texel_width, 8);
    EXPECT_TRUE(capture.atlas.wraps_around);
    EXPECT_DOUBLE_EQ(capture.atlas.texels.front().azimuth, kPi / 8);
}

TEST(ValidCapture, OfAPartOfATurnKeepsItsEnds) {
    CaptureFixture fixture;
    Changes changes = cylinder_changes();
    changes.push_back({R"("height": [0, 1])", R"("height": [0, 1], "azimuth": [-45, 45])"});
    const RangeFrame frame = description_after(fixture, changes).geometry.range_frame;
    EXPECT_DOUBLE_EQ(frame.azimuth_begin, -kPi / 4);
    EXPECT_FALSE(frame.wraps_around());
}

TEST(ValidCapture, OfADepthImage) {
    CaptureFixture fixture;
    Changes changes = depth_changes();
    changes.push_back({R"("camera": "front"},)", R"("camera": "front", "max_step": 3},)"});
    const GeometrySource geometry = description_after(fixture, changes).geometry;
    EXPECT_EQ(geometry.range_camera, "front");
    EXPECT_EQ(geometry.range_frame.camera.width, 4);
    EXPECT_EQ(geometry.range_frame.max_step, 3);
}

TEST(ValidCapture, OfSeveralLightsAtOnce) {
    CaptureFixture fixture;
    const CaptureDescription description = description_after(
        fixture,
        {{R"("lights": [)",
          R"("lights": [{"id": "sky", "type": "directional", "direction": [0, 3, 4],
                         "irradiance": [1, 2, 3], "direction_stddev": 2},
                        {"id": "spot", "type": "point", "position": [0, 0, 1],
                         "intensity": [1, 1, 1], "direction": [0, 0, -2], "falloff": 3,
                         "position_stddev": 0.01, "intensity_stddev": 0.05},)"},
         {R"("light": "lamp")", R"("lights": ["lamp", "sky"])"}});
    EXPECT_EQ(description.shots[0].lights, (std::vector<std::size_t>{0, 2}));
    EXPECT_TRUE(description.lights[0].direction->isApprox(Vec3(0, 0.6, 0.8)));
    EXPECT_DOUBLE_EQ(description.lights[0].direction_stddev, kPi / 90);
    EXPECT_EQ(description.lights[1].direction->z(), -1);
    EXPECT_EQ(description.lights[1].falloff, 3);
}

TEST(ValidCapture, OfMasksDarkFramesAndHeldOutShots) {
    CaptureFixture fixture;
    const CaptureDescription description = description_after(
        fixture,
        {{R"("exposure": 1)", R"("mask": "mask.png", "dark": "image.exr", "heldout": true)"}});
    EXPECT_TRUE(description.shots[0].heldout);
    EXPECT_EQ(description.shots[0].exposure, 1);
}

TEST(ValidCapture, OfFieldsOfOthers) {
    CaptureFixture fixture;
    static_cast<void>(description_after(fixture,
                                        {{R"("name")", R"("x-lab": {"date": "1 May"}, "name")"},
                                         {R"("fx")", R"("x-serial": 7, "fx")"},
                                         {R"("exposure")", R"("x-f-number": 8, "exposure")"}}));
}

TEST(ValidCapture, OfImagesInFoldersAndThroughLinksInside) {
    CaptureFixture fixture;
    fs::create_directory(fixture.folder() / "images");
    fs::create_symlink("../image.exr", fixture.folder() / "images" / "link.exr");
    static_cast<void>(description_after(
        fixture, {{R"("image": "image.exr")", R"("image": "./images/link.exr")"}}));
}

TEST(ValidCapture, OfPfmImages) {
    CaptureFixture fixture;
    write_pfm(fixture.folder() / "image.pfm", Image(4, 3, 3, 0.5F));
    static_cast<void>(
        description_after(fixture, {{R"("image": "image.exr")", R"("image": "image.pfm")"}}));
}

TEST(ValidCapture, OfAPlyMesh) {
    CaptureFixture fixture;
    write_ply(fixture.folder() / "quad.ply", load_capture(fixture.folder()).mesh);
    static_cast<void>(
        description_after(fixture, {{R"("mesh": "quad.obj")", R"("mesh": "quad.ply")"}}));
}

TEST(ValidCapture, OfAGltfMesh) {
    CaptureFixture fixture;
    // Positions, texture coordinates (v down) and indices of the same square.
    fixture.write("quad.gltf",
                  R"({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [
            {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
             "min": [-1, -1, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 12}],
        "buffers": [{"byteLength": 92, "uri": "data:application/octet-stream;base64,)"
                  "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAAA"
                  "AAAAgD8AAIA/AACAPwAAgD8AAAAAAAAAAAAAAAAAAAEAAgAAAAIAAwA=\"}]}");
    static_cast<void>(
        description_after(fixture, {{R"("mesh": "quad.obj")", R"("mesh": "quad.gltf")"}}));
    EXPECT_EQ(load_capture(fixture.folder()).atlas.texels.size(), 16U);
}

TEST(ValidCapture, OfTiffImages) {
    CaptureFixture fixture;
    fixture.write("image.tif", grey_tiff(4, 3, 0x4000));
    static_cast<void>(
        description_after(fixture, {{R"("image": "image.exr")", R"("image": "image.tif")"}}));
    const RadianceImage image = load_radiance(read_capture_description(fixture.folder()), 0);
    EXPECT_FLOAT_EQ(image.radiance.at(3, 2, 1), float(0x4000) / 65535.0F);
}

TEST(ValidCapture, OfAMeshWithoutUvsIsUnwrapped) {
    CaptureFixture fixture;
    fixture.write("quad.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n");
    static_cast<void>(description_after(
        fixture, {{R"("texels": [4, 4])", R"("texels": [16, 16], "unwrap": true)"}}));
    const Capture capture = load_capture(fixture.folder());
    EXPECT_EQ(capture.mesh.uvs.size(), capture.mesh.positions.size());
}

TEST(ValidCapture, OfUvsRoundedBeyondTheSquare) {
    CaptureFixture fixture;
    fixture.write("quad.obj",
                  "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nvt 0 -0.0000001\nvt 1.0000001 0\nvt 1 1\n"
                  "f 1/1 2/2 3/3\n");
    const Capture capture = load_capture(fixture.folder());
    for (const Vec2f& uv : capture.mesh.uvs) EXPECT_TRUE(uv.minCoeff() >= 0 && uv.maxCoeff() <= 1);
}

TEST(ValidRig, HasNoShots) {
    CaptureFixture fixture;
    fixture.write("rig.json", R"({
        "format": "patina-rig", "version": 1, "length_unit": "cm",
        "geometry": {"mesh": "quad.obj", "texels": [4, 4]},
        "cameras": [{"id": "eye", "model": "registered", "position": [0, 0, 2]}],
        "lights": [{"id": "a", "type": "point", "position": [0, 0, 2], "intensity": [1, 1, 1]}]})");
    const CaptureDescription rig = read_rig_description(fixture.folder());
    EXPECT_TRUE(rig.shots.empty());
    EXPECT_EQ(rig.length_unit, LengthUnit::centimeter);
    EXPECT_FALSE(load_capture(rig).atlas.texels.empty());
}

// Texts of both sides are compared: the writer writes every field of a description.
void expect_same_after_writing(const Changes& changes) {
    CaptureFixture fixture;
    const CaptureDescription description = description_after(fixture, changes);
    write_capture_description(description, fixture.folder());
    const std::string first = read_file(fixture.folder() / "capture.json");
    const CaptureDescription again = read_capture_description(fixture.folder());
    write_capture_description(again, fixture.folder());
    EXPECT_EQ(read_file(fixture.folder() / "capture.json"), first);
    ASSERT_EQ(again.cameras.size(), description.cameras.size());
    for (std::size_t i = 0; i < again.cameras.size(); ++i) {
        const RigidTransform& pose = again.cameras[i].world_from_camera;
        EXPECT_EQ(pose.rotation, description.cameras[i].world_from_camera.rotation);
        EXPECT_EQ(pose.translation, description.cameras[i].world_from_camera.translation);
    }
    ASSERT_EQ(again.lights.size(), description.lights.size());
    for (std::size_t i = 0; i < again.lights.size(); ++i) {
        EXPECT_EQ(again.lights[i].direction, description.lights[i].direction);
        EXPECT_EQ(again.lights[i].direction_stddev, description.lights[i].direction_stddev);
    }
    EXPECT_EQ(again.geometry.range_frame.azimuth_begin,
              description.geometry.range_frame.azimuth_begin);
    EXPECT_EQ(again.geometry.normal_stddev, description.geometry.normal_stddev);
    EXPECT_EQ(again.radiometry.gamma, description.radiometry.gamma);
    EXPECT_EQ(again.shots[0].exposure, description.shots[0].exposure);
}

TEST(WrittenDescription, ReadsBackTheSameForAMesh) {
    expect_same_after_writing(
        {{kPose,
          R"("world_from_camera": [0.6, 0, 0.8, 0.1, 0, -1, 0, 0.3333333333333333,
                                   0.8, 0, -0.6, 2, 0, 0, 0, 1])"},
         {R"("intensity": [1, 1, 1])",
          R"("intensity": [0.1, 1e-9, 3], "direction": [0.1, 0.2, -0.7], "falloff": 1.7,
             "direction_stddev": 0.7, "position_stddev": 0.1, "intensity_stddev": 0.02)"},
         {R"("texels": [4, 4])",
          R"("texels": [4, 4], "normal_stddev": 1.3, "registration_stddev": 0.3)"},
         {R"("exposure": 1)", R"("exposure": 0.1, "mask": "mask.png", "heldout": true)"},
         {R"({"response": "linear"})",
          R"({"response": {"gamma": 2.2}, "saturation": 0.98, "scale": "unknown",
              "noise": {"read": 0.001, "gain": 1e-5}})"},
         {R"("radiometry")",
          R"("truth": {"diffuse": "grid.exr", "specular": "grid.exr", "roughness": "grid.exr"},
             "radiometry")"}});
}

TEST(WrittenDescription, ReadsBackTheSameForACylinder) {
    Changes changes = cylinder_changes();
    changes.push_back(
        {R"("height": [0, 1])", R"("height": [0, 1], "azimuth": [12.3, 123.4], "max_step": 2)"});
    expect_same_after_writing(changes);
}

TEST(WrittenDescription, ReadsBackTheSameForADepthImage) {
    expect_same_after_writing(depth_changes());
}

TEST(WrittenDescription, KeepsDegreesShort) {
    CaptureFixture fixture;
    const CaptureDescription description = description_after(
        fixture,
        {{R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, 1], "direction_stddev": 0.7)"}});
    write_capture_description(description, fixture.folder());
    EXPECT_NE(read_file(fixture.folder() / "capture.json").find("\"direction_stddev\": 0.7\n"),
              std::string::npos);
}

}  // namespace
}  // namespace patina
