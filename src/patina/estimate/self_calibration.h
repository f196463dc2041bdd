// The errors that all texels share (lamps beside the places where they are said to stand, images
// shifted against the geometry), as far as the residuals of all texels tell them.
//
// Based on: Triggs, McLauchlan, Hartley, Fitzgibbon. Bundle Adjustment: A Modern Synthesis. 2000
// (section 6, each texel's own parameters eliminated; stated errors as prior); Liang, Zeger.
// Longitudinal Data Analysis Using Generalized Linear Models. Biometrika 73(1), 1986 (covariance
// clustered by patch); Hartlap, Simon, Schneider. Why Your Model Parameter Confidences Might Be Too
// Optimistic. Astronomy & Astrophysics 464, 2007. docs/uncertainty.md, "Errors that all texels
// share".
#pragma once

#include "patina/estimate/calibration_errors.h"
#include "patina/estimate/error_propagation.h"
#include "patina/scene/atlas.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace patina {

// All in units of the stated standard deviations [-].
struct SharedErrors {
    Eigen::VectorXd value;       // what the residuals make most likely
    Eigen::MatrixXd covariance;  // of what is still unknown
};

class SelfCalibration {
  public:
    // The texel domain is cut into so many patches along each side; their number is what errors are
    // judged by, so that misfits that neighbours share do not count as many.
    static constexpr int kPatchesPerSide = 16;
    static constexpr std::size_t kNumPatches = std::size_t(kPatchesPerSide) * kPatchesPerSide;
    [[nodiscard]] static std::size_t patch_of(const TexelAtlas& atlas, std::size_t texel);

    explicit SelfCalibration(std::size_t num_errors);

    // Adds a texel. rows, propagation: of its looks, with the weights of the fit. changes: under
    // fixed maps, each error once at most. Threads may add
    // to different patches at the same time.
    void add(std::size_t patch,
             std::span<const FitRow> rows,
             const ErrorPropagation& propagation,
             std::span<const SharedChange> changes);

    // The stated errors themselves, 0 with covariance 1, where there are not enough patches to tell
    // more, or where what they tell is far larger than stated.
    [[nodiscard]] SharedErrors solve() const;

  private:
    // Sums of C' W r and C' W C over looks, C the changes with what the texels' own parameters
    // explain taken off, r the residuals.
    struct Patch {
        Eigen::VectorXd score;
        Eigen::MatrixXd information;
    };

    std::size_t num_errors_;
    std::vector<Patch> patches_;  // empty where no texel was added
};

}  // namespace patina
