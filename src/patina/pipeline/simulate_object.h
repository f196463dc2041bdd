// `patina simulate`: a capture of an object of which everything is known.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/json.h"
#include "patina/pipeline/options.h"
#include "patina/scan/scanner.h"

#include <filesystem>
#include <string>

namespace patina {

// What the command line says of a simulation. By default small enough for a minute.
struct SimulateOptions {
    SimulateOptions();

    ScanOptions scan;
    // "plan": those that `patina plan` chooses; "all"; or numbers of candidates with commas
    // between.
    std::string lights = "plan";
};
[[nodiscard]] OptionTable simulate_option_table(SimulateOptions& options);

// object: A, B, C, V45 or U. Writes the capture's folder whole. Throws Error, WorkFailed,
// Interrupted.
[[nodiscard]] Json simulate_object(const std::string& object,
                                   const std::filesystem::path& output,
                                   const SimulateOptions& options,
                                   Progress& progress);

[[nodiscard]] std::string simulate_text(const Json& simulated);

}  // namespace patina
