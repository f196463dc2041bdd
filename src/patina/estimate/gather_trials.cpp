#include "patina/estimate/gather_trials.h"

#include "patina/base/parallel.h"

#include <utility>

namespace patina {
namespace {

// Blocks along either side of the texel domain whose texels may share model errors. A block is to
// be larger than such errors reach; more than fifty of them still give a standard error to a tenth.
constexpr int kBlocksPerSide = 8;
// Turns before what all trials share is decided, from direct light alone and from trials before.
constexpr int kFirstTurns = 4;
constexpr int kFurtherTurns = 2;
constexpr int kMaxTrialTurns = 12;
// A texel with as many looks tells nothing: its Pd explains them.
constexpr std::size_t kFreeLooks = 3;

// Adds the costs of one texel's looks to those of its block, per set of lamps.
//
// Noise of the gathered light would count as misfit, less so the larger the factor, and draw it up.
// Hence products of the residuals under the two independent halves of the light, each with its own
// Pd: their mean holds no noise of either.
void add_costs(std::span<const FitRow> rows,
               std::span<const std::size_t> sets,
               std::span<const Rgb> differences,
               const Reflectance& reflectance,
               std::span<double> costs) {
    const std::size_t num_rows = rows.size();
    std::vector<Rgb> rest(num_rows);
    Rgb moments[2] = {Rgb::Zero(), Rgb::Zero()};
    Rgb squares[2] = {Rgb::Zero(), Rgb::Zero()};
    const auto irradiance = [&](std::size_t k, int half) -> Rgb {
        return (rows[k].irradiance + (half == 0 ? 0.5 : -0.5) * differences[k]) / kPi;
    };
    for (std::size_t k = 0; k < num_rows; ++k) {
        rest[k] = rows[k].radiance -
                  reflectance.specular * lobe_basis(rows[k], reflectance.roughness) / kPi;
        for (const int half : {0, 1}) {
            const Rgb h = irradiance(k, half);
            moments[half] += rows[k].weight * h * rest[k];
            squares[half] += rows[k].weight * h * h;
        }
    }
    for (std::size_t k = 0; k < num_rows; ++k) {
        Rgb product = rows[k].weight;
        for (const int half : {0, 1}) {
            const Rgb diffuse = (squares[half] > 0).select(moments[half] / squares[half], 0.0);
            product *= rest[k] - diffuse * irradiance(k, half);
        }
        costs[sets[k]] += product.sum();
    }
}

}  // namespace

GatherTrials::GatherTrials(GatherIteration& iteration,
                           GatherEngine& engine,
                           const TexelAtlas& atlas,
                           const SceneView& scene,
                           const Observations& observations,
                           Progress& progress,
                           std::function<void(double)> apply)
    : iteration_(iteration),
      engine_(engine),
      atlas_(atlas),
      scene_(scene),
      observations_(observations),
      progress_(progress),
      apply_(std::move(apply)) {}

void GatherTrials::settle(double x) {
    apply_(x);
    const int num_turns = num_turns_ == 0 ? kFirstTurns : kFurtherTurns;
    for (int turn = 0; turn < num_turns; ++turn) take_turn(false);
    iteration_.hold();
}

ProfileTrial GatherTrials::try_at(double x, double tolerance) {
    apply_(x);
    for (int turn = 0; turn < kMaxTrialTurns; ++turn) {
        if (take_turn(true) < tolerance) break;
    }
    ProfileTrial trial;
    trial.costs = costs();
    trial.clamped_share = double(iteration_.num_clamped()) / double(iteration_.maps().size());
    return trial;
}

double GatherTrials::take_turn(bool frozen) {
    ++num_turns_;
    progress_.advance(1);
    return iteration_.turn(engine_, frozen).change;
}

std::size_t GatherTrials::block_of(std::size_t texel) const {
    const Texel& place = atlas_.texels[texel];
    return std::size_t(place.row * kBlocksPerSide / atlas_.height * kBlocksPerSide +
                       place.column * kBlocksPerSide / atlas_.width);
}

std::vector<double> GatherTrials::costs() const {
    const std::size_t num_texels = atlas_.texels.size();
    const std::size_t num_sets = scene_.lamp_sets.size();
    const std::size_t num_costs = square(std::size_t(kBlocksPerSide)) * num_sets;
    std::vector<std::vector<double>> parts((num_texels + kParallelBlock - 1) / kParallelBlock);
    parallel_blocks(num_texels, kParallelBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<double>& part = parts[begin / kParallelBlock];
        part.assign(num_costs, 0.0);
        for (std::size_t i = begin; i < end; ++i) {
            add_texel(i, std::span(part).subspan(block_of(i) * num_sets, num_sets));
        }
    });
    std::vector<double> sums(num_costs, 0.0);
    for (const std::vector<double>& part : parts) {
        for (std::size_t i = 0; i < num_costs; ++i) sums[i] += part[i];
    }
    return sums;
}

void GatherTrials::add_texel(std::size_t texel, std::span<double> costs) const {
    const std::span<const Observation> looks = observations_.of(texel);
    if (looks.size() <= kFreeLooks) return;
    std::vector<FitRow> rows;
    iteration_.make_rows(texel, iteration_.light(), rows);
    std::vector<std::size_t> sets;
    std::vector<Rgb> differences;
    for (const Observation& look : looks) {
        sets.push_back(scene_.lamp_set_of_shot[look.shot]);
        differences.push_back(
            2 * iteration_.light().irradiance.of(texel)[sets.back()].half_difference());
    }
    add_costs(rows, sets, differences, iteration_.fits()[texel].reflectance, costs);
}

}  // namespace patina
