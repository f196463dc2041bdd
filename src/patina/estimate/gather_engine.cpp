#include "patina/estimate/gather_engine.h"

#include "patina/base/parallel.h"

#include <algorithm>
#include <limits>
#include <map>

namespace patina {
namespace {

// Texels with less specular albedo than this do not show indirect light by their lobe.
constexpr double kNegligibleLobe = 1e-5;
// Change of all light by rounding what is sent on, relative: 2^-11 of each of about a hundred hits,
// evenly spread, which is 3e-5, and room for those of few hits.
constexpr double kRounding = 3e-4;
// Where the maps have settled, light of whose change the next sweep keeps more than this is carried
// on at once to where the sweeps lead, as if they kept at most so much. After so many plain sweeps,
// of which the last two tell that share.
constexpr double kLongBounces = 0.8;
constexpr double kMostKept = 0.95;
constexpr int kPlainSweeps = 3;

GatherOptions seeded_gather_options(const EstimateOptions& options) {
    GatherOptions gather = options.gather;
    gather.seed = options.photons.seed;
    return gather;
}

}  // namespace

NarrowLobeOptions narrow_lobe_options(const EstimateOptions& options) {
    NarrowLobeOptions narrow;
    narrow.max_photons = options.photons.photons;
    narrow.seed = options.photons.seed;
    return narrow;
}

// Whether a lamp shines on a texel does not count: the graph is the same for all lamps.
std::vector<ViewDirections> view_directions(const SceneView& scene) {
    std::vector<ViewDirections> directions;
    for (const std::vector<TexelView>& views : scene.views) {
        ViewDirections& towards = directions.emplace_back(views.size(), Vec3f::Zero());
        for (std::size_t i = 0; i < views.size(); ++i) {
            if (views[i].state != ViewState::hidden) towards[i] = views[i].w_v;
        }
    }
    return directions;
}

GatherEngine::GatherEngine(const Surface& surface,
                           const TexelAtlas& atlas,
                           const SceneView& scene,
                           const EstimateOptions& options,
                           Progress& progress,
                           std::size_t kept_blocks)
    : atlas_(atlas),
      scene_(scene),
      views_(view_directions(scene)),
      kept_graph_(
          options.graph_file, surface, atlas, views_, seeded_gather_options(options), progress),
      graph_(kept_graph_.graph()) {
    progress.begin_stage("light at the hits");
    filter_ = build_surface_filter(atlas, options.filter_radius);

    // Every lamp has one lane, however many sets it shines in. Lamps that turn and lamps that stand
    // do not share a block.
    std::vector<LampBlock> blocks[2];
    std::map<std::size_t, std::pair<std::size_t, std::size_t>> lane_of;
    for (std::size_t light = 0; light < scene.direct.size(); ++light) {
        if (scene.direct[light].empty()) continue;
        const Light& lamp = *scene.lights[light];
        const std::size_t turning = lamp.frame == FrameOfReference::scanner ? 1 : 0;
        if (blocks[turning].empty() || blocks[turning].back().size() == kLampLanes) {
            blocks[turning].emplace_back();
        }
        LampBlock& block = blocks[turning].back();
        lane_of[light] = {2 * (blocks[turning].size() - 1) + turning, block.size()};
        block.lights.push_back(&lamp);
        block.direct.push_back(&scene.direct[light]);
    }
    const std::size_t num_standing = blocks[0].size();
    const std::size_t num_turning = blocks[1].size();
    std::vector<LampBlock> all_blocks = blocks[0];
    all_blocks.insert(all_blocks.end(), blocks[1].begin(), blocks[1].end());
    narrow_.emplace(surface, atlas, std::move(all_blocks), narrow_lobe_options(options));
    for (const std::size_t turning : {0u, 1u}) {
        // Those that turn take shadow rays, so they are the first to be kept.
        const std::size_t num_before = turning == 1 ? 0 : num_turning;
        for (std::size_t k = 0; k < blocks[turning].size(); ++k) {
            const bool keeps_hits = num_before + k < kept_blocks;
            blocks_.emplace_back(
                surface, atlas, graph_, std::move(blocks[turning][k]), turning == 1, keeps_hits);
        }
    }
    for (const LampSet& set : scene.lamp_sets) {
        std::vector<LampPlace>& places = places_.emplace_back();
        for (const std::size_t light : set.indices) {
            const auto [block, lane] = lane_of.at(light);
            places.push_back({block / 2 + (block % 2 == 1 ? num_standing : 0),
                              lane,
                              lamp_color(*scene.lights[light]).cast<float>()});
        }
    }
    progress.end_stage();
}

void GatherEngine::add_irradiance(std::size_t block,
                                  const std::array<IndirectLanes, 2>& halves,
                                  TexelTable<IndirectIrradiance>& sums) const {
    struct Share {
        const LampPlace* place;
        std::size_t set;
    };
    std::vector<Share> shares;
    for (std::size_t set = 0; set < places_.size(); ++set) {
        for (const LampPlace& place : places_[set]) {
            if (place.block != block) continue;
            shares.push_back({&place, set});
        }
    }
    parallel_for(atlas_.texels.size(), [&](std::size_t i) {
        const std::span<IndirectIrradiance> of_texel = sums.of(i);
        for (std::size_t half = 0; half < 2; ++half) {
            const auto& lanes = halves[half][i];
            for (const Share& share : shares) {
                const std::size_t lane = share.place->lane;
                of_texel[share.set].halves[half] +=
                    share.place->color * Rgbf(lanes[0][lane], lanes[1][lane], lanes[2][lane]);
            }
        }
    });
}

void GatherEngine::add_lobes(std::size_t block,
                             const RadiantTexels& texels,
                             std::span<const Reflectance> maps,
                             std::span<const std::uint8_t> wanted,
                             TexelTable<IndirectLobe>& sum) const {
    struct Share {
        const LampPlace* place;
        std::size_t shot;
    };
    std::vector<std::vector<Share>> shares(views_.size());
    for (std::size_t shot = 0; shot < sum.columns(); ++shot) {
        for (const LampPlace& place : places_[scene_.lamp_set_of_shot[shot]]) {
            if (place.block != block) continue;
            shares[scene_.camera_of_shot[shot]].push_back({&place, shot});
        }
    }
    parallel_for(atlas_.texels.size(), [&](std::size_t i) {
        if (wanted[i] == 0) return;
        const std::span<IndirectLobe> of_texel = sum.of(i);
        for (std::size_t view = 0; view < views_.size(); ++view) {
            if (shares[view].empty() || !(views_[view][i].squaredNorm() > 0)) continue;
            const LampBlockLight::LobeLanes lanes = blocks_[block].lobe(
                graph_, view, texels, swept_, TexelId(i), views_[view][i], maps[i].roughness);
            for (const Share& share : shares[view]) {
                const std::size_t lane = share.place->lane;
                const auto light = [&](const std::array<Lanes, 3>& channels) {
                    const Rgbf lamp(channels[0][lane], channels[1][lane], channels[2][lane]);
                    return Rgbf(share.place->color * lamp);
                };
                IndirectLobe& lobe = of_texel[share.shot];
                lobe.half += light(lanes.half);
                lobe.same += light(lanes.same);
                lobe.twice += light(lanes.twice);
            }
        }
    });
}

// After the block's sweep.
void GatherEngine::add_photons(std::size_t block,
                               std::span<const Reflectance> maps,
                               std::span<const std::uint8_t> wanted,
                               IndirectLight& light) {
    blocks_[block].add(narrow_->irradiance(block), swept_);
    for (std::size_t shot = 0; shot < light.lobe.columns(); ++shot) {
        const std::size_t view = scene_.camera_of_shot[shot];
        for (const LampPlace& place : places_[scene_.lamp_set_of_shot[shot]]) {
            if (place.block != block) continue;
            narrow_->add_lobe(
                block, place.lane, views_[view], maps, wanted, lobe_column(light.lobe, shot));
        }
    }
}

IndirectLight GatherEngine::evaluate(std::span<const Reflectance> maps,
                                     std::span<const std::uint8_t> seen,
                                     bool with_specular) {
    IndirectLight light;
    evaluate(maps, seen, with_specular, light);
    return light;
}

void GatherEngine::evaluate(std::span<const Reflectance> maps,
                            std::span<const std::uint8_t> seen,
                            bool with_specular,
                            IndirectLight& light,
                            bool settled) {
    const std::size_t num_texels = atlas_.texels.size();
    light.retraced = with_specular && narrow_->follow(maps);
    const std::span<const float> by_photons =
        with_specular ? narrow_->shares() : std::span<const float>();
    const RadiantTexels texels(atlas_, maps, with_specular, by_photons);
    light.irradiance.reset(num_texels, places_.size());
    light.lobe.reset(num_texels, with_specular ? scene_.shots.size() : 0);
    std::vector<std::uint8_t> glossy(num_texels);
    if (with_specular) {
        parallel_for(num_texels, [&](std::size_t i) {
            glossy[i] =
                seen[i] != 0 && 2 * square(maps[i].roughness) * maps[i].specular > kNegligibleLobe;
        });
    }
    // What photons bring is not among what a sweep gathers, so that the step would be wrong.
    const float step = next_step(settled && by_photons.empty());
    std::vector<double> mean(num_texels, 0.0);
    for (std::size_t block = 0; block < blocks_.size(); ++block) {
        blocks_[block].sweep(graph_, texels, filter_, swept_, step);
        if (!by_photons.empty()) add_photons(block, maps, glossy, light);
        add_irradiance(block, swept_.halves, light.irradiance);
        if (with_specular) add_lobes(block, texels, maps, glossy, light.lobe);
        blocks_[block].end_sweep();
        parallel_for(mean.size(), [&](std::size_t i) {
            for (const IndirectLanes& half : swept_.halves) {
                for (const Lanes& channel : half[i]) {
                    for (std::size_t l = 0; l < kLampLanes; ++l) mean[i] += double(channel[l]);
                }
            }
        });
    }
    light.hidden = graph_.backs_over_fronts;
    compare_with_last(std::move(mean), step > 1, light);
}

// Aitken's step: Anderson acceleration of depth one with the coefficient of the sweep before.
float GatherEngine::next_step(bool settled) {
    const bool leaps = settled && num_plain_ >= kPlainSweeps && kept_share_ > kLongBounces &&
                       kept_share_ < 1 && plain_change_ < change_before_leap_;
    if (leaps) change_before_leap_ = plain_change_;
    num_plain_ = settled && !leaps ? num_plain_ + 1 : 0;
    return leaps ? float(1 / (1 - std::min(kept_share_, kMostKept))) : 1.0f;
}

void GatherEngine::restart() {
    for (LampBlockLight& block : blocks_) block.restart();
    narrow_->forget();
    previous_.clear();
    last_change_.clear();
    spectral_radius_ = kept_share_ = 0;
    plain_change_ = 0;
    change_before_leap_ = std::numeric_limits<double>::infinity();
    num_plain_ = 0;
}

void GatherEngine::compare_with_last(std::vector<double> mean, bool leapt, IndirectLight& light) {
    const bool is_first = previous_.empty();
    previous_.resize(mean.size(), 0.0);
    last_change_.resize(mean.size(), 0.0);
    // Of this change and the last one, per texel.
    struct Products {
        double this_this = 0, this_last = 0, last_last = 0;
        Products& operator+=(const Products& other) {
            this_this += other.this_this;
            this_last += other.this_last;
            last_last += other.last_last;
            return *this;
        }
    };
    const Products products = ordered_reduce(mean.size(), Products(), [&](std::size_t i) {
        const double now = mean[i] - previous_[i];
        return Products{square(now), now * last_change_[i], square(last_change_[i])};
    });
    const double size =
        std::sqrt(ordered_reduce(mean.size(), 0.0, [&](std::size_t i) { return square(mean[i]); }));
    // Changes near what rounding to 16 bits changes say nothing: the last ratio before stands.
    kept_share_ = 0;
    if (!is_first && !leapt && std::sqrt(products.last_last) > kRounding * size) {
        spectral_radius_ =
            std::min(1.0, std::sqrt(products.this_this) / std::sqrt(products.last_last));
        kept_share_ = products.this_last / products.last_last;
    }
    // The first light is no change, and a leap is none that a plain sweep would make.
    parallel_for(mean.size(), [&](std::size_t i) {
        last_change_[i] = is_first || leapt ? 0.0 : mean[i] - previous_[i];
    });
    previous_ = std::move(mean);
    const double change = std::sqrt(products.this_this);
    if (!leapt) plain_change_ = change;
    light.spectral_radius = spectral_radius_;
    light.change =
        is_first ? std::numeric_limits<double>::infinity() : (size > 0 ? change / size : 0.0);
}

}  // namespace patina
