// How far the maps err at random, from the residuals of their own looks.
//
// Based on: Liang, Zeger. Longitudinal Data Analysis Using Generalized Linear Models. Biometrika
// 73(1), 1986 (covariance clustered by look); Bell, McCaffrey. Bias Reduction in Standard Errors
// for Linear Regression with Multi-Stage Samples. Survey Methodology 28(2), 2002 (what the fit took
// off its residuals). docs/uncertainty.md, "Residuals".
#pragma once

#include "patina/base/large_vector.h"
#include "patina/estimate/error_propagation.h"
#include "patina/scene/atlas.h"

#include <span>
#include <vector>

namespace patina {

// What the looks at one texel say. All zero where there is none.
struct ResidualEvidence {
    ResidualMoments moments;
    InfluenceMoments influence;
    Parameters own = Parameters::Zero();     // ErrorPropagation::own_variance()
    Parameters shared = Parameters::Zero();  // and shared_variance()
};

[[nodiscard]] ResidualEvidence residual_evidence(const ErrorPropagation& propagation);

struct ResidualVariance {
    LargeVector<Parameters> variance;  // of the estimate, per texel
    // Of the standardised residuals, median over the surface: the variance that the channels of a
    // look do not share, and that they do [-].
    double own = 1;
    double shared = 0;
};

// evidence: one per texel of the atlas.
[[nodiscard]] ResidualVariance residual_variance(const TexelAtlas& atlas,
                                                 std::span<const ResidualEvidence> evidence);

}  // namespace patina
