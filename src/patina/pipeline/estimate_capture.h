// `patina estimate`: from a capture's folder to a result's folder.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/capture.h"
#include "patina/capture/json.h"
#include "patina/capture/result_folder.h"
#include "patina/estimate/estimate.h"
#include "patina/pipeline/options.h"

#include <filesystem>

namespace patina {

// Every setting of an estimate but the seed, which all commands share. The table points into
// `options`.
[[nodiscard]] OptionTable estimate_option_table(EstimateOptions& options);

// "direct", "diffuse", "photon" or "gather".
[[nodiscard]] std::string method_name(Method method);

// The estimate as maps in the texel domain, and result.json with everything but `timing`: format,
// name, method, settings, seed, version, iterations, what became of the texels.
[[nodiscard]] Result make_result(const Capture& capture,
                                 const EstimateOptions& options,
                                 const Estimate& estimate);

// options.graph_file for estimate_capture() alone: keep no graph.
inline constexpr const char* kNoGraph = "none";

// Estimates and writes the result's folder, replacing what was there once all is done. Where
// options.graph_file is empty, the graph of method gather is kept beside it, as RESULT.graph.
// Returns what result.json holds, `timing` included. Throws Error, WorkFailed, Interrupted.
[[nodiscard]] Json estimate_capture(const std::filesystem::path& capture_path,
                                    const std::filesystem::path& result_path,
                                    const EstimateOptions& options,
                                    Progress& progress);

// What a user reads of it: a few lines of text. result: as estimate_capture() returns it.
[[nodiscard]] std::string estimate_text(const Json& result);

}  // namespace patina
