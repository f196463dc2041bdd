// The choice of lamps at the size of the project's goal: 60 candidates, 262 144 texels. First the
// whole (views, shadows, looks, choice, comparison), with a sample of the texels and with all, then
// the choice of 16 lamps alone.
#include "patina/plan/lamp_orders.h"
#include "patina/plan/lamp_study.h"
#include "patina/plan/planned_looks.h"
#include "patina/scan/scanner.h"

#include <benchmark/benchmark.h>

namespace patina {
namespace {

constexpr int kSide = 512;
constexpr std::size_t kPicks = 16;

const Capture& rig() {
    static const Capture rig = [] {
        ScanOptions scan;
        scan.columns = kSide;
        scan.rows = kSide;
        return simulate_rig(make_object(ObjectKind::b, kSide, kSide), scan);
    }();
    return rig;
}

// Argument: texels that information is summed over; 0: all.
void plan_whole(benchmark::State& state) {
    const Capture& capture = rig();
    StudyOptions options;
    options.max_texels = int(state.range(0));
    LampStudy study;
    for (auto _ : state) {
        Progress progress;
        study = study_lamps(capture, {}, options, progress);
        benchmark::DoNotOptimize(study);
    }
    state.counters["texels"] = double(capture.atlas.texels.size());
    state.counters["lamps"] = double(study.plan.chosen.size());
    state.counters["known_%"] = 100 * study.worth.back().known;
}
BENCHMARK(plan_whole)->Arg(1 << 14)->Arg(0)->Unit(benchmark::kSecond)->UseRealTime()->Iterations(1);

void choose_lamps(benchmark::State& state) {
    Progress progress;
    const SupposedSurface surface{SurfacePrior{}};
    PlannedLooksOptions looks_options;
    looks_options.max_texels = std::size_t(state.range(0));
    const PlannedLooks looks =
        collect_planned_looks(RigView(rig(), progress), {}, looks_options, progress);
    std::vector<LookGradients> lamps;
    for (const LookTable& table : looks.candidates) {
        lamps.push_back(look_gradients(table, surface, LookNoise{1e-7, 2e-5}));
    }
    GreedyOptions options;
    options.max_picks = kPicks;
    GreedyPicks picks;
    for (auto _ : state) {
        picks = choose_by_information(Knowledge(surface, looks.texels.ids.size()), lamps, options);
        benchmark::DoNotOptimize(picks);
    }
    state.counters["evaluations"] = double(picks.num_evaluations);
}
BENCHMARK(choose_lamps)->Arg(1 << 14)->Arg(0)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace patina
