// Where the lamps stand, as inline SVG: the candidates, and the chosen ones with their order.
#pragma once

#include "patina/export/report.h"

#include <string>

namespace patina {

// The lamps as seen from the middle of the object, looking towards them, the y axis up. Lamps
// within 60 degrees of their middle direction are drawn to scale on a plane across it; wider
// arrangements (domes) by angle from it. Empty when there is no lamp.
[[nodiscard]] std::string lamp_map(const SelectionReport& selection);

}  // namespace patina
