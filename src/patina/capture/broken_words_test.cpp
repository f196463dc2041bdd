// Captures whose capture.json says something wrong: each gives its own one line.
#include "patina/capture/capture_fixture.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace patina {
namespace {

struct Case {
    Changes changes;
    std::string line;  // after "capture.json: "
};

void expect_lines(const std::vector<Case>& cases, const Changes& first = {}) {
    for (const Case& broken : cases) {
        SCOPED_TRACE(broken.line);
        CaptureFixture fixture;
        fixture.change(first);
        fixture.change(broken.changes);
        EXPECT_EQ(fixture.error_line(), "capture.json: " + broken.line);
    }
}

TEST(BrokenWords, OfTheDocument) {
    expect_lines({
        {{{R"("patina-capture")", R"("patina-rig")"}},
         R"(format: is "patina-rig" (expected "patina-capture"))"},
        {{{R"("format": "patina-capture",)", ""}},
         R"(format: is missing (expected "patina-capture"))"},
        {{{R"("version": 1)", R"("version": 2)"}}, "version: is 2 (expected 1)"},
        {{{R"("version": 1)", R"("version": "1")"}}, R"(version: is "1" (expected 1))"},
        {{{R"("name": "square",)", ""}}, "name: is missing (expected text)"},
        {{{R"("length_unit": "m")", R"("length_unit": "inch")"}},
         R"(length_unit: is "inch" (expected "m" or "cm" or "mm"))"},
        {{{R"("name": "square")", R"("nam": "square")"}},
         "nam: is not a field here (expected one of format, version, name, length_unit, geometry, "
         "cameras, lights, shots, radiometry, truth)"},
        {{{R"("name": "square")", R"("name": "square", "name": "circle")"}},
         "name: is given twice (expected one field)"},
        {{{R"("position": [0, 0, 3])", R"("position": [0, 0, 3], "position": [0, 0, 4])"}},
         "lights[0].position: is given twice (expected one field)"},
    });
}

TEST(BrokenWords, OfTheMesh) {
    expect_lines({
        {{{R"("geometry": {"mesh": "quad.obj", "texels": [4, 4]},)", ""}},
         "geometry: is missing (expected an object)"},
        {{{R"("mesh": "quad.obj")", R"("mesh": "quad.obj", "range": "range.exr")"}},
         R"(geometry: has both "mesh" and "range" (expected either "mesh" or "range"))"},
        {{{R"("mesh": "quad.obj", )", ""}},
         R"(geometry: has neither "mesh" nor "range" (expected either "mesh" or "range"))"},
        {{{R"(, "texels": [4, 4])", ""}},
         "geometry.texels: is missing (expected a list of 2 integers)"},
        {{{R"("texels": [4, 4])", R"("texels": [4])"}},
         "geometry.texels: is a list of 1 (expected a list of 2 integers)"},
        {{{R"("texels": [4, 4])", R"("texels": [4, 0])"}},
         "geometry.texels[1]: is 0 (expected an integer from 1 to 32768)"},
        {{{R"("texels": [4, 4])", R"("texels": [4.5, 4])"}},
         "geometry.texels[0]: is 4.5 (expected an integer from 1 to 32768)"},
        {{{R"("texels": [4, 4])", R"("texels": [32768, 32768])"}},
         "geometry.texels: makes 32768 x 32768 texels (expected at most 67108864)"},
        {{{R"("texels": [4, 4])", R"("texels": [4, 4], "unwrap": 1)"}},
         "geometry.unwrap: is 1 (expected true or false)"},
        {{{R"("texels": [4, 4])", R"("texels": [4, 4], "normal_stddev": -1)"}},
         "geometry.normal_stddev: is -1 (expected a number of at least 0)"},
        {{{R"("texels": [4, 4])", R"("texels": [4, 4], "max_step": 1)"}},
         "geometry.max_step: is not a field here (expected one of mesh, texels, unwrap, "
         "normal_stddev, registration_stddev)"},
    });
}

TEST(BrokenWords, OfTheCylinder) {
    expect_lines(
        {
            {{{R"("cylindrical")", R"("spherical")"}},
             R"(geometry.projection: is "spherical" (expected "cylindrical" or "camera"))"},
            {{{R"(, "height": [0, 1])", ""}},
             "geometry.height: is missing (expected a list of 2 numbers)"},
            {{{R"("height": [0, 1])", R"("height": [1, 1])"}},
             "geometry.height: is [1, 1] (expected [y0, y1] with y0 < y1)"},
            {{{R"("height": [0, 1])", R"("height": [0, 1], "azimuth": [0, 361])"}},
             "geometry.azimuth: is [0, 361] (expected [a0, a1] with a0 < a1, at most a full turn, "
             "in degrees)"},
            {{{R"("height": [0, 1])", R"("height": [0, 1], "max_step": 0)"}},
             "geometry.max_step: is 0 (expected a number above 0)"},
            {{{R"("height": [0, 1])", R"("height": [0, 1], "texels": [8, 4])"}},
             "geometry.texels: is not a field here (expected one of range, projection, azimuth, "
             "height, max_step, normal_stddev, registration_stddev)"},
        },
        cylinder_changes());
}

TEST(BrokenWords, OfTheDepthImage) {
    expect_lines(
        {
            {{{R"("camera": "front")", R"("camera": "side")"}},
             R"(geometry.camera: is "side", which no camera has (expected the id of a camera))"},
            {{{R"("id": "front")", R"("id": "dot", "model": "registered", "position": [0, 0, 1]},
               {"id": "front")"},
              {R"("camera": "front")", R"("camera": "dot")"}},
             R"(geometry.camera: "dot" is a registered camera (expected a pinhole or orthographic )"
             "camera)"},
        },
        depth_changes());
}

TEST(BrokenWords, OfTheCameras) {
    const std::string pose = "[1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 2, 0, 0, 0, 1]";
    const std::string rigid = " (expected a rigid pose: 4 x 4, row by row, last row 0 0 0 1)";
    expect_lines({
        {{{R"("model": "pinhole")", R"("model": "fisheye")"}},
         R"(cameras[0].model: is "fisheye" (expected "pinhole" or "orthographic" or "registered"))"},
        {{{R"("fx": 5,)", ""}}, "cameras[0].fx: is missing (expected a number above 0)"},
        {{{R"("fx": 5)", R"("fx": 0)"}}, "cameras[0].fx: is 0 (expected a number above 0)"},
        {{{R"("fx": 5)", R"("fx": "5")"}}, R"(cameras[0].fx: is "5" (expected a number above 0))"},
        {{{R"("cx": 2)", R"("cx": null)"}}, "cameras[0].cx: is null (expected a number)"},
        {{{R"("width": 4)", R"("width": -4)"}},
         "cameras[0].width: is -4 (expected an integer from 1 to 65536)"},
        {{{R"("cy": 1.5)", R"("cy": 1.5, "distortion": [0, 0, 0, 0])"}},
         "cameras[0].distortion: is a list of 4 (expected a list of 5 numbers)"},
        {{{R"("cy": 1.5)", R"("cy": 1.5, "pixel_size": 1)"}},
         "cameras[0].pixel_size: is not a field here (expected one of id, model, width, height, "
         "fx, fy, cx, cy, distortion, world_from_camera)"},
        {{{pose, "[1, 0, 0, 0]"}},
         "cameras[0].world_from_camera: is a list of 4 (expected a list of 16 numbers)"},
        {{{pose, "[1, 0, 0, 0, 0, -1, 0, 0, 0, 0, null, 2, 0, 0, 0, 1]"}},
         "cameras[0].world_from_camera[10]: is null (expected a number)"},
        {{{pose, "[1, 0.001, 0, 0, 0, -1, 0, 0, 0, 0, -1, 2, 0, 0, 0, 1]"}},
         "cameras[0].world_from_camera: stretches or shears" + rigid},
        {{{pose, "[2, 0, 0, 0, 0, -2, 0, 0, 0, 0, -2, 2, 0, 0, 0, 1]"}},
         "cameras[0].world_from_camera: stretches or shears" + rigid},
        {{{pose, "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 2, 0, 0, 0, 1]"}},
         "cameras[0].world_from_camera: mirrors" + rigid},
        {{{pose, "[1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 2, 1]"}},
         "cameras[0].world_from_camera: has the last row 0 0 2 1" + rigid},
        {{{R"("id": "front")", R"("id": "")"}},
         R"(cameras[0].id: is "" (expected an id of its own))"},
        {{{R"("cameras": [)", R"("cameras": [], "x-cameras": [)"}},
         "cameras: is empty (expected a list of cameras)"},
        {{{R"("cameras": [)",
           R"("cameras": [{"id": "front", "model": "registered", "position": [0, 0, 1]},)"}},
         R"(cameras[1].id: is "front" for the second time (expected an id of its own))"},
        {{{R"("cameras": [)",
           R"("cameras": [{"id": "line", "model": "registered", "position": [0, 0, 1],
                           "frame": "scanner"},)"}},
         R"(cameras[0].frame: is "scanner" (expected a cylindrical range image))"},
    });
}

TEST(BrokenWords, OfTheLights) {
    expect_lines({
        {{{R"("type": "point")", R"("type": "area")"}},
         R"(lights[0].type: is "area" (expected "point" or "directional"))"},
        {{{R"("position": [0, 0, 3])", R"("position": [0, 0])"}},
         "lights[0].position: is a list of 2 (expected a list of 3 numbers)"},
        {{{R"("position": [0, 0, 3])", R"("position": {"z": 3})"}},
         "lights[0].position: is an object (expected a list of 3 numbers)"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": [1, "1", 1])"}},
         R"(lights[0].intensity[1]: is "1" (expected a number))"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, -1])"}},
         "lights[0].intensity[2]: is -1 (expected a number of at least 0)"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": 1)"}},
         "lights[0].intensity: is 1 (expected a list of 3 numbers)"},
        {{{R"("intensity": [1, 1, 1])",
           R"("intensity": [1, 1, 1], "direction": [0, 0, 0], "falloff": 1)"}},
         "lights[0].direction: is the zero vector (expected a direction)"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, 1], "direction": [0, 0, -1])"}},
         "lights[0].falloff: is missing (expected a number of at least 0)"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, 1], "falloff": 1)"}},
         "lights[0].direction: is missing (expected a list of 3 numbers)"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, 1], "irradiance": [1, 1, 1])"}},
         "lights[0].irradiance: is not a field here (expected one of id, type, position, "
         "intensity, "
         "direction, falloff, frame, position_stddev, direction_stddev, intensity_stddev)"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, 1], "intensity_stddev": -0.1)"}},
         "lights[0].intensity_stddev: is -0.1 (expected a number of at least 0)"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, 1], "frame": "turntable")"}},
         R"(lights[0].frame: is "turntable" (expected "world" or "scanner"))"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, 1], "frame": "scanner")"}},
         R"(lights[0].frame: is "scanner" (expected a cylindrical range image))"},
        {{{R"("lights": [)",
           R"("lights": [{"id": "lamp", "type": "directional", "direction": [0, 0, 1],
                          "irradiance": [1, 1, 1]},)"}},
         R"(lights[1].id: is "lamp" for the second time (expected an id of its own))"},
    });
}

TEST(BrokenWords, OfTheShots) {
    expect_lines({
        {{{R"("light": "lamp")", R"("light": "sun")"}},
         R"(shots[0].light: is "sun", which no light has (expected the id of a light))"},
        {{{R"("camera": "front")", R"("camera": 0)"}},
         "shots[0].camera: is 0 (expected the id of a camera)"},
        {{{R"("light": "lamp", )", ""}},
         R"(shots[0]: has neither "light" nor "lights" (expected one of them))"},
        {{{R"("light": "lamp")", R"("light": "lamp", "lights": ["lamp"])"}},
         R"(shots[0]: has both "light" and "lights" (expected one of them))"},
        {{{R"("light": "lamp")", R"("lights": [])"}},
         "shots[0].lights: is empty (expected at least one id of a light)"},
        {{{R"("light": "lamp")", R"("lights": ["lamp", "lamp"])"}},
         R"(shots[0].lights[1]: is "lamp" for the second time (expected each light once))"},
        {{{R"("exposure": 1)", R"("exposure": 0)"}},
         "shots[0].exposure: is 0 (expected a number above 0)"},
        {{{R"("exposure": 1)", R"("exposure": -0.01)"}},
         "shots[0].exposure: is -0.01 (expected a number above 0)"},
        {{{R"("exposure": 1)", R"("exposure": 1, "heldout": "yes")"}},
         R"(shots[0].heldout: is "yes" (expected true or false))"},
        {{{R"("exposure": 1)", R"("exposur": 1)"}},
         "shots[0].exposur: is not a field here (expected one of image, camera, light, lights, "
         "exposure, mask, dark, heldout)"},
        {{{R"("shots": [)", R"("shots": [], "x-shots": [)"}},
         "shots: is empty (expected a list of at least one shot)"},
        {{{R"("shots": [)", R"("x-shots": [)"}},
         "shots: is missing (expected a list of at least one shot)"},
    });
}

TEST(BrokenWords, OfNumbersBeyondMeasure) {
    expect_lines({
        {{{R"("cx": 2)", R"("cx": -1e16)"}},
         "cameras[0].cx: is -1e+16 (expected at most 1e+13 in size)"},
        {{{R"("fx": 5)", R"("fx": 1e300)"}},
         "cameras[0].fx: is 1e+300 (expected at most 1e+13 in size)"},
        {{{R"("exposure": 1)", R"("exposure": 5e-324)"}},
         "shots[0].exposure: is 5e-324 (expected at least 1e-13)"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": [1, 1e39, 1])"}},
         "lights[0].intensity[1]: is 1e+39 (expected at most 1e+13 in size)"},
        {{{R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, 9223372036854775807])"}},
         "lights[0].intensity[2]: is 9223372036854775807 (expected at most 1e+13 in size)"},
    });
}

TEST(BrokenWords, OfScannerFrames) {
    const Changes turning_light = {
        {R"("intensity": [1, 1, 1])", R"("intensity": [1, 1, 1], "frame": "scanner")"}};
    Changes still_camera = turning_light;
    still_camera.push_back({R"(, "frame": "scanner"})", "}"});
    expect_lines(
        {
            {still_camera,
             R"(shots[0].camera: "line" stands still while light "lamp" turns with the scanner )"
             R"((expected a registered camera with "frame": "scanner"))"},
        },
        cylinder_changes());
}

TEST(BrokenWords, OfTheRadiometry) {
    const std::string response = R"("response": "linear")";
    expect_lines({
        {{{response, R"("response": "log")"}},
         R"(radiometry.response: is "log" (expected "linear" or "srgb" or {"gamma": g}))"},
        {{{response, R"("response": 2.2)"}},
         R"(radiometry.response: is 2.2 (expected "linear" or "srgb" or {"gamma": g}))"},
        {{{response, R"("response": {"gamma": 0})"}},
         "radiometry.response.gamma: is 0 (expected a number above 0)"},
        {{{response, response + R"(, "saturation": 0)"}},
         "radiometry.saturation: is 0 (expected a number above 0)"},
        {{{response, response + R"(, "noise": {"read": -0.1, "gain": 0})"}},
         "radiometry.noise.read: is -0.1 (expected a number of at least 0)"},
        {{{response, response + R"(, "noise": {"read": 0.1})"}},
         "radiometry.noise.gain: is missing (expected a number of at least 0)"},
        {{{response, response + R"(, "scale": "relative")"}},
         R"(radiometry.scale: is "relative" (expected "absolute" or "unknown"))"},
        {{{R"("radiometry": {"response": "linear"})", R"("x-none": 0)"}},
         "radiometry: is missing (expected an object)"},
        {{{R"("radiometry")", R"("truth": {"diffuse": "grid.exr", "specular": "grid.exr"},
           "radiometry")"}},
         "truth.roughness: is missing (expected a path inside the capture's folder, with '/')"},
    });
}

}  // namespace
}  // namespace patina
