// `patina info`: what a capture, a rig or a result holds.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/json.h"
#include "patina/pipeline/options.h"

#include <filesystem>
#include <string>

namespace patina {

struct InfoOptions {
    std::filesystem::path output;  // folder for a contact sheet; empty: none
};
[[nodiscard]] OptionTable info_option_table(InfoOptions& options);

// Reads and checks everything that path holds but the pixels of a capture's images; with `output`
// those too, for sheet.png. Throws Error, WorkFailed, Interrupted.
[[nodiscard]] Json show_info(const std::filesystem::path& path,
                             const InfoOptions& options,
                             Progress& progress);

// One line per entry.
[[nodiscard]] std::string info_text(const Json& info);

}  // namespace patina
