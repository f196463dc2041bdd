// A channel of plates with lobes of different widths, of which some are narrow.
#pragma once

#include "patina/transport/narrow_lobes.h"

#include "support/channel.h"
#include "support/gathered_light.h"
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patina {

inline constexpr std::size_t kNumPlates = 3;
inline constexpr int kFine = 2;  // texels along a side of one of Channel's

// sigma of the plates: by the sweeps, by photons, and by both.
inline constexpr std::array<double, kNumPlates> kRoughness = {0.2, 0.05, 0.12};
inline constexpr double kLobeAlbedo = 0.3;  // 2 sigma^2 Ps, at normal incidence

// The channel in finer texels, its plates black but for their lobes, so that what they send on of
// the lamps is all light, and every texel of it counts.
struct NarrowChannel : Channel {
    // widest: the lamps turn with a scanner that stands at azimuths from -widest to +widest for the
    // floor's columns, and at either end for the walls; 0: they stand still [rad].
    explicit NarrowChannel(double widest = 0) {
        atlas = build_atlas(scene.mesh, kFine * 3 * kPitch, kFine * kSide);
        if (widest > 0) {
            for (Light& light : scene.lights) light.frame = FrameOfReference::scanner;
            for (Texel& texel : atlas.texels) {
                const double share = (texel.column + 0.5) / (kFine * kSide);
                // The left wall follows the floor, and the right one that.
                texel.azimuth = share < 1 ? (2 * share - 1) * widest : share < 2 ? -widest : widest;
            }
        }
        direct.clear();
        for (const Light& light : scene.lights) {
            direct.push_back(direct_light(scene.surface(), atlas, light));
        }
        maps.clear();
        for (TexelId texel = 0; texel < atlas.texels.size(); ++texel) {
            const auto plate = std::size_t(atlas.texels[texel].column / (kFine * kPitch));
            plates[plate].push_back(texel);
            const double sigma = kRoughness[plate];
            maps.push_back({Rgb::Zero(), kLobeAlbedo / (2 * square(sigma)), sigma});
        }
    }
    [[nodiscard]] LampBlock lamps() const { return lamp_block(scene.lights, direct); }
    // Photons that count for the texel alone that they reach.
    [[nodiscard]] NarrowLobes narrow_lobes(std::uint64_t seed) const {
        NarrowLobeOptions options;
        options.seed = seed;
        options.kernel_radius = 0.5;
        return {scene.surface(), atlas, {lamps()}, options};
    }
    // What sweeps of independent rays bring in one bounce, but for what is left out of the images.
    [[nodiscard]] SweptLight swept(const GatherGraph& graph,
                                   std::span<const float> left_out) const {
        const bool turning = scene.lights.front().frame == FrameOfReference::scanner;
        LampBlockLight light(scene.surface(), atlas, graph, lamps(), turning);
        SweptLight result;
        light.sweep(graph,
                    RadiantTexels(atlas, maps, true, left_out),
                    no_filter(atlas.texels.size()),
                    result);
        return result;
    }
    [[nodiscard]] GatherGraph graph(std::uint64_t seed) const {
        GatherOptions options;
        options.rays = 16;
        options.seed = seed;
        Progress progress;
        return trace_gather_graph(scene.surface(), atlas, {}, options, progress);
    }
    [[nodiscard]] double swept_mean(const std::vector<TexelId>& patch,
                                    const SweptLight& light) const {
        return mean_over(patch, [&](TexelId texel) {
            return sum_of({light.halves[0][texel][0], light.halves[1][texel][0]});
        });
    }
    [[nodiscard]] double photon_mean(const std::vector<TexelId>& patch,
                                     const NarrowLobes::Irradiance& light) const {
        return mean_over(patch, [&](TexelId texel) { return sum_of(light[texel]); });
    }
    // In the mean over the channels, of all lamps together.
    [[nodiscard]] double sum_of(const std::array<Lanes, 2>& halves) const {
        double sum = 0;
        for (std::size_t lamp = 0; lamp < scene.lights.size(); ++lamp) {
            const double strength = lamp_color(scene.lights[lamp]).maxCoeff();
            sum += strength * 0.5 * double(halves[0][lamp] + halves[1][lamp]);
        }
        return sum;
    }
    // Light that is computed for the centres of texels where it starts and as a mean over them
    // where it arrives errs twice (texel_centre_bias()).
    [[nodiscard]] static double bias(double sigma) {
        return 2 * texel_centre_bias(1.0 / (kFine * kSide), sigma, 0.7);
    }

    std::array<std::vector<TexelId>, kNumPlates> plates;
};

}  // namespace patina
