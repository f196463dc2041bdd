// `patina render`: the capture's shots again, from the estimated maps.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/json.h"
#include "patina/pipeline/options.h"
#include "patina/pipeline/shot_renderer.h"

#include <filesystem>
#include <string>

namespace patina {

[[nodiscard]] OptionTable render_option_table(ShotRenderOptions& options);

// Writes into the folder `output`, for every shot and named by its number, shotNNN.exr [radiance]
// and shotNNN.png to look at (the brightest hundredth of all shots is white). Returns the list of
// files. Throws Error, WorkFailed, Interrupted.
[[nodiscard]] Json render_capture(const std::filesystem::path& capture_path,
                                  const std::filesystem::path& result_path,
                                  const std::filesystem::path& output,
                                  const ShotRenderOptions& options,
                                  Progress& progress);

[[nodiscard]] std::string render_text(const Json& rendered);

}  // namespace patina
