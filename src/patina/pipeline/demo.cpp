#include "patina/pipeline/demo.h"

#include "patina/base/output_file.h"
#include "patina/pipeline/compare_result.h"
#include "patina/pipeline/estimate_capture.h"
#include "patina/pipeline/plan_output.h"
#include "patina/pipeline/version.h"
#include "patina/plan/lamp_study.h"
#include "patina/scan/scanner.h"

#include <fmt/format.h>

#include <array>

namespace patina {
namespace {

namespace fs = std::filesystem;

// How large everything is.
struct Scale {
    int columns;            // of the texel domains
    int plate_rows;         // object A, both plates together
    int figurine_rows;      // objects B and C
    int samples;            // paths per pixel of the captures
    int heldout_samples;    // of the held-out images, in the mean
    std::uint64_t photons;  // per lamp
    int compare_samples;    // of the synthetic images of used shots
    int compare_heldout;    // of the synthetic images of held-out shots, in the mean
};
// The paper's, and a quarter of its width and height.
constexpr Scale kFullScale = {512, 256, 256, 256, 1024, 2'000'000, 8, 512};
constexpr Scale kQuarterScale = {128, 64, 64, 64, 1024, 125'000, 8, 128};
// A lamp that makes less than this share of the texels measurable is not worth a photograph: about
// a dozen and a half of the 60 remain.
constexpr double kMinGain = 0.015;

constexpr std::array<ObjectKind, 3> kObjects = {ObjectKind::a, ObjectKind::b, ObjectKind::c};
constexpr std::array<const char*, 3> kObjectNames = {"A", "B", "C"};
constexpr std::array<Method, 4> kMethods = {
    Method::direct, Method::diffuse, Method::photon, Method::gather};

// Wall time of the stages that `after` has more than `before`.
std::vector<StageTime> times_since(const std::vector<StageTime>& before,
                                   const std::vector<StageTime>& after) {
    std::vector<StageTime> times;
    for (std::size_t i = 0; i < after.size(); ++i) {
        const double earlier = i < before.size() ? before[i].seconds : 0;
        if (after[i].seconds > earlier)
            times.push_back({after[i].stage, after[i].seconds - earlier});
    }
    return times;
}

std::optional<LevelComparison> levels_of(const std::optional<ImageComparison>& images) {
    if (!images) return std::nullopt;
    return LevelComparison{images->levels_mean, images->levels_variance, images->relative_rmse};
}

std::optional<TruthComparison> truth_of(const std::optional<MapComparison>& map) {
    if (!map) return std::nullopt;
    return TruthComparison{map->mean_relative_error,
                           map->median_absolute_relative_error,
                           map->rmse,
                           map->coverage68,
                           map->coverage95};
}

// The experiments on one object.
class Experiment {
  public:
    Experiment(std::size_t index,
               const Scale& scale,
               const DemoOptions& options,
               Progress& progress)
        : name_(kObjectNames[index]),
          kind_(kObjects[index]),
          scale_(scale),
          options_(options),
          progress_(progress) {
        scan_.columns = scale.columns;
        scan_.rows = kind_ == ObjectKind::a ? scale.plate_rows : scale.figurine_rows;
        scan_.samples_per_pixel = scale.samples;
        scan_.heldout_sample_factor = scale.heldout_samples / scale.samples;
        scan_.seed = options.seed;
    }

    // folder: of this object; exists.
    [[nodiscard]] ObjectReport run(const fs::path& folder) {
        progress_.begin_stage("make object");
        const SimulatedObject object = make_object(kind_, scan_.columns, scan_.rows);
        progress_.end_stage(
            fmt::format("{}, {} triangles", object.name, object.mesh.triangles.size()));
        report_.name = name_;
        report_.title = object.name;
        const std::vector<std::size_t> lamps = plan(object);
        const fs::path capture_folder = folder / "capture";
        fs::create_directories(capture_folder);
        simulate_capture(object, lamps, scan_, progress_, capture_folder);
        const Capture capture = load_capture(capture_folder);
        const TruthMaps truth = load_truth(capture.description);
        report_.truth = ReportMaps{truth.diffuse, truth.specular, truth.roughness, truth.mask};
        if (kind_ == ObjectKind::a) report_.profile_edge = 0.5 * scan_.rows;
        for (const Method method : kMethods) run_method(capture, method, folder);
        return std::move(report_);
    }

  private:
    std::vector<std::size_t> plan(const SimulatedObject& object) {
        const Capture rig = simulate_rig(object, scan_);
        StudyOptions study_options;
        study_options.rule = PlanRule::paper;
        study_options.cover.min_gain = kMinGain;
        study_options.num_next = 0;
        study_options.seed = options_.seed;
        const LampStudy study = study_lamps(rig, {}, study_options, progress_);
        report_.selection = selection_report(rig, study);
        return study.plan.chosen;
    }

    void run_method(const Capture& capture, Method method, const fs::path& folder) {
        EstimateOptions estimate_options;
        estimate_options.method = method;
        estimate_options.photons.photons = scale_.photons;
        estimate_options.photons.seed = options_.seed;
        progress_.note(fmt::format("object {}, method {}", name_, method_name(method)));
        const std::vector<StageTime> before = progress_.stage_times();
        const Estimate estimate = estimate_reflectance(capture, estimate_options, progress_);
        MethodReport report;
        report.times = times_since(before, progress_.stage_times());
        const Result result = make_result(capture, estimate_options, estimate);
        const fs::path result_folder = folder / method_name(method);
        fs::create_directories(result_folder);
        write_result(result_folder, result);

        report.method = method_name(method);
        report.maps = {
            result.maps.diffuse, result.maps.specular, result.maps.roughness, result.maps.status};
        report.certainty = {result.maps.diffuse_stderr,
                            result.maps.specular_stderr,
                            result.maps.roughness_stderr,
                            result.maps.measurability,
                            result.maps.reason};
        report.lobe_misfit = estimate.lobe_misfit;
        report.scale = estimate.scale;
        report.iterations = estimate.iterations;
        report.converged = estimate.converged;
        report.spectral_radius = estimate.iterations.back().spectral_radius;
        compare(capture, result.maps, result_folder, report);
        report_.methods.push_back(std::move(report));
    }

    void compare(const Capture& capture,
                 const ReflectanceMaps& maps,
                 const fs::path& result_folder,
                 MethodReport& report) {
        CompareOptions options;
        options.render.samples_per_pixel = scale_.compare_samples;
        options.render.seed = options_.seed;
        options.heldout_sample_factor = scale_.compare_heldout / scale_.compare_samples;
        options.keep_heldout = true;
        // One white for all methods: that of the first.
        if (!report_.methods.empty()) options.white = report_.white;
        Comparison comparison =
            compare_maps(capture, maps, result_folder.string(), options, progress_);
        report_.white = comparison.white;
        report.used = levels_of(comparison.shots);
        report.heldout = levels_of(comparison.heldout);
        if (comparison.truth) {
            report.truth_diffuse = truth_of(comparison.truth->diffuse);
            report.truth_specular = truth_of(comparison.truth->specular);
            report.truth_roughness = truth_of(comparison.truth->roughness);
        }
        for (ShotComparison& shot : comparison.per_shot) {
            if (!shot.images) continue;
            report.synthetic = std::move(shot.images->synthetic);
            report_.real = std::move(shot.images->real);
            report_.real_title = "held-out lamp above the range finder, without sensor noise";
        }
    }

    std::string name_;
    ObjectKind kind_;
    const Scale& scale_;
    const DemoOptions& options_;
    Progress& progress_;
    ScanOptions scan_;
    ObjectReport report_;
};

}  // namespace

OptionTable demo_option_table(DemoOptions& options) {
    return {
        with_letter(
            path_option("output", "DIR", options.output, "captures, results and report.html"), "o"),
        flag_option("full", options.full, "the paper's scale: below 40 minutes on 2 cores"),
    };
}

ReportData run_demo(const DemoOptions& options, Progress& progress) {
    const Scale& scale = options.full ? kFullScale : kQuarterScale;
    OutputFolder folder(options.output, "-o");
    ReportData report;
    report.run.title = "The paper's experiments";
    report.run.summary =
        "Simulated objects A, B and C: lamps chosen, captures rendered, maps estimated by the two "
        "conventional methods, the paper's and ours, and compared with images and truth.";
    report.run.command = options.full ? "patina demo --full" : "patina demo";
    report.run.version = program_version();
    report.run.seed = options.seed;
    report.run.settings = {
        {"texel columns", fmt::format("{}", scale.columns)},
        {"paths per pixel of the captures", fmt::format("{}", scale.samples)},
        {"photons per lamp", fmt::format("{}", scale.photons)},
    };
    for (std::size_t i = 0; i < kObjects.size(); ++i) {
        progress.note(fmt::format("object {}", kObjectNames[i]));
        const fs::path object_folder = folder.path() / kObjectNames[i];
        fs::create_directories(object_folder);
        report.objects.push_back(Experiment(i, scale, options, progress).run(object_folder));
    }
    write_report(folder.path() / "report.html", report);
    folder.commit();
    return report;
}

}  // namespace patina
