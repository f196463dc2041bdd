// How far lobes hold beyond the looks that they were fitted to: a texel's deepest look into its
// highlight is left out and predicted by a fit to the others.
//
// Based on: Allen. The Relationship between Variable Selection and Data Augmentation and a Method
// for Prediction. Technometrics 16(1), 1974 (prediction of what is left out); Huber. Robust
// Statistics. Wiley 1981, section 5 (scale from the median).
#pragma once

#include "patina/estimate/texel_fit.h"
#include "patina/estimate/texel_turn.h"

#include <optional>
#include <span>
#include <vector>

namespace patina {

// Square of the left-out look's residual (mean over channels, which err alike) over the variance
// that the errors of the fit to the other looks and the look's own noise predict [-]: 1 in the mean
// if the lobe is of the model's shape. Nothing where the other looks do not measure a lobe.
// rows: all looks with their weights. fitted: to all of them. changes: of the rows' radiance by one
// standard deviation of each error that is known of and that the looks share, counted besides their
// noise. noise_scale: see Estimate.
[[nodiscard]] std::optional<double> left_out_misfit(std::span<const FitRow> rows,
                                                    const Reflectance& fitted,
                                                    std::span<const std::vector<Rgb>> changes,
                                                    double noise_scale,
                                                    const FitOptions& options);

// It suffices to ask one texel in so many.
[[nodiscard]] std::size_t misfit_stride(std::span<const TexelFit> fits);

// By how much the standard errors of Ps and of sigma are to be multiplied [-], >= 1: the median of
// the misfits over that of chi-square with one degree of freedom. 1 where there are too few to
// tell.
[[nodiscard]] double lobe_misfit_factor(std::span<const std::optional<double>> misfits);

}  // namespace patina
