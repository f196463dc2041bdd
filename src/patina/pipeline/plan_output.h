// The folder that `patina plan -o` leaves: a rig to shoot from, the directions of its lamps, and a
// page with the curves. docs/planning.md describes the files.
#pragma once

#include "patina/capture/capture.h"
#include "patina/export/report.h"
#include "patina/plan/lamp_study.h"

#include <filesystem>
#include <string>

namespace patina {

// rig.json of the chosen lamps with its geometry, chosen.lp and plan.html, in a folder that exists.
void write_plan(const Capture& capture,
                const LampStudy& study,
                const std::filesystem::path& folder);

// The chosen lamps as the .lp file of reflectance transformation imaging: their number, then a line
// "ID x y z" each, the unit direction from the middle of the object towards the lamp.
[[nodiscard]] std::string lamp_directions_text(const Capture& capture, const LightPlan& plan);

// The study as reports show it, the other rules included.
[[nodiscard]] SelectionReport selection_report(const Capture& capture, const LampStudy& study);

// The page with the curves and the map of the lamps; the same study gives the same bytes.
[[nodiscard]] std::string plan_page(const Capture& capture, const LampStudy& study);

}  // namespace patina
