// Whether held-out photographs lie as far from their prediction as the used ones say they should.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace patina {

// Variance of real - synthetic as a function of brightness, from the used shots: the mean square in
// bins of the synthetic radiance, half an octave each. One for texels whose lobe was fitted to
// their looks, another for the rest: the two err differently.
class ResidualNoise {
  public:
    void add(double synthetic, double residual);
    // factor: of all variances, for what fitting took off. [radiance^2]; the nearest filled bin's
    // where none was added.
    [[nodiscard]] double variance(double synthetic, double factor) const;

  private:
    static constexpr int kBins = 40;
    [[nodiscard]] static std::size_t bin_of(double synthetic);
    std::array<double, kBins> squares_{};
    std::array<double, kBins> counts_{};
};

struct PredictionCheck {
    double reduced_chi_square = 0;  // mean squared residual over its predicted variance [-]
    double coverage68 = 0;          // share of the residuals within one predicted deviation [-]
    double coverage95 = 0;          // within 1.96
};

class PredictionSums {
  public:
    // variance: predicted for this residual [radiance^2]; > 0.
    void add(double residual, double variance);
    // Nothing without residuals.
    [[nodiscard]] std::optional<PredictionCheck> result() const;

  private:
    double squares_ = 0;
    double narrow_ = 0;
    double wide_ = 0;
    double count_ = 0;
};

// n / (n - p): what a fit of p parameters to n looks takes off the residuals. Per channel: Pd, and
// with_lobe a third of Ps and sigma. 1 where there are too few looks to say.
[[nodiscard]] double fitted_share(double looks, bool with_lobe);

}  // namespace patina
