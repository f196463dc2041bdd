// Lamps gathered over one graph, as tests look at them.
#pragma once

#include "patina/transport/gather_sweep.h"

#include <array>
#include <cstddef>
#include <numeric>
#include <vector>

namespace patina {

// A filter that leaves every value alone.
[[nodiscard]] inline SurfaceFilter no_filter(std::size_t num_texels) {
    SurfaceFilter filter;
    filter.begin.resize(num_texels + 1);
    std::iota(filter.begin.begin(), filter.begin.end(), std::size_t(0));
    filter.texel.resize(num_texels);
    std::iota(filter.texel.begin(), filter.texel.end(), TexelId(0));
    filter.weight.assign(num_texels, 1.0f);
    return filter;
}

[[nodiscard]] inline LampBlock lamp_block(const std::vector<Light>& lights,
                                          const std::vector<LargeVector<DirectLight>>& direct) {
    LampBlock block;
    for (const Light& light : lights) block.lights.push_back(&light);
    for (const auto& lamp : direct) block.direct.push_back(&lamp);
    return block;
}

// Unfiltered light of one block of grey lamps.
class GatheredLight {
  public:
    // views: per camera; see trace_gather_graph().
    GatheredLight(const Surface& surface,
                  const TexelAtlas& atlas,
                  LampBlock lamps,
                  std::span<const Reflectance> maps,
                  const GatherOptions& options,
                  std::span<const ViewDirections> views = {},
                  bool turning = false)
        : graph_([&] {
              Progress progress;
              return trace_gather_graph(surface, atlas, views, options, progress);
          }()),
          texels_(atlas, maps, true),
          filter_(no_filter(atlas.texels.size())),
          light_(surface, atlas, graph_, std::move(lamps), turning) {}

    void sweep(int count) {
        for (int i = 0; i < count; ++i) light_.sweep(graph_, texels_, filter_, swept_);
    }

    [[nodiscard]] const GatherGraph& graph() const { return graph_; }
    [[nodiscard]] const std::array<IndirectLanes, 2>& halves() const { return swept_.halves; }
    // Of all lamps together, of one half of the rays and of both, in the mean over the channels.
    [[nodiscard]] double half(std::size_t half, TexelId texel) const {
        return sum(swept_.halves[half][texel]);
    }
    [[nodiscard]] double irradiance(TexelId texel) const {
        return 0.5 * (half(0, texel) + half(1, texel));
    }
    // Through lobes half, once and twice as wide as sigma [rad].
    [[nodiscard]] std::array<double, 3> lobe(TexelId texel, const Vec3f& w_v, double sigma) const {
        const LampBlockLight::LobeLanes lanes =
            light_.lobe(graph_, 0, texels_, swept_, texel, w_v, sigma);
        return {sum(lanes.half), sum(lanes.same), sum(lanes.twice)};
    }

  private:
    [[nodiscard]] double sum(const std::array<Lanes, 3>& lanes) const {
        double total = 0;
        for (std::size_t lamp = 0; lamp < light_.lamps().size(); ++lamp) {
            const double strength = lamp_color(*light_.lamps().lights[lamp]).maxCoeff();
            for (const Lanes& channel : lanes) total += strength * double(channel[lamp]) / 3;
        }
        return total;
    }

    GatherGraph graph_;
    RadiantTexels texels_;
    SurfaceFilter filter_;
    LampBlockLight light_;
    SweptLight swept_;
};

}  // namespace patina
