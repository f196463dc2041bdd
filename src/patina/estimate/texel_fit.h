// The fit of one texel, in the paper's two alternating steps: (a) Pd, then (b) Ps and sigma.
//
// Based on: Machida, Takemura, Yokoya. 2004, eq. 5 and section 2.2.2.
#pragma once

#include "patina/estimate/observations.h"
#include "patina/reflectance/lobe.h"
#include "patina/transport/ratio_kernel.h"

#include <Eigen/Core>

#include <span>

namespace patina {

// The paper's T_diff, T_spec and T_none.
enum class PixelClass : std::uint8_t { diffuse, specular, neither };

struct FitOptions {
    double initial_roughness = 0.15;  // sigma_0, decides the classes while there are no maps [rad]
    double diffuse_share = 0.02;      // predicted specular share below which a pixel is T_diff [-]
    double specular_share = 0.30;     // and above which it is T_spec [-]
    bool literal = false;             // as the paper: T_diff pixels hold no specular light at all
    double min_roughness = 0.03;      // of the search [rad]
    double max_roughness = kMaxRoughness;  // of the search [rad]
};

// One look with the light of the present iteration.
struct FitRow {
    Rgb radiance = Rgb::Zero();             // observed [radiance]
    Rgb weight = Rgb::Zero();               // 1 / variance of radiance
    Rgb irradiance = Rgb::Zero();           // direct and indirect [radiance x sr]
    Rgb irradiance_variance = Rgb::Zero();  // of its indirect part
    IndirectLobe indirect_lobe;             // about indirect_roughness; zero: not known of
    double indirect_roughness = 0.2;        // sigma that indirect_lobe was found for [rad]
    std::span<const LampTerm> lamps;
    double theta_r = 0;  // [rad]
    PixelClass pixel_class = PixelClass::neither;
};

// pi times the radiance that a lobe of Ps = 1 sends to the camera [radiance x sr]; indirect_lobe
// holds for the present roughness and is taken as it is.
[[nodiscard]] Rgb lobe_basis(const FitRow& row, double roughness);

// Mean of the lobe's Gaussian over a look's footprint [-]: a Gaussian of the mirror direction's
// spread carried through it, to second order.
[[nodiscard]] double spread_gaussian(const LampTerm& lamp, double roughness);

// By direct light alone, and its derivative with respect to sigma [radiance x sr; by rad].
[[nodiscard]] Rgb direct_lobe_basis(const FitRow& row, double roughness);
[[nodiscard]] Rgb direct_lobe_basis_by_roughness(const FitRow& row, double roughness);

// All of them with one exponential for each lamp.
struct LobeBasis {
    Rgb direct = Rgb::Zero();        // direct_lobe_basis()
    Rgb by_roughness = Rgb::Zero();  // direct_lobe_basis_by_roughness()
    Rgb whole = Rgb::Zero();         // lobe_basis()
};
[[nodiscard]] LobeBasis lobe_basis_and_slope(const FitRow& row, double roughness);

// Radiance that the model predicts.
[[nodiscard]] Rgb predict(const FitRow& row, const Reflectance& reflectance);

// By angle: the first turn, while there are no maps.
[[nodiscard]] PixelClass classify_by_angle(const FitRow& row, const FitOptions& options);

// By the predicted specular share. previous: the row's class so far, which holds on until the share
// has left its range by half, so that pixels do not flip to and fro.
[[nodiscard]] PixelClass classify_by_share(const FitRow& row,
                                           const Reflectance& present,
                                           PixelClass previous,
                                           const FitOptions& options);

// (a): Pd from the T_diff rows (T_none ones where there are none, else all), the specular part at
// its present prediction. The noise of the indirect light does not bias it (errors in variables).
[[nodiscard]] Rgb fit_diffuse(std::span<const FitRow> rows,
                              const Reflectance& present,
                              const FitOptions& options);

struct SpecularFit {
    double specular = 0;     // Ps [-]
    double roughness = 0.2;  // sigma [rad]
    bool has_rows = false;   // false: no row in the lobe, nothing was fitted
};

// (b): Ps and sigma from the T_spec and T_none rows with Pd given; Ps in closed form for every
// sigma, sigma by a logarithmic grid and golden sections.
[[nodiscard]] SpecularFit fit_specular(std::span<const FitRow> rows,
                                       const Rgb& diffuse,
                                       const FitOptions& options);

// Ps alone, with sigma given.
[[nodiscard]] SpecularFit fit_specular_at(std::span<const FitRow> rows,
                                          const Rgb& diffuse,
                                          double roughness);

// Whether a row is T_diff, so that the two steps rest on different pixels. Where none is, they
// would chase each other, and fit_jointly() takes their place.
[[nodiscard]] bool has_diffuse_row(std::span<const FitRow> rows);

// Pd, Ps and sigma together from all rows: Pd and Ps in closed form for every sigma (variable
// projection), sigma as in fit_specular().
[[nodiscard]] Reflectance fit_jointly(std::span<const FitRow> rows, const FitOptions& options);

// Standard errors from the Fisher information of all rows, of the lobe by direct light alone
// (indirect light is too noisy a lamp to measure a lobe by); +infinity where there is none.
struct FitErrors {
    Rgb diffuse;                      // of Pd, Ps and sigma free
    Rgb diffuse_lobe_known;           // of Pd with Ps and sigma given
    double specular = 0;              // of Ps, Pd and sigma free
    double specular_sigma_known = 0;  // of Ps with sigma given
    double roughness = 0;             // of sigma, all free [rad]
    double misfit = 1;                // mean squared residual over its variance [-]
    // On (Ps, sigma), Pd free; weights as 1 / variance.
    Eigen::Matrix2d lobe_information = Eigen::Matrix2d::Zero();
};
[[nodiscard]] FitErrors fit_errors(std::span<const FitRow> rows, const Reflectance& reflectance);

}  // namespace patina
