// `patina plan`: which lamp positions to take, for a capture or a rig.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/json.h"
#include "patina/pipeline/options.h"
#include "patina/plan/lamp_stand.h"
#include "patina/plan/lamp_study.h"

#include <filesystem>
#include <string>

namespace patina {

// What the command line says of a plan.
struct PlanOptions {
    StudyOptions study;
    LampStandOptions stand;
    std::string taken;             // ids of lamps that were shot already, with commas between
    std::filesystem::path given;   // a capture whose shots were taken already; empty: none
    std::filesystem::path maps;    // a result to plan for; empty: a typical surface
    std::filesystem::path output;  // folder for a rig of the chosen lamps; empty: none
};
[[nodiscard]] OptionTable plan_option_table(PlanOptions& options);
[[nodiscard]] const Choices<PlanRule>& plan_rules();

// path: a capture, or a folder with a rig.json, or that file. Throws Error, WorkFailed,
// Interrupted.
[[nodiscard]] Json plan_lamps(const std::filesystem::path& path,
                              const PlanOptions& options,
                              Progress& progress);

[[nodiscard]] std::string plan_text(const Json& plan);

}  // namespace patina
