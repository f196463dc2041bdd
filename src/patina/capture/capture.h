// A capture in memory: what was measured of one object, and how.
//
// docs/capture.md describes the format.
#pragma once

#include "patina/image/image.h"
#include "patina/scene/atlas.h"
#include "patina/scene/camera.h"
#include "patina/scene/light.h"
#include "patina/scene/mesh.h"
#include "patina/scene/range_image.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patina {

enum class LengthUnit { meter, centimeter, millimeter };
// "m", "cm" or "mm".
[[nodiscard]] const char* length_unit_name(LengthUnit unit);

// How the geometry was given. Exactly one of mesh_file and range_file is set.
struct GeometrySource {
    std::string mesh_file;   // relative to the capture's folder
    std::string range_file;  // relative to the capture's folder
    bool unwrap = false;     // the mesh has no uvs and patina makes them
    int texel_width = 0;
    int texel_height = 0;
    RangeFrame range_frame;          // with range_file
    std::string range_camera;        // id, for projection camera
    double normal_stddev = 0;        // [rad]
    double registration_stddev = 0;  // [pixels]
};

struct Shot {
    std::string image;  // relative to the capture's folder
    std::size_t camera = 0;
    std::vector<std::size_t> lights;  // ascending, at least one
    double exposure = 1;
    std::string mask;  // empty: none
    std::string dark;  // empty: none
    bool heldout = false;
};

enum class ResponseKind { linear, srgb, gamma };

struct Radiometry {
    ResponseKind response = ResponseKind::linear;
    double gamma = 1;  // of response gamma
    // Stored value v [-]; nothing: 1 for integer images, none for float.
    std::optional<double> saturation;
    bool has_noise = false;
    double noise_read = 0;  // standard deviation of p
    double noise_gain = 0;  // variance of p per p
    bool scale_unknown = false;
};

struct Truth {
    std::string diffuse;
    std::string specular;
    std::string roughness;
    std::string mask;  // empty: none
};

// The words of capture.json (or rig.json), checked, without the heavy data.
struct CaptureDescription {
    std::filesystem::path folder;
    std::filesystem::path file;  // the JSON itself, for messages
    std::string name;
    LengthUnit length_unit = LengthUnit::meter;
    GeometrySource geometry;
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    std::vector<Shot> shots;  // empty for a rig
    Radiometry radiometry;
    std::optional<Truth> truth;
};

// A capture with its surface, ready to be worked on.
struct Capture {
    CaptureDescription description;
    Mesh mesh;  // with uvs; for range images the joined surface
    TexelAtlas atlas;
};

// Reads and checks capture.json: words, types, numbers, ids, poses, files that must exist, image
// sizes. Throws Error on the first thing that breaks the format. path: the folder or the file
// itself.
[[nodiscard]] CaptureDescription read_capture_description(const std::filesystem::path& path);

// The same for a rig.json ("patina-rig"): candidate lamp positions, no shots.
[[nodiscard]] CaptureDescription read_rig_description(const std::filesystem::path& path);

// Reads the geometry, checks it (uvs present, inside the square, not overlapping, no degenerate
// mesh) and builds the atlas. Throws Error.
[[nodiscard]] Capture load_capture(const CaptureDescription& description);
[[nodiscard]] Capture load_capture(const std::filesystem::path& path);

// Makes all lamps that many times as strong. factor: > 0.
void multiply_lamps(double factor, CaptureDescription& description);

// One shot as radiance.
struct RadianceImage {
    // Three channels [W/(m^2 sr), or the capture's own unit]; always finite, 0 where the file is
    // not.
    Image radiance;
    std::vector<std::uint8_t> usable;  // per pixel; 0: masked, saturated, out of range
    // Of the radiance, from read and shot noise, per pixel and channel; empty when no noise is
    // stated.
    Image variance;
};
// Reads the image, undoes the response, takes the dark frame off, divides by the exposure, marks
// what cannot be used. Throws Error naming shots[i].
[[nodiscard]] RadianceImage load_radiance(const CaptureDescription& description, std::size_t shot);

// Truth maps in the texel domain. Only for compare.
struct TruthMaps {
    Image diffuse;    // 3 channels
    Image specular;   // 1 channel: the mean of the file's three where it has three
    Image roughness;  // 1 channel [rad]
    Image mask;       // 1 channel; 0 = ignore, also where the truth is not finite; empty: none
};
// The description must have a truth.
[[nodiscard]] TruthMaps load_truth(const CaptureDescription& description);

// Writes capture.json (or rig.json when there are no shots) for a description whose files lie, or
// will lie, in `folder`. Fields in a fixed order, defaults left out; the same description gives the
// same bytes, and reading it back gives the same description to the last bit. (An angle that no
// number of degrees reads back as exactly comes back within one rounding.)
void write_capture_description(const CaptureDescription& description,
                               const std::filesystem::path& folder);

}  // namespace patina
