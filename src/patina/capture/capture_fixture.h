// A small valid capture in a temporary folder, for tests to take pieces of or to break.
#pragma once

#include "patina/image/image.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace patina {

// Texts to find and what to put in their place; each must be found.
using Changes = std::vector<std::pair<std::string, std::string>>;

// The geometry, camera and image of the fixture's range-image variants, as changes of its
// capture.json.
[[nodiscard]] Changes cylinder_changes();
[[nodiscard]] Changes depth_changes();

// In the folder: capture.json (quad.obj seen by one pinhole camera "front" of 4 x 3 pixels, lit by
// one point light "lamp" in one shot), and further files that variants name:
//   quad.obj         the square [-1, 1]^2 of z = 0 facing +z, uv all over the texture
//   image.exr        4 x 3, three channels, 0.25
//   grid.exr         4 x 4, three channels: the size of the texel domain
//   range.exr        8 x 4, one channel, 0.5: a cylinder
//   scan.exr         8 x 4, three channels: the size of its texel domain
//   depth.exr        4 x 3, one channel, 2: a plane
//   mask.png         4 x 3, 8 bits, white
class CaptureFixture {
  public:
    CaptureFixture();
    ~CaptureFixture();
    CaptureFixture(const CaptureFixture&) = delete;
    CaptureFixture& operator=(const CaptureFixture&) = delete;

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    [[nodiscard]] const std::string& json() const { return json_; }
    // Changes capture.json; may be called again.
    void change(const Changes& changes);
    // Replaces capture.json as a whole.
    void set_json(const std::string& json);
    void write(const std::string& name, const std::string& contents) const;
    // The line of the error that loading everything throws, without the folder's name; "" when it
    // throws none.
    [[nodiscard]] std::string error_line() const;

  private:
    std::filesystem::path parent_;
    std::filesystem::path folder_;
    std::string json_;
};

}  // namespace patina
