// Candidate lamps by rule: a dome or a grid, for rigs that are yet to be built.
#pragma once

#include "patina/capture/capture.h"
#include "patina/scene/light.h"

#include <optional>
#include <vector>

namespace patina {

// Where candidate lamps stand about an object. What is not given follows from the geometry and the
// cameras.
struct LampStandOptions {
    int dome = 0;                   // lamps on a dome; 0: no dome
    int grid_across = 0;            // lamps in a row of a grid; 0: no grid
    int grid_along = 0;             // its rows
    std::optional<double> radius;   // of the dome, or from the object to the grid [length]; > 0
    std::optional<double> spacing;  // of the grid's lamps [length]; > 0; a tenth of the radius
    std::optional<Vec3> center;     // [length]; the middle of the geometry
    std::optional<Vec3> axis;       // from the centre to the middle of the lamps; to the cameras

    [[nodiscard]] bool is_given() const { return dome > 0 || grid_across > 0; }
};

// Throws Error for words that contradict each other. Options are named as on the command line.
void validate(const LampStandOptions& options);

// Point lamps under which white that faces them at the centre has radiance 1. A dome spreads them
// evenly in solid angle (a Fibonacci spiral) up to 80 degrees from the axis. They turn with the
// scanner when all cameras do. options: validated, with a dome or a grid. Throws Error when they
// would stand inside the object.
[[nodiscard]] std::vector<Light> stand_lamps(const Capture& capture,
                                             const LampStandOptions& options);

}  // namespace patina
