// The indirect light of every look, by photons that are traced once and weighted again.
#pragma once

#include "patina/estimate/estimate.h"
#include "patina/estimate/observations.h"
#include "patina/estimate/texel_table.h"
#include "patina/transport/ratio_kernel.h"

#include <limits>
#include <span>
#include <vector>

namespace patina {

// Indirect light under one set of maps. Empty: none is known of (method I).
struct IndirectLight {
    TexelTable<IndirectIrradiance> irradiance;  // per lamp set
    TexelTable<IndirectLobe> lobe;              // per used shot; empty: not wanted
    // Per texel, what gaps of the scan may hide, relative to the light [-]; empty: not known.
    std::vector<float> hidden;
    double spectral_radius = 0;  // lambda of the maps [-]
    // Of the irradiance since the last evaluation, relative [-]; +infinity: not known.
    double change = std::numeric_limits<double>::infinity();
    bool retraced = false;
};

// The lobes of one used shot.
[[nodiscard]] inline LobeColumn lobe_column(TexelTable<IndirectLobe>& lobe, std::size_t shot) {
    return {lobe.of(0).data() + shot, lobe.columns()};
}

// How methods II, photon and gather find it.
class IndirectEngine {
  public:
    IndirectEngine() = default;
    IndirectEngine(const IndirectEngine&) = delete;
    IndirectEngine& operator=(const IndirectEngine&) = delete;
    virtual ~IndirectEngine() = default;

    // with_specular: whether surfaces reflect light on, and show it, by their lobes too, or by
    // their diffuse part alone (method II). seen: per texel, whether its lobe is looked at.
    [[nodiscard]] virtual IndirectLight evaluate(std::span<const Reflectance> maps,
                                                 std::span<const std::uint8_t> seen,
                                                 bool with_specular) = 0;
};

class PhotonEngine final : public IndirectEngine {
  public:
    PhotonEngine(const Surface& surface,
                 const TexelAtlas& atlas,
                 const SceneView& scene,
                 const EstimateOptions& options,
                 Progress& progress);

    // Traces when there are no photons yet, when with_specular changed, or when the effective
    // number of stored photons has halved since they were traced.
    [[nodiscard]] IndirectLight evaluate(std::span<const Reflectance> maps,
                                         std::span<const std::uint8_t> seen,
                                         bool with_specular) override;

  private:
    void trace(std::span<const Reflectance> guide);
    [[nodiscard]] double weigh(std::span<const Reflectance> maps);
    [[nodiscard]] std::vector<IndirectIrradiance> irradiance(const PhotonPaths& paths,
                                                             std::span<const Rgbf> power) const;

    const Surface& surface_;
    const TexelAtlas& atlas_;
    const SceneView& scene_;
    const EstimateOptions& options_;
    Progress& progress_;
    std::vector<std::vector<Vec3f>> w_v_;  // per camera view, per texel
    std::vector<PhotonPaths> paths_;       // per lamp set
    std::vector<PhotonPower> power_;       // per lamp set
    RatioKernel kernel_;
    bool traced_with_specular_ = false;
    double effective_when_traced_ = 0;
};

}  // namespace patina
