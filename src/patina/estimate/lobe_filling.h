// The lobes of all texels whose own looks do not measure one: filled from those that are measured,
// and corrected by what a texel's own looks add. docs/theory.md, "Filling".
#pragma once

#include "patina/estimate/fill_errors.h"
#include "patina/estimate/guided_fill.h"
#include "patina/estimate/informed_lobe.h"
#include "patina/estimate/texel_turn.h"
#include "patina/scene/atlas.h"

#include <optional>
#include <span>
#include <vector>

namespace patina {

// sigma of a surface without any measured lobe [rad].
inline constexpr double kInitialRoughness = 0.2;

// Keeps a reference to the atlas. fits: one per texel everywhere.
class LobeFilling {
  public:
    explicit LobeFilling(const TexelAtlas& atlas);

    // For all fillings to come: the guide, Pd, and which measured lobes are strays, which stay
    // measured but fill nothing: those whose logarithms depart from what others of a like colour
    // have by more than three times the root mean square of all.
    void set_guide(std::span<const TexelFit> fits);
    // How far filled lobes may be from the truth, for spread().
    void find_spread(std::span<const TexelFit> fits);

    // ln sigma, and then Ps sigma^2, which varies slowly where sigma does not: of texels that do
    // not measure them. tolerance: of solve_links(). fallback: Ps sigma^2 where no lobe was
    // measured anywhere.
    void fill_roughness(double tolerance, std::span<TexelFit> fits);
    void fill_specular(double tolerance, double fallback, std::span<TexelFit> fits);

    // How much neighbours have to do with each other, one per entry of atlas.neighbors [0 to 1].
    [[nodiscard]] std::span<const float> links() const { return fill_->links(); }
    // As it was filled last; a lobe without albedo is none.
    [[nodiscard]] bool has_lobe(std::size_t texel) const { return specular_albedo_[texel] > 0; }
    [[nodiscard]] LogLobe lobe(std::size_t texel) const;
    // Standard errors of its logarithms, as they were found last; zero for measured lobes.
    [[nodiscard]] const LobeSpread& spread(std::size_t texel) const { return spread_[texel]; }

  private:
    void find_strays(std::span<const TexelFit> fits);
    [[nodiscard]] bool fills(std::span<const TexelFit> fits, std::size_t texel) const;

    const TexelAtlas& atlas_;
    std::optional<GuidedFill> fill_;
    std::vector<std::uint8_t> stray_;
    std::vector<LobeSpread> spread_;
    std::vector<double> log_roughness_;    // as it was filled
    std::vector<double> specular_albedo_;  // Ps sigma^2
    std::vector<float> confidence_;
};

}  // namespace patina
