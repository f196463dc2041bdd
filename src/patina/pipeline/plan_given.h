// What a plan starts from: a rig or a capture, with its own lamps or a dome or grid of them, and
// perhaps a capture of the same object whose shots were taken already.
#pragma once

#include "patina/capture/capture.h"
#include "patina/plan/lamp_stand.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace patina {

struct PlanScene {
    Capture capture;  // with every lamp; the cameras whose looks count
    // With a given capture: what its used shots lit, ascending, and the cameras that only the rig
    // has.
    std::vector<std::size_t> taken;
    std::vector<Camera> new_cameras;
};

// given: empty for none. Throws Error also when the two are not of one object, or name one lamp or
// camera at two places.
[[nodiscard]] PlanScene read_plan_scene(const std::filesystem::path& path,
                                        const LampStandOptions& stand,
                                        const std::filesystem::path& given);

// Reads a capture or a rig, whichever the path holds.
[[nodiscard]] CaptureDescription read_capture_or_rig(const std::filesystem::path& path);

}  // namespace patina
