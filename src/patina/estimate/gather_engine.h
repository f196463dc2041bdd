// The indirect light of every look, by the gather graph: one sweep of light for each turn.
#pragma once

#include "patina/estimate/estimate.h"
#include "patina/estimate/indirect.h"
#include "patina/estimate/observations.h"
#include "patina/transport/gather_graph_file.h"
#include "patina/transport/gather_sweep.h"
#include "patina/transport/narrow_lobes.h"

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace patina {

// Of the photons for narrow lobes.
[[nodiscard]] NarrowLobeOptions narrow_lobe_options(const EstimateOptions& options);

// Per camera, towards it from the texels that it sees.
[[nodiscard]] std::vector<ViewDirections> view_directions(const SceneView& scene);

class GatherEngine final : public IndirectEngine {
  public:
    // Reads the graph from options.graph_file, or traces it and begins to write it there.
    // kept_blocks: so many blocks of lamps keep what is known of them at the hits, those that turn
    // first; the others compute it again in each turn.
    GatherEngine(const Surface& surface,
                 const TexelAtlas& atlas,
                 const SceneView& scene,
                 const EstimateOptions& options,
                 Progress& progress,
                 std::size_t kept_blocks = std::numeric_limits<std::size_t>::max());

    // One more bounce under the present maps, what narrow lobes send on of the lamps by photons
    // (light.retraced: they were traced for it). light.spectral_radius: how much of the indirect
    // light's last change the next one keeps (power iteration); 0 at first.
    [[nodiscard]] IndirectLight evaluate(std::span<const Reflectance> maps,
                                         std::span<const std::uint8_t> seen,
                                         bool with_specular) override;
    // The same into the memory of `light`, whose contents are lost. settled: what counts as
    // measured does not change any more, and light and maps hardly. Then, where light fades slowly,
    // a sweep may go up to twenty times as far as a plain one, whose ratio of changes stands.
    void evaluate(std::span<const Reflectance> maps,
                  std::span<const std::uint8_t> seen,
                  bool with_specular,
                  IndirectLight& light,
                  bool settled = false);

    // Waits until options.graph_file holds the graph; a disk that refuses is only warned about.
    void finish_graph_file(Progress& progress) { kept_graph_.finish(progress); }

    // Forgets the light of earlier sweeps, not the graph.
    void restart();

  private:
    // Which lane of which block a lamp of a lamp set has.
    struct LampPlace {
        std::size_t block = 0;
        std::size_t lane = 0;
        Rgbf color = Rgbf::Zero();
    };

    // mean: of the irradiance of all lamps, per texel. Fills in what the light says of its change.
    // leapt: the sweep took more than a plain step.
    void compare_with_last(std::vector<double> mean, bool leapt, IndirectLight& light);
    // How many times as far as a plain one the next sweep goes.
    [[nodiscard]] float next_step(bool settled);
    // The light of one block's lamps, to the lamp sets that they belong to.
    void add_irradiance(std::size_t block,
                        const std::array<IndirectLanes, 2>& halves,
                        TexelTable<IndirectIrradiance>& sums) const;
    void add_photons(std::size_t block,
                     std::span<const Reflectance> maps,
                     std::span<const std::uint8_t> wanted,
                     IndirectLight& light);
    void add_lobes(std::size_t block,
                   const RadiantTexels& texels,
                   std::span<const Reflectance> maps,
                   std::span<const std::uint8_t> wanted,
                   TexelTable<IndirectLobe>& sum) const;

    const TexelAtlas& atlas_;
    const SceneView& scene_;
    std::vector<ViewDirections> views_;  // per camera view; zero where it sees nothing
    KeptGatherGraph kept_graph_;
    const GatherGraph& graph_;
    SurfaceFilter filter_;
    std::vector<LampBlockLight>
        blocks_;  // first those of lamps that stand, then of those that turn
    std::vector<std::vector<LampPlace>> places_;  // per lamp set, per lamp
    SweptLight swept_;
    std::optional<NarrowLobes> narrow_;
    std::vector<double> previous_;     // mean indirect light of the texels, last sweep
    std::vector<double> last_change_;  // of it, by the last sweep; 0 if that leapt
    double spectral_radius_ = 0;       // as last told
    double kept_share_ = 0;    // of the last change but one, along it, in the last; 0: not known
    int num_plain_ = 0;        // plain sweeps in a row under settled maps
    double plain_change_ = 0;  // of the light, by the last plain sweep
    // The same before the last leap: one that does not lead to smaller changes is the last.
    double change_before_leap_ = std::numeric_limits<double>::infinity();
};

}  // namespace patina
