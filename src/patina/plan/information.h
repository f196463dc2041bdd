// How well the reflectance of texels would be known from some looks at them, before any is taken:
// the Fisher information of (Pd, Ps, sigma), added to what was known beforehand.
//
// Based on: Chaloner, Verdinelli. Bayesian Experimental Design: A Review. 1995 (D-optimality).
// docs/planning.md derives the formulas and says where the constants come from.
#pragma once

#include "patina/plan/look_table.h"
#include "patina/reflectance/lobe.h"

#include <array>
#include <span>
#include <vector>

namespace patina {

// Noise of a look of radiance L: variance read_variance + gain L + (calibration_stddev L)^2.
struct LookNoise {
    double read_variance = 0;          // [radiance^2]
    double gain = 0;                   // [radiance]
    double calibration_stddev = 0.01;  // relative: what no noise model covers [-]

    // Of one channel of a look that shows this radiance [radiance^2].
    [[nodiscard]] double variance(double radiance) const;
};

// What is supposed of a surface of which nothing is known: a dielectric of index 1.5.
struct SurfacePrior {
    double diffuse = 0.5;           // Pd [-]; > 0
    double specular_albedo = 0.04;  // 2 sigma^2 Ps, its reflectance at normal incidence [-]; > 0
    double roughness = 0.15;        // the middle of three sigma, each twice the last [rad]; > 0
};

// The reflectance that looks are planned for: of every texel one or several that count alike.
class SupposedSurface {
  public:
    // Three widths of the lobe for every texel.
    explicit SupposedSurface(const SurfacePrior& prior);
    // One for each texel, from maps that were estimated before.
    SupposedSurface(const SurfacePrior& prior, std::vector<Reflectance> maps);

    [[nodiscard]] std::size_t num_cases() const { return is_mapped_ ? 1 : cases_.size(); }
    [[nodiscard]] const Reflectance& of(std::size_t texel, std::size_t which) const {
        return cases_[is_mapped_ ? texel : which];
    }
    // Standard deviations of (Pd, Ps, sigma) before any look: as large as the typical values.
    [[nodiscard]] Vec3 prior_stddev(std::size_t texel, std::size_t which) const;

  private:
    SurfacePrior prior_;
    std::vector<Reflectance> cases_;
    bool is_mapped_ = false;
};

// How strongly looks depend on what is asked for: the derivatives of each look's radiance by (Pd,
// Ps, sigma), in units of the prior's standard deviations and of the look's noise [-]; the square
// of one is the information that the look adds, where the prior is 1. Compressed rows.
struct LookGradients {
    std::vector<std::uint32_t> begin;  // texels + 1 offsets, in looks
    std::vector<Vec3f> rows;           // looks x cases
};
[[nodiscard]] LookGradients look_gradients(const LookTable& looks,
                                           const SupposedSurface& surface,
                                           const LookNoise& noise);

// Median standard errors over all texels and cases, relative to the value itself [-]. The prior
// counts, so they are finite also where no look helps; infinite where most values are 0.
struct ErrorSummary {
    double diffuse = 0;    // of Pd
    double specular = 0;   // of Ps
    double roughness = 0;  // of sigma
};
// Ps counts as known from this relative standard error downwards [-].
inline constexpr double kKnown = 0.1;

// What is known of some texels: the covariance of (Pd, Ps, sigma) of each in every case, from the
// prior and the looks added so far. surface must outlive it.
class Knowledge {
  public:
    Knowledge(const SupposedSurface& surface, std::size_t num_texels);

    // By how much the looks would raise log det of the precision, mean over texels and cases
    // [nat]. Monotone and submodular in the set of looks.
    [[nodiscard]] double gain(const LookGradients& looks) const;
    void add(const LookGradients& looks);
    [[nodiscard]] ErrorSummary errors() const;
    // Of texels and cases, where Ps is known to kKnown [-].
    [[nodiscard]] double share_known() const;

  private:
    // Symmetric 3 x 3 in units of the prior's standard deviations, which makes the prior 1.
    struct Covariance {
        double dd = 1, ds = 0, dr = 0, ss = 1, sr = 0, rr = 1;

        // Adds one look; returns the factor by which the determinant of the precision grows.
        double add(const Vec3f& gradient);
    };
    // Adds the texel's looks in one case; returns the factor by which the determinant grows.
    double add_to(Covariance& covariance,
                  const LookGradients& looks,
                  std::size_t texel,
                  std::size_t which) const;
    // Standard error of Ps relative to Ps; infinite where it is 0.
    [[nodiscard]] double specular_error(std::size_t i) const;

    const SupposedSurface* surface_;
    std::size_t num_texels_;
    std::vector<Covariance> covariances_;  // texels x cases
};

// The radiance that `share` of the looks stay below; 0 when there is no look [radiance].
[[nodiscard]] double radiance_quantile(const SupposedSurface& surface,
                                       std::span<const LookTable> tables,
                                       double share);

}  // namespace patina
