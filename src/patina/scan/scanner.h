// The virtual scanner: a capture folder with everything that a real one would have, and the truth.
//
// The images are rendered from a finer surface than the one handed out, with sensor noise, and on
// request with the calibration errors of a real scanner: what is handed out never fits exactly.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/capture.h"
#include "patina/scan/object.h"
#include "patina/scan/rig.h"

#include <cstdint>
#include <filesystem>
#include <span>

namespace patina {

struct ScanOptions {
    int columns = 512;              // of the texel domain; >= 8
    int rows = 512;                 // of the texel domain; >= 8, divisible by the object's panels
    int samples_per_pixel = 256;    // paths per pixel and shot; >= 1
    int heldout_sample_factor = 4;  // the held-out image has this many times as many; >= 1
    // Of a good camera: 50 000 electrons at the white level, and 16 of read noise.
    double noise_read = 0.0003;   // standard deviation of a stored value p in darkness; >= 0
    double noise_gain = 0.00002;  // variance of p per p (shot noise); >= 0
    std::uint64_t seed = 1;
    // Calibration errors, one standard deviation each; >= 0. They are stated in the capture.
    double misregistration_pixels =
        0;  // shift of each camera's images against the geometry, per axis
    double lamp_position_error_m = 0;  // of each lamp, per axis [m]
    double normal_error_degrees =
        0;                  // tilt of the handed-out normals, per axis, by noise of the range
    int quantize_bits = 0;  // 8 or 16: images are PNG, radiance 2 is their white; 0: float EXR
};

// Throws Error naming the option.
void validate(const ScanOptions& options);

// What the range finder hands out: a range image (B, C), or a textured mesh (A, V45, U).
struct ScannedGeometry {
    Image range;  // one channel, 0 where nothing was measured [m]; empty for textured meshes
    Mesh mesh;    // of the range image, or the textured mesh itself
};
[[nodiscard]] ScannedGeometry scan_geometry(const SimulatedObject& object,
                                            const ScanOptions& options);

// The object as a planner of lamp positions needs it: handed-out geometry, cameras and all
// candidate lamps, no shots. Nothing is written; description.folder is empty.
[[nodiscard]] Capture simulate_rig(const SimulatedObject& object, const ScanOptions& options);

// The truth in the texel domain, at the texels' centres; mask: 1 where there is surface.
[[nodiscard]] TruthMaps truth_maps(const SimulatedObject& object, const ScanOptions& options);

// Writes a capture into `folder`, which exists: geometry, one shot per chosen lamp and camera, one
// held-out shot without sensor noise per camera under the lamp above it, truth maps and
// capture.json. chosen: numbers of candidate lamps, each below kNumCandidates, none twice. An image
// does not depend on which other lamps are chosen. The same bytes for any number of threads. Throws
// Error, WorkFailed, Interrupted.
CaptureDescription simulate_capture(const SimulatedObject& object,
                                    std::span<const std::size_t> chosen,
                                    const ScanOptions& options,
                                    Progress& progress,
                                    const std::filesystem::path& folder);

}  // namespace patina
