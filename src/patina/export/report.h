// The report: one self-contained HTML page with the paper's figures and table beside ours. Charts
// are inline SVG, pictures are PNG inside the page; no network, no scripts.
//
// The figures follow: Machida, Takemura, Yokoya. Dense Estimation of Surface Reflectance Properties
// Based on Inverse Global Illumination Rendering. 2004, Figs. 4 to 6 and Table 1. docs/report.md
// explains each section. What is missing from the data is left out of the page.
#pragma once

#include "patina/base/progress.h"
#include "patina/estimate/estimate.h"
#include "patina/export/lamp_rules.h"
#include "patina/image/image.h"
#include "patina/math/types.h"
#include "patina/scene/light.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patina {

// What was run. Nothing of the machine or the day, so equal runs give equal headers.
struct RunHeader {
    std::string title;    // "The paper's experiments"
    std::string summary;  // one or two sentences for the reader; may be empty
    std::string command;  // as typed; may be empty
    std::string version;  // of the program
    std::uint64_t seed = 0;
    std::vector<std::pair<std::string, std::string>> settings;  // name, value
};

// Maps in the texel domain, all of one size; an empty image is left out.
struct ReportMaps {
    Image diffuse;    // Pd, 3 channels [-]
    Image specular;   // Ps, 1 or 3 channels [-]; the first is shown
    Image roughness;  // sigma, 1 channel [rad]
    Image status;     // 1 channel, 0 to 3 as in docs/capture.md; of truth: 0 = ignore
};

// How well the maps are known, of the same size; an empty image is left out. docs/result.md.
struct CertaintyMaps {
    Image diffuse_stderr;    // 3 channels, one standard error
    Image specular_stderr;   // 1 channel
    Image roughness_stderr;  // 1 channel [rad]
    Image measurability;     // 3 channels: relative errors to be expected of Pd, Ps, sigma
    Image reason;            // 1 channel, a LobeReason as a number
};

// Synthetic against real images over the pixels of status 1 and 2, in 8-bit levels.
struct LevelComparison {
    double levels_mean = 0;      // of |difference| [levels]
    double levels_variance = 0;  // of |difference| [levels^2]
    double relative_rmse = 0;    // [-]
};

// An estimated map against the truth, as `patina compare` defines it.
struct TruthComparison {
    double mean_relative_error = 0;             // [-]
    double median_absolute_relative_error = 0;  // [-]
    double rmse = 0;                            // [-], of sigma [rad]
    std::optional<double> coverage68;           // share of truth inside the interval [-]
    std::optional<double> coverage95;           // [-]
};

struct MethodReport {
    std::string method;  // "direct", "diffuse", "photon"
    ReportMaps maps;
    CertaintyMaps certainty;
    double lobe_misfit = 1;              // see lobe_misfit_factor() [-]
    std::optional<ScaleEstimate> scale;  // of the lamps, where the capture did not state it
    std::vector<IterationLog> iterations;
    bool converged = false;
    double spectral_radius = 0;  // lambda of the last turn; 0: not known [-]
    std::optional<LevelComparison> heldout;
    std::optional<LevelComparison> used;
    std::optional<TruthComparison> truth_diffuse;
    std::optional<TruthComparison> truth_specular;
    std::optional<TruthComparison> truth_roughness;
    Image synthetic;  // of the shot in ObjectReport::real, 3 channels [radiance]; may be empty
    std::vector<StageTime> times;  // wall time of the stages
};

// Fig. 4(d), and where the lamps stand.
struct SelectionReport {
    std::vector<Light> lamps;         // all of the capture or rig
    std::vector<std::size_t> chosen;  // indices into lamps, in the order of choice
    std::vector<std::size_t> chosen_for_diffuse;
    std::vector<std::size_t> candidates;                // indices into lamps
    std::vector<std::pair<double, double>> shares;      // measurable (diffuse, specular) after each
    std::pair<double, double> share_with_all = {0, 0};  // (diffuse, specular) [-]
    Vec3 object_center = Vec3::Zero();                  // [length]
    std::string length_unit = "m";
    std::vector<LampRule> rules;  // what other rules would choose; may be empty
};

struct ObjectReport {
    std::string name;   // short, for tables: "B"
    std::string title;  // "object B, a cat"
    std::optional<ReportMaps> truth;
    std::vector<MethodReport> methods;  // in the order in which they are shown
    std::optional<SelectionReport> selection;
    // Figure 5: where set, profiles of Pd over the rows of the texel domain are drawn, and this is
    // the row at which the two plates meet [rows].
    std::optional<double> profile_edge;
    // Figure 6: the image that the synthetic ones are compared with, 3 channels [radiance], and how
    // it was taken ("held-out lamp above the range finder, without sensor noise").
    Image real;
    std::string real_title;
    double white = 1;  // radiance of level 255: Table 1, Figure 6 [radiance]
};

struct ReportData {
    RunHeader run;
    std::vector<ObjectReport> objects;
    bool paper_experiments = true;  // show the paper's own figures beside ours (objects B and C)
    int max_picture_width = 640;    // larger pictures are reduced [pixels]; >= 16
};

// The page as UTF-8 text; the same data give the same bytes.
[[nodiscard]] std::string report_page(const ReportData& data);

// Written to a temporary name and renamed. Throws WorkFailed.
void write_report(const std::filesystem::path& path, const ReportData& data);

}  // namespace patina
