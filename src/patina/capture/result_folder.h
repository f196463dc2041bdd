// The folder that an estimate leaves: maps, surface and result.json. docs/result.md describes it.
#pragma once

#include "patina/capture/lobe_reason.h"
#include "patina/image/image.h"
#include "patina/scene/mesh.h"

#include <filesystem>
#include <string>

namespace patina {

// What is known of a texel; the values of status.exr.
enum class TexelStatus {
    off_surface = 0,       // every map is 0 here
    measured = 1,          // Pd and Ps, and sigma too unless Ps is not told from 0
    diffuse_measured = 2,  // Pd; Ps and sigma are filled
    filled = 3,            // never usefully observed
};

// Maps in the texel domain, all of one size. Never NaN; standard errors may be +infinity.
struct ReflectanceMaps {
    Image diffuse;         // Pd, three channels [-]
    Image specular;        // Ps, one channel [-]; in files three equal ones
    Image roughness;       // sigma, one channel [rad]
    Image diffuse_stderr;  // one standard error, channels as above; +infinity: nothing known
    Image specular_stderr;
    Image roughness_stderr;
    Image status;  // one channel, a TexelStatus as a number
    // What could be measured at all. Empty in results of programs that do not say.
    Image measurability = {};  // three channels: relative errors to be expected of Pd, Ps, sigma
    Image reason = {};         // one channel, a LobeReason as a number
};

// The noise of looks as a fit found it, in units of the stated one [-]. As it stands where a
// program does not say.
struct FitNoise {
    double scale = 1;   // standard deviation, whatever the channels share
    double own = 1;     // variance that the channels of a look do not share
    double shared = 0;  // and that they do
};

struct Result {
    ReflectanceMaps maps;
    Mesh mesh;         // the surface in the capture's frame, with uvs
    std::string json;  // the text of result.json
    std::string name;  // of the capture
    // The lamps' true strength over the capture's [-]: other than 1 only where the capture did not
    // know it and the estimate told it.
    double lamp_factor = 1;
    FitNoise noise;
};

// Writes the maps as OpenEXR into an existing folder, those that are not empty. The maps must be as
// described above: sizes and channels, no NaN, statuses 0 to 3, reasons 0 to 8, and 0 in every map
// where the status is 0; anything
// else is a bug of the caller (PATINA_CHECK). Throws WorkFailed when the disk refuses.
void write_result_maps(const std::filesystem::path& folder, const ReflectanceMaps& maps);

// Writes the whole folder: maps, geometry.ply and result.json (the text as it is).
void write_result(const std::filesystem::path& folder, const Result& result);

// Reads and checks a result folder. path: the folder or its result.json. Throws Error when a file
// is missing or damaged (but for measurability.exr and reason.exr, which may be missing), sizes or
// channels differ, a value is NaN, a status or reason is none, or the format or version is another.
[[nodiscard]] Result read_result(const std::filesystem::path& path);

}  // namespace patina
