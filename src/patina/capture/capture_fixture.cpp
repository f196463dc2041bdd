#include "patina/capture/capture_fixture.h"

#include "patina/base/check.h"
#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/capture/capture.h"

#include <gtest/gtest.h>

#include <atomic>
#include <unistd.h>

namespace patina {
namespace {

constexpr const char* kJson = R"({
  "format": "patina-capture",
  "version": 1,
  "name": "square",
  "length_unit": "m",
  "geometry": {"mesh": "quad.obj", "texels": [4, 4]},
  "cameras": [
    {"id": "front", "model": "pinhole", "width": 4, "height": 3, "fx": 5, "fy": 5, "cx": 2, "cy": 1.5,
     "world_from_camera": [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 2, 0, 0, 0, 1]}
  ],
  "lights": [
    {"id": "lamp", "type": "point", "position": [0, 0, 3], "intensity": [1, 1, 1]}
  ],
  "shots": [
    {"image": "image.exr", "camera": "front", "light": "lamp", "exposure": 1}
  ],
  "radiometry": {"response": "linear"}
}
)";

constexpr const char* kQuad = R"(v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 1/1 2/2 3/3
f 1/1 3/3 4/4
)";

constexpr const char* kMeshGeometry = R"({"mesh": "quad.obj", "texels": [4, 4]})";

std::filesystem::path new_folder() {
    std::string name =
        (std::filesystem::path(::testing::TempDir()) / "patina_capture_XXXXXX").string();
    PATINA_CHECK(mkdtemp(name.data()) != nullptr);
    return name;
}

}  // namespace

Changes cylinder_changes() {
    return {
        {kMeshGeometry, R"({"range": "range.exr", "projection": "cylindrical", "height": [0, 1]})"},
        {R"("image": "image.exr", "camera": "front")", R"("image": "scan.exr", "camera": "line")"},
        {R"("cameras": [)",
         R"("cameras": [
    {"id": "line", "model": "registered", "position": [0, 0.5, 3], "frame": "scanner"},)"}};
}

Changes depth_changes() {
    return {
        {kMeshGeometry, R"({"range": "depth.exr", "projection": "camera", "camera": "front"})"}};
}

CaptureFixture::CaptureFixture()
    : parent_(new_folder()), folder_(parent_ / "capture"), json_(kJson) {
    std::filesystem::create_directories(folder_);
    write("capture.json", json_);
    write("quad.obj", kQuad);
    write_exr(folder_ / "image.exr", Image(4, 3, 3, 0.25F));
    write_exr(folder_ / "grid.exr", Image(4, 4, 3, 0.25F));
    write_exr(folder_ / "range.exr", Image(8, 4, 1, 0.5F));
    write_exr(folder_ / "scan.exr", Image(8, 4, 3, 0.25F));
    write_exr(folder_ / "depth.exr", Image(4, 3, 1, 2.0F));
    write_png(folder_ / "mask.png", Image(4, 3, 1, 1.0F));
}

CaptureFixture::~CaptureFixture() {
    std::error_code ignored;
    std::filesystem::remove_all(parent_, ignored);
}

void CaptureFixture::change(const Changes& changes) {
    for (const auto& [from, to] : changes) {
        const std::size_t position = json_.find(from);
        PATINA_CHECK(position != std::string::npos);
        json_.replace(position, from.size(), to);
    }
    write("capture.json", json_);
}

void CaptureFixture::set_json(const std::string& json) {
    json_ = json;
    write("capture.json", json_);
}

void CaptureFixture::write(const std::string& name, const std::string& contents) const {
    write_file(folder_ / name, contents);
}

std::string CaptureFixture::error_line() const {
    try {
        const Capture capture = load_capture(folder_);
        for (std::size_t i = 0; i < capture.description.shots.size(); ++i) {
            static_cast<void>(load_radiance(capture.description, i));
        }
        if (capture.description.truth) static_cast<void>(load_truth(capture.description));
    } catch (const Error& error) {
        const std::string prefix = folder_.string() + "/";
        std::string line = error.what();
        for (std::size_t at = line.find(prefix); at != std::string::npos; at = line.find(prefix)) {
            line.erase(at, prefix.size());
        }
        return line;
    }
    return "";
}

}  // namespace patina
