#include "patina/pipeline/simulate_object.h"

#include "patina/base/output_file.h"
#include "patina/pipeline/text_table.h"
#include "patina/plan/greedy_cover.h"

#include <fmt/format.h>

#include <charconv>
#include <numeric>

namespace patina {
namespace {

namespace fs = std::filesystem;

constexpr int kDefaultColumns = 128;
constexpr int kDefaultRows = 80;
constexpr int kDefaultSamples = 64;

// A whole number that ends where `text` does.
bool parse_count(const std::string& text, int& value) {
    const auto [stop, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    return !text.empty() && code == std::errc() && stop == text.data() + text.size();
}

std::vector<std::size_t> choose_lamps(const SimulatedObject& object,
                                      const SimulateOptions& options,
                                      Progress& progress) {
    if (options.lights == "plan") {
        const Capture rig = simulate_rig(object, options.scan);
        return plan_lights(rig, CoverOptions{}, progress).chosen;
    }
    std::vector<std::size_t> lamps;
    if (options.lights == "all") {
        lamps.resize(kNumCandidates);
        std::iota(lamps.begin(), lamps.end(), std::size_t(0));
        return lamps;
    }
    std::size_t begin = 0;
    while (begin <= options.lights.size()) {
        const std::size_t end = std::min(options.lights.find(',', begin), options.lights.size());
        int lamp = 0;
        if (!parse_count(options.lights.substr(begin, end - begin), lamp) || lamp < 0) {
            throw Error("--lights",
                        "",
                        "is " + quote(options.lights),
                        "plan, all, or numbers of lamps with commas between");
        }
        lamps.push_back(std::size_t(lamp));
        begin = end + 1;
    }
    return lamps;
}

}  // namespace

SimulateOptions::SimulateOptions() {
    scan.columns = kDefaultColumns;
    scan.rows = kDefaultRows;
    scan.samples_per_pixel = kDefaultSamples;
}

OptionTable simulate_option_table(SimulateOptions& options) {
    ScanOptions& scan = options.scan;
    return {
        text_option("lights",
                    "plan|all|N,N",
                    options.lights,
                    "lamps to take: as 'patina plan' chooses, all, or numbers of candidates"),
        size_option(
            "texels", scan.columns, scan.rows, "8 or more each", "size of the maps and images"),
        integer_option(
            "samples", scan.samples_per_pixel, between(1, 1 << 20), "paths for each pixel"),
        integer_option("heldout_samples",
                       scan.heldout_sample_factor,
                       between(1, 1 << 10),
                       "the held-out image has this many times as many, more where it is noisy"),
        number_option("noise_read",
                      scan.noise_read,
                      at_least(0),
                      "",
                      "standard deviation of the sensor in darkness"),
        number_option(
            "noise_gain", scan.noise_gain, at_least(0), "", "variance of the sensor per signal"),
        number_option("misregistration",
                      scan.misregistration_pixels,
                      at_least(0),
                      "pixels",
                      "shift of the images against the geometry, one standard deviation"),
        number_option("lamp_error",
                      scan.lamp_position_error_m,
                      at_least(0),
                      "m",
                      "error of the lamps' positions, one standard deviation"),
        number_option("normal_error",
                      scan.normal_error_degrees,
                      between(0, 44),
                      "degrees",
                      "error of the normals, one standard deviation"),
        integer_option("bits",
                       scan.quantize_bits,
                       between(0, 16),
                       "8 or 16: PNG images of so many bits; 0: OpenEXR"),
    };
}

Json simulate_object(const std::string& object_name,
                     const fs::path& output,
                     const SimulateOptions& options,
                     Progress& progress) {
    validate(options.scan);
    const ObjectKind kind = object_kind_from_name(object_name);
    OutputFolder folder(output, "-o");
    progress.begin_stage("make object");
    const SimulatedObject object = make_object(kind, options.scan.columns, options.scan.rows);
    progress.end_stage(fmt::format("{}, {} triangles", object.name, object.mesh.triangles.size()));
    const std::vector<std::size_t> lamps = choose_lamps(object, options, progress);
    const CaptureDescription description =
        simulate_capture(object, lamps, options.scan, progress, folder.path());
    folder.commit();
    Json chosen = Json::list();
    for (const std::size_t lamp : lamps) chosen.push(Json(std::int64_t(lamp)));
    Json json = Json::object();
    json.set("name", Json(description.name));
    json.set("folder", Json(output.string()));
    json.set("lights", std::move(chosen));
    json.set("shots", Json(std::int64_t(description.shots.size())));
    return json;
}

std::string simulate_text(const Json& simulated) {
    std::string lamps;
    for (const Json& lamp : simulated.find("lights")->items) {
        lamps += (lamps.empty() ? "" : ", ") + fmt::format("{}", lamp.integer);
    }
    TextTable table({"", ""});
    table.add({"object", simulated.find("name")->text});
    table.add({"capture", simulated.find("folder")->text});
    table.add({"lamps", lamps});
    table.add({"shots", fmt::format("{}", simulated.find("shots")->integer)});
    return table.text();
}

}  // namespace patina
