// The six pictures of a capture: Pd without and with bounced light, the lobe, the status.
#pragma once

#include "patina/capture/capture.h"

#include "method_run.h"
#include <filesystem>
#include <string>
#include <vector>

namespace patina {

// Markdown.
[[nodiscard]] std::string table_row(const std::vector<std::string>& cells);
[[nodiscard]] std::string table_head(const std::vector<std::string>& cells);

// Writes them to docs/pictures and returns them as Markdown; nothing where docs is empty.
[[nodiscard]] std::string write_pictures(const std::string& name,
                                         const Capture& capture,
                                         const std::filesystem::path& docs,
                                         const MethodRun& direct,
                                         const MethodRun& gather);

}  // namespace patina
