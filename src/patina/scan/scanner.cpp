#include "patina/scan/scanner.h"

#include "patina/base/check.h"
#include "patina/base/error.h"
#include "patina/scan/calibration_error.h"
#include "patina/scan/mesh_file.h"
#include "patina/scan/render.h"
#include "patina/scan/sensor.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

namespace patina {
namespace {

namespace fs = std::filesystem;

constexpr int kSmallestDomain = 8;  // texels per side; fewer have no inside to speak of
constexpr const char* kRangeFile = "range.exr";
constexpr const char* kMeshFile = "object.obj";
// The held-out lamp's number, after those of the candidates.
constexpr std::uint32_t kHeldoutNumber = kNumCandidates;
static_assert(kHeldoutNumber < kMaxLampNumber);

void require(bool is_right, const char* option, double value, const char* expected) {
    if (!is_right) throw Error(option, "", fmt::format("is {}", value), expected);
}

// Images of one camera under some lamps, ready to be written.
struct Exposures {
    std::size_t camera = 0;
    std::vector<std::uint32_t> lamps;  // numbers
    bool is_heldout = false;
};

class CaptureWriter {
  public:
    CaptureWriter(const SimulatedObject& object,
                  const ScanOptions& options,
                  Progress& progress,
                  const fs::path& folder,
                  CaptureDescription& description)
        : object_(object),
          options_(options),
          progress_(progress),
          folder_(folder),
          description_(description),
          rig_(make_rig(object, options.columns, options.rows)) {}

    // Renders and writes the images, and adds the shots. lights: of the lamps, indices into
    // description.lights.
    void take(const Exposures& exposures, const std::vector<std::size_t>& lights) {
        const int bits = exposures.is_heldout ? 0 : options_.quantize_bits;
        RenderOptions render;
        render.samples_per_pixel = options_.samples_per_pixel *
                                   (exposures.is_heldout ? options_.heldout_sample_factor : 1);
        render.adaptive = exposures.is_heldout;
        render.image_shift = image_shift(exposures.camera);
        render.seed = options_.seed;
        render.camera_index = std::uint32_t(exposures.camera);
        render.lamp_numbers = exposures.lamps;
        std::vector<Light> lamps;
        for (const std::uint32_t lamp : exposures.lamps) lamps.push_back(true_lamp(lamp));
        RenderedImages images =
            render_lamps(object_, description_.cameras[exposures.camera], lamps, render, progress_);

        const std::string camera = description_.cameras[exposures.camera].id;
        const std::string mask =
            fmt::format("images/{}_{}mask.png", camera, exposures.is_heldout ? "heldout_" : "");
        write_png(folder_ / mask, images.seen);
        for (std::size_t i = 0; i < lamps.size(); ++i) {
            Shot shot;
            shot.image =
                fmt::format("images/{}_{}.{}", camera, lamps[i].id, bits == 0 ? "exr" : "png");
            shot.camera = exposures.camera;
            shot.lights = {lights[i]};
            shot.exposure = sensor_exposure(bits);
            shot.mask = mask;
            shot.heldout = exposures.is_heldout;
            Image& image = images.radiance[i];
            for (float& value : image.data) value *= float(shot.exposure);
            if (!exposures.is_heldout) expose(exposures, i, images.seen, image);
            if (bits == 0) {
                write_exr(folder_ / shot.image, image);
            } else {
                write_png(folder_ / shot.image, image, bits);
            }
            description_.shots.push_back(shot);
        }
    }

    [[nodiscard]] std::uint64_t num_samples(std::size_t num_lamps, bool is_heldout) const {
        return std::uint64_t(options_.columns) * std::uint64_t(options_.rows) *
               std::uint64_t(options_.samples_per_pixel) * num_lamps *
               std::uint64_t(is_heldout ? options_.heldout_sample_factor : 1);
    }

  private:
    void expose(const Exposures& exposures, std::size_t i, const Image& seen, Image& image) const {
        const std::uint64_t stream =
            std::uint64_t(exposures.camera) * (kMaxLampNumber + 1) + exposures.lamps[i];
        add_noise({options_.noise_read, options_.noise_gain}, seen, options_.seed, stream, image);
    }

    // Where the lamp really stands, which the capture does not know.
    [[nodiscard]] Light true_lamp(std::uint32_t number) const {
        Light lamp = number == kHeldoutNumber ? rig_.heldout : rig_.candidates[number];
        Rng rng = calibration_rng(options_.seed, CalibrationError::lamp, number);
        for (double& coordinate : lamp.position) {
            coordinate += options_.lamp_position_error_m * rng.normal();
        }
        return lamp;
    }

    [[nodiscard]] Vec2 image_shift(std::size_t camera) const {
        Rng rng = calibration_rng(options_.seed, CalibrationError::registration, camera);
        const double across = rng.normal();
        const double along = rng.normal();
        return options_.misregistration_pixels * Vec2(across, along);
    }

    const SimulatedObject& object_;
    const ScanOptions& options_;
    Progress& progress_;
    const fs::path& folder_;
    CaptureDescription& description_;
    ScanRig rig_;
};

Light stated_lamp(Light lamp, const ScanOptions& options) {
    lamp.position_stddev = options.lamp_position_error_m;
    return lamp;
}

// Everything but lamps and shots.
CaptureDescription describe(const SimulatedObject& object,
                            const ScanRig& rig,
                            const ScanOptions& options) {
    CaptureDescription description;
    description.name = object.name;
    GeometrySource& geometry = description.geometry;
    if (object.range_frame) {
        geometry.range_file = kRangeFile;
        geometry.range_frame = *object.range_frame;
    } else {
        geometry.mesh_file = kMeshFile;
    }
    geometry.texel_width = options.columns;
    geometry.texel_height = options.rows;
    geometry.normal_stddev = radians(options.normal_error_degrees);
    geometry.registration_stddev = options.misregistration_pixels;
    description.cameras = rig.cameras;
    Radiometry& radiometry = description.radiometry;
    const double rounding = rounding_stddev(options.quantize_bits);
    radiometry.noise_read = std::hypot(options.noise_read, rounding);
    radiometry.noise_gain = options.noise_gain;
    radiometry.has_noise = radiometry.noise_read > 0 || radiometry.noise_gain > 0;
    return description;
}

void write_geometry(const SimulatedObject& object,
                    const ScanOptions& options,
                    const fs::path& folder) {
    const ScannedGeometry geometry = scan_geometry(object, options);
    if (object.range_frame) {
        write_exr(folder / kRangeFile, geometry.range);
    } else {
        write_obj(geometry.mesh, folder / kMeshFile);
    }
}

Truth write_truth(const SimulatedObject& object,
                  const ScanOptions& options,
                  const fs::path& folder) {
    const TruthMaps maps = truth_maps(object, options);
    const Truth truth{
        "truth/diffuse.exr", "truth/specular.exr", "truth/roughness.exr", "truth/mask.png"};
    write_exr(folder / truth.diffuse, maps.diffuse);
    write_exr(folder / truth.specular, maps.specular);
    write_exr(folder / truth.roughness, maps.roughness);
    write_png(folder / truth.mask, maps.mask);
    return truth;
}

void check_chosen(std::span<const std::size_t> chosen) {
    if (chosen.empty()) throw Error("--lights", "", "is empty", "at least one candidate lamp");
    std::set<std::size_t> seen;
    for (const std::size_t lamp : chosen) {
        if (lamp >= kNumCandidates || !seen.insert(lamp).second) {
            throw Error("--lights",
                        "",
                        fmt::format("has lamp {}", lamp),
                        fmt::format("different numbers below {}", kNumCandidates));
        }
    }
}

}  // namespace

void validate(const ScanOptions& options) {
    require(options.columns >= kSmallestDomain, "--texels", options.columns, "at least 8 columns");
    require(options.rows >= kSmallestDomain, "--texels", options.rows, "at least 8 rows");
    require(options.samples_per_pixel >= 1, "--samples", options.samples_per_pixel, "at least 1");
    require(options.heldout_sample_factor >= 1,
            "--heldout-samples",
            options.heldout_sample_factor,
            "at least 1");
    const auto not_negative = [](const char* option, double value) {
        require(value >= 0 && std::isfinite(value), option, value, "a number of at least 0");
    };
    not_negative("--noise-read", options.noise_read);
    not_negative("--noise-gain", options.noise_gain);
    not_negative("--misregistration", options.misregistration_pixels);
    not_negative("--lamp-error", options.lamp_position_error_m);
    not_negative("--normal-error", options.normal_error_degrees);
    require(options.normal_error_degrees < 45,
            "--normal-error",
            options.normal_error_degrees,
            "less than 45 degrees");
    const int bits = options.quantize_bits;
    require(bits == 0 || bits == 8 || bits == 16, "--bits", bits, "8, 16, or 0 for float images");
}

Capture simulate_rig(const SimulatedObject& object, const ScanOptions& options) {
    validate(options);
    const ScanRig rig = make_rig(object, options.columns, options.rows);
    Capture capture;
    capture.description = describe(object, rig, options);
    for (const Light& lamp : rig.candidates) {
        capture.description.lights.push_back(stated_lamp(lamp, options));
    }
    capture.mesh = scan_geometry(object, options).mesh;
    capture.atlas = build_atlas(capture.mesh, options.columns, options.rows);
    if (object.range_frame) set_scanner_columns(capture.atlas, *object.range_frame);
    return capture;
}

CaptureDescription simulate_capture(const SimulatedObject& object,
                                    std::span<const std::size_t> chosen,
                                    const ScanOptions& options,
                                    Progress& progress,
                                    const fs::path& folder) {
    validate(options);
    check_chosen(chosen);
    const ScanRig rig = make_rig(object, options.columns, options.rows);
    CaptureDescription description = describe(object, rig, options);
    description.folder = folder;
    description.file = folder / "capture.json";
    std::vector<std::uint32_t> lamps;
    std::vector<std::size_t> lights;
    for (const std::size_t lamp : chosen) {
        lights.push_back(description.lights.size());
        lamps.push_back(std::uint32_t(lamp));
        description.lights.push_back(stated_lamp(rig.candidates[lamp], options));
    }
    const std::size_t heldout = description.lights.size();
    description.lights.push_back(stated_lamp(rig.heldout, options));

    fs::create_directories(folder / "images");
    fs::create_directories(folder / "truth");
    write_geometry(object, options, folder);
    description.truth = write_truth(object, options, folder);

    CaptureWriter writer(object, options, progress, folder, description);
    const std::size_t num_cameras = description.cameras.size();
    progress.begin_stage(
        "render",
        num_cameras * (writer.num_samples(lamps.size(), false) + writer.num_samples(1, true)),
        "samples");
    for (std::size_t camera = 0; camera < num_cameras; ++camera) {
        writer.take({camera, lamps, false}, lights);
        writer.take({camera, {kHeldoutNumber}, true}, {heldout});
    }
    progress.end_stage(fmt::format("{} shots of {}", description.shots.size(), object.name));
    write_capture_description(description, folder);
    return description;
}

}  // namespace patina
