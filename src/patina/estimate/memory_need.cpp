#include "patina/estimate/memory_need.h"

#include "patina/base/error.h"
#include "patina/base/process_memory.h"
#include "patina/estimate/gather_engine.h"
#include "patina/estimate/texel_turn.h"
#include "patina/transport/gather_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

namespace patina {
namespace {

// Maps, fits, fillings with their solver and what neighbours say: about 25 vectors of five doubles
// for each texel. The error budgets of the end take no more than these and a sweep, which has its
// memory given up by then.
constexpr double kTexelBytes = 1000;
// Neighbours of the atlas that a filter reaches for each square of its radius.
constexpr double kFilterTexels = 4;
// Radiance, its variance, and what the files of the image, its dark frame and its mask hold.
constexpr double kPixelBytes = 64;

std::string in_gibibytes(double bytes) { return fmt::format("{:.2f} GiB", bytes / kGibibyte); }

// What makes most of the need, as words on what would lower it.
std::string advice(const MemoryNeed& need) {
    struct Part {
        double bytes = 0;
        const char* words = nullptr;
    };
    const std::array parts = {
        Part{std::max(need.looks + need.light, need.images),
             "shots marked as held out, or fewer texels, lower it"},
        Part{need.graph + need.lanes, "fewer --gather-rays and --lobe-rays lower it"},
        Part{need.photons, "fewer --photons lower it"},
    };
    return std::max_element(parts.begin(),
                            parts.end(),
                            [](const Part& a, const Part& b) { return a.bytes < b.bytes; })
        ->words;
}

}  // namespace

MemoryCounts count_memory(const Capture& capture) {
    const CaptureDescription& description = capture.description;
    std::set<std::size_t> cameras;
    std::set<std::size_t> lamps;
    std::set<std::vector<std::size_t>> sets;
    MemoryCounts counts;
    counts.held = double(resident_memory_bytes());
    counts.texels = capture.atlas.texels.size();
    for (const Shot& shot : description.shots) {
        if (shot.heldout) continue;
        ++counts.shots;
        cameras.insert(shot.camera);
        lamps.insert(shot.lights.begin(), shot.lights.end());
        sets.insert(shot.lights);
        const Camera& camera = description.cameras[shot.camera];
        counts.image_pixels =
            std::max(counts.image_pixels, std::size_t(camera.width) * std::size_t(camera.height));
    }
    counts.cameras = cameras.size();
    counts.lamps = lamps.size();
    counts.lamp_sets = sets.size();
    const auto num_turning =
        std::size_t(std::count_if(lamps.begin(), lamps.end(), [&](std::size_t lamp) {
            return description.lights[lamp].frame == FrameOfReference::scanner;
        }));
    const auto blocks = [](std::size_t num_lamps) {
        return (num_lamps + kLampLanes - 1) / kLampLanes;
    };
    counts.turning_blocks = blocks(num_turning);
    counts.standing_lamps = lamps.size() - num_turning;
    counts.standing_blocks = blocks(counts.standing_lamps);
    counts.has_gradients = description.geometry.registration_stddev > 0;
    return counts;
}

MemoryCounts count_work(const Capture& capture,
                        const Surface& surface,
                        const SceneView& scene,
                        const EstimateOptions& options,
                        MemoryCounts counts) {
    counts.looks = count_looks(capture, scene, options.observations);
    counts.hits =
        expect_gather_hits(surface, capture.atlas, view_directions(scene), options.gather);
    counts.filter_radius = options.filter_radius;
    const double rays = double(counts.texels) * double(options.gather.rays);
    const double hit_share = rays > 0 ? counts.hits.irradiance.hits / rays : 0;
    const auto photons_of_lamp = [&](bool turning) {
        return NarrowLobes::expect_bytes(
            counts.texels, hit_share, turning, narrow_lobe_options(options));
    };
    counts.photons = double(counts.standing_lamps) * photons_of_lamp(false) +
                     double(counts.lamps - counts.standing_lamps) * photons_of_lamp(true);
    return counts;
}

MemoryNeed memory_need(const MemoryCounts& counts, std::size_t kept_blocks) {
    const auto texels = double(counts.texels);
    const auto views = double(counts.cameras);
    const auto shots = double(counts.shots);
    const double gradient = counts.has_gradients ? sizeof(SampleGradient) : 0;
    double hits = 0;
    double graph = 0;
    double largest_rows = 0;
    const auto count_rows = [&](const GatherHitCount::Rows& rows) {
        const double bytes = rows.hits * sizeof(GatherHit) + rows.glossy * sizeof(GlossyHit);
        hits += rows.hits;
        graph += bytes;
        largest_rows = std::max(largest_rows, bytes);
    };
    count_rows(counts.hits.irradiance);
    for (const GatherHitCount::Rows& rows : counts.hits.lobes) count_rows(rows);

    MemoryNeed need;
    need.views = texels * (views * (sizeof(TexelView) + sizeof(Vec3f)) +
                           double(counts.lamps) * sizeof(DirectLight));
    need.looks = double(counts.looks.rows) *
                     (sizeof(Observation) + sizeof(float) + sizeof(Rgbf) + gradient) +
                 double(counts.looks.terms) * sizeof(LampTerm);
    need.images = texels * shots * (sizeof(TexelSample) + gradient) +
                  kPixelBytes * double(kImagesAtOnce * counts.image_pixels);
    need.graph = graph + 2 * texels * (views + 1) * sizeof(std::size_t);
    need.tracing = 2 * largest_rows;
    // Blocks that turn are kept first. One that is not kept is there while it is worked on, and
    // one that turns is the larger.
    const std::size_t blocks = counts.turning_blocks + counts.standing_blocks;
    const std::size_t present = std::min(kept_blocks + 1, blocks);
    const std::size_t turning = std::min(present, counts.turning_blocks);
    constexpr double kSwept = sizeof(IndirectLanes::value_type);
    need.lanes = hits * (double(turning) * sizeof(TurningHit) +
                         double(present - turning) * sizeof(StandingHit)) +
                 texels * (double(counts.standing_blocks) * sizeof(LitTexel) +
                           double(blocks) * (sizeof(StandingRow) + kSwept));
    // Two halves, before and after the filter, and what second rays meet.
    const double sweep = 4 * kSwept + sizeof(OnwardRow);
    const double filter =
        kFilterTexels * square(counts.filter_radius) * (sizeof(TexelId) + sizeof(float)) +
        sizeof(std::size_t);
    need.light = texels * (2 * sizeof(Rgbf) * double(counts.lamp_sets) +
                           sizeof(IndirectLobe) * shots + sweep + filter);
    need.photons = counts.photons;
    need.texels = kTexelBytes * texels;
    need.peak = counts.held + need.views + need.looks +
                std::max({need.images,
                          need.graph + need.tracing,
                          need.graph + need.lanes + need.light + need.photons + need.texels});
    return need;
}

MemoryPlan plan_memory(const MemoryCounts& counts, double limit) {
    for (std::size_t kept = counts.turning_blocks + counts.standing_blocks + 1; kept-- > 0;) {
        const double peak = memory_need(counts, kept).peak;
        if (peak <= limit) return {peak, kept};
    }
    const MemoryNeed need = memory_need(counts, 0);
    // Before the looks and hits are counted, the need is known to be larger still.
    const std::string least = in_gibibytes(need.peak);
    throw Error("--memory",
                "",
                fmt::format("is {}, too little for this capture", in_gibibytes(limit)),
                (counts.looks.rows > 0 ? least + " or more; " : "more than " + least + "; ") +
                    advice(need));
}

std::string memory_words(const MemoryPlan& plan, const MemoryCounts& counts) {
    std::string words = "memory: about " + in_gibibytes(plan.peak);
    const std::size_t blocks = counts.turning_blocks + counts.standing_blocks;
    if (plan.kept_blocks < blocks) {
        words += fmt::format(
            "; light at the hits computed again in each turn for {} of {} blocks "
            "of lamps",
            blocks - plan.kept_blocks,
            blocks);
    }
    return words;
}

}  // namespace patina
