// Where the virtual scanner's cameras and its candidate lamps stand.
#pragma once

#include "patina/scan/object.h"
#include "patina/scene/camera.h"
#include "patina/scene/light.h"

#include <vector>

namespace patina {

// As in the paper: 60 candidates at intervals of 5 cm.
inline constexpr int kNumCandidates = 60;
inline constexpr double kLampSpacing = 0.05;  // [m]

struct ScanRig {
    std::vector<Camera> cameras;  // registered: their images lie in the texel domain
    std::vector<Light>
        candidates;  // kNumCandidates point lights; a white surface has radiance of about 1
    Light heldout;   // above the camera, not one of the candidates
};

// B and C: a line camera at 0.85 m from the axis, a grid of 6 x 10 lamps in a plane at 0.3 m, near
// enough for highlights on slopes, all turning with the scanner. A: a camera on the bisector, two
// grids of 5 x 6 high enough to clear the opposite plate, the one over the edge of the standing
// plate for highlights on the lying one, the other its mirror image. V45 and U: lamps and cameras
// high above; U has three cameras, since none sees both walls. columns, rows: of the texel domain.
[[nodiscard]] ScanRig make_rig(const SimulatedObject& object, int columns, int rows);

}  // namespace patina
