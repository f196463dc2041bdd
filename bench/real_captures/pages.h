// The sections of docs/results.md, one for each capture, and the pictures that they show.
#pragma once

#include "patina/base/progress.h"

#include "method_run.h"
#include <filesystem>
#include <string>
#include <vector>

namespace patina {

struct PageSettings {
    std::filesystem::path captures;  // folder of the captures' folders
    std::filesystem::path docs;      // where results.md and pictures/ lie; empty: no pictures
    RunSettings run;
};

// The captures in the order of the page.
[[nodiscard]] std::vector<std::string> section_names();

// Estimates one capture and says what came out, in Markdown. name: one of section_names(). Throws
// Error, WorkFailed, Interrupted.
[[nodiscard]] std::string make_section(const std::string& name,
                                       const PageSettings& settings,
                                       Progress& progress);

// What holds for all sections.
[[nodiscard]] std::string make_introduction(const PageSettings& settings);

}  // namespace patina
