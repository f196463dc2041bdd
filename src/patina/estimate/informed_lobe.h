// Lobes of texels whose own looks tell something of them, but not enough: the filled lobe,
// corrected by what the looks of the texel and of its neighbours add. docs/theory.md, "Filling".
#pragma once

#include "patina/base/large_vector.h"
#include "patina/estimate/fill_errors.h"
#include "patina/estimate/texel_fit.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace patina {

// A lobe as (ln(Ps sigma^2), ln sigma), sigma in rad.
using LogLobe = Eigen::Vector2d;
// Ps above 0.
[[nodiscard]] LogLobe log_lobe(const Reflectance& reflectance);
// Derivative of (Ps, sigma) by log_lobe().
[[nodiscard]] Eigen::Matrix2d by_log_lobe(const Reflectance& reflectance);

// What looks tell of a lobe, as the normal equations of its deviation from the filled one, with
// weights of 1 / variance.
struct LobeEvidence {
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    LogLobe pull = LogLobe::Zero();  // information x deviation

    LobeEvidence& operator+=(const LobeEvidence& other);
    LobeEvidence& operator*=(double factor);
};

// Linearised at a reflectance with Ps above 0 and the best Pd for its lobe. By direct light, Pd
// unknown. noise_scale: standard deviations of the looks over the stated ones, above 0.
[[nodiscard]] LobeEvidence lobe_evidence(std::span<const FitRow> rows,
                                         const Reflectance& reflectance,
                                         const LogLobe& filled,
                                         double noise_scale);

// Adds to each texel's evidence that of its neighbours and of theirs: the deviation from the filled
// lobe changes slowly where the surface is of one kind. Weights are products of the links on the
// way, over those of the ways back to the texel itself, so that it counts once. links: in [0, 1],
// one per entry of atlas.neighbors.
void pool_evidence(const TexelAtlas& atlas,
                   std::span<const float> links,
                   LargeVector<LobeEvidence>& evidence);

// Covariance of the errors of a LogLobe that was filled with `spread`, with evidence besides (of no
// information: the spread alone).
[[nodiscard]] Eigen::Matrix2d informed_covariance(const LobeSpread& spread,
                                                  const Eigen::Matrix2d& information);

// Standard errors of a filled lobe, and of the Pd that was fitted with it besides its own in
// `error`. diffuse_by_lobe: change of Pd by the LogLobe.
void add_filled_errors(const LobeSpread& spread,
                       const Eigen::Matrix2d& information,
                       const Eigen::Matrix<double, 3, 2>& diffuse_by_lobe,
                       const Reflectance& map,
                       Reflectance& error);

// By how much evidence of other texels is to be multiplied [0 to 1], for what it says of measured
// lobes: there the deviation is 0, and what `evidence` finds is its noise and what the model of the
// lobe gets wrong. Of 1, 1/4, 1/16 and 1/64 the one that leaves the least mean squared error to a
// filling that errs by `spread`; 0 where that is more than the filling's own, or where there are
// too few texels to say.
[[nodiscard]] double evidence_weight(std::span<const LobeEvidence> evidence,
                                     const LobeSpread& spread);

// The most probable lobe for errors of the filling of `spread`.
[[nodiscard]] LogLobe informed_lobe(const LogLobe& filled,
                                    const LobeSpread& spread,
                                    const LobeEvidence& evidence);

}  // namespace patina
