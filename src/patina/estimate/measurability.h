// What the looks at a texel can tell of its reflectance, and why they do not tell its lobe where
// they do not: from the information that they carry, whatever values they happened to show.
// docs/uncertainty.md, "What can be measured", has the formulas.
#pragma once

#include "patina/capture/lobe_reason.h"
#include "patina/estimate/texel_turn.h"

#include <limits>
#include <span>

namespace patina {

// Standard errors to be expected of a reflectance, relative to it; +infinity where the looks say
// nothing [-].
struct ExpectedErrors {
    double diffuse = std::numeric_limits<double>::infinity();  // of Pd, its mean over channels
    // Of Ps with sigma given; relative to 0.05 where Ps is less (kSpecularAbsoluteError).
    double specular = std::numeric_limits<double>::infinity();
    double roughness = std::numeric_limits<double>::infinity();  // of sigma, Pd and Ps unknown
};

// By how much the error of a lobe exceeds the mark below which it counts as measured, as a product
// of causes [-].
struct LobeShortfall {
    // Over the mark: the error of Ps from one look in the mirror direction, Pd and sigma known.
    double noise = 0;
    // Where the looks stand instead, and how many they are; below 1 where several share the work.
    double off_lobe = 0;
    double diffuse = 1;  // Pd unknown: 1 / sqrt(1 - rho^2), rho its correlation with Ps; >= 1
    double width = 1;    // sigma unknown; 1 where Ps would not be told from zero, so has no width
};

struct TexelMeasurability {
    ExpectedErrors errors;
    LobeReason reason = LobeReason::not_observed;
};

// rows: with the weights of the fit. map: with the lobe as it was measured or filled. noise_scale:
// standard deviations of the looks over the stated ones, above 0 [-]. The lobe by direct light
// alone, as when it is judged.
[[nodiscard]] ExpectedErrors expected_errors(std::span<const FitRow> rows,
                                             const Reflectance& map,
                                             double noise_scale);

// The same. All factors are finite only where some look has a lobe.
[[nodiscard]] LobeShortfall lobe_shortfall(std::span<const FitRow> rows,
                                           const Reflectance& map,
                                           double noise_scale);

// fit: the texel's, for what counts as measured. noise_scale: see Estimate; a texel that the model
// fits worse than others counts as noisier. Of a lobe that is not measured the reason is the
// largest factor of its shortfall with sigma given; the width where that alone is short.
[[nodiscard]] TexelMeasurability texel_measurability(std::span<const FitRow> rows,
                                                     const Reflectance& map,
                                                     const TexelFit& fit,
                                                     double noise_scale);

}  // namespace patina
