// `patina demo`: the paper's experiments on simulated objects A, B and C.
//
// Based on: Machida, Takemura, Yokoya. 2004, section 3.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/json.h"
#include "patina/export/report.h"
#include "patina/pipeline/options.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace patina {

struct DemoOptions {
    bool full = false;  // the paper's scale instead of a quarter of it
    std::filesystem::path output = "patina-demo";
    std::uint64_t seed = 1;
};
[[nodiscard]] OptionTable demo_option_table(DemoOptions& options);

// For each object: rig, plan, simulated capture, estimates by the four methods, comparison with
// the images and the truth; all left in the output folder, with report.html. Throws Error,
// WorkFailed, Interrupted.
[[nodiscard]] ReportData run_demo(const DemoOptions& options, Progress& progress);

// Table 1 beside the paper's, and the path of the report.
[[nodiscard]] Json demo_json(const ReportData& report, const DemoOptions& options);
[[nodiscard]] std::string demo_text(const ReportData& report, const DemoOptions& options);

}  // namespace patina
