// The lamps' common factor from interreflections: the lowest point of a profile cost over ln k, and
// its error, robust against residuals that neighbours or looks under one lamp share.
//
// Based on: Cameron, Gelbach, Miller. Robust Inference With Multiway Clustering. J. Bus. Econ.
// Stat. 29(2), 2011, eq. 2.7 (the error). docs/theory.md, "Absolute scale".
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace patina {

// Told, if its standard error is below this [-].
inline constexpr double kLargestScaleError = 0.1;

struct ScaleEstimate {
    bool told = false;
    double factor = 1;  // true intensities of the lamps over the stated ones; 1 unless told [-]
    // Relative standard error of the factor that fits best [-]; infinite: there is no best one.
    double standard_error = std::numeric_limits<double>::infinity();
    double best_factor = 1;  // told or not; 1 if there is none [-]
    std::string reason;      // why it is not told, in words; empty: it is
};

// What the looks say against one factor, everything else fitted anew.
struct ScaleTrial {
    // Weighted squared residuals [-], block of texels by block, per block one number for each set
    // of lamps.
    std::vector<double> costs;
    double clamped_share = 0;  // of the texels: they would reflect more light than they get

    [[nodiscard]] double total() const;
};

// The costs, as a function of x = ln k.
class ScaleTrials {
  public:
    ScaleTrials() = default;
    ScaleTrials(const ScaleTrials&) = delete;
    ScaleTrials& operator=(const ScaleTrials&) = delete;
    virtual ~ScaleTrials() = default;

    // Decides at x what all further trials share: weights, and what is measured at all.
    virtual void settle(double x) = 0;
    // Fits again until the maps move by less than the tolerance, relative.
    [[nodiscard]] virtual ScaleTrial try_factor(double x, double tolerance) = 0;
};

// Standard deviation of the sum of all scores, if those of one block or of one set of lamps
// may depend on each other in any way, and others do not. The larger of the one-way estimates where
// the two-way one is smaller. Infinite where fewer than two blocks have
// scores. scores: like ScaleTrial::costs, with sum 0.
[[nodiscard]] double clustered_deviation(const std::vector<double>& scores,
                                         std::size_t num_lamp_sets);

// What a user is to know of a scale that is not told: one line.
[[nodiscard]] std::string untold_note(const ScaleEstimate& scale);

// start: ln k to start from.
[[nodiscard]] ScaleEstimate find_scale(ScaleTrials& trials,
                                       double start,
                                       std::size_t num_lamp_sets);

}  // namespace patina
