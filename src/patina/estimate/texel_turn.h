// What one turn of the iteration finds for one texel, and which of it counts as measured.
#pragma once

#include "patina/estimate/texel_fit.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// Before filling and damping.
struct TexelFit {
    Reflectance reflectance;
    bool observed = false;
    bool specular_measured = false;
    bool roughness_measured = false;
    // The lobe is not measured, but the filled one was corrected by what looks tell of it.
    bool informed = false;
    bool joint = false;  // fitted in one step: no T_diff pixels, or classes that do not settle
    double misfit = 1;   // see FitErrors
    double specular_error = 0;   // standard error of Ps when it was judged, all free [-]
    double roughness_error = 0;  // of sigma [rad]
    // What the looks told of a lobe when it was judged, or of an informed one; see LobeEvidence.
    Eigen::Matrix2f lobe_information = Eigen::Matrix2f::Zero();
    // How an informed lobe moved in the last turn [log].
    Eigen::Vector2f informed_step = Eigen::Vector2f::Zero();
    // How far it takes the step that the looks ask for [0 to 1].
    Eigen::Vector2f informed_gain = Eigen::Vector2f::Ones();
    // A measured lobe drawn towards its neighbours', with the Pd that fits it; see drawn_lobe().
    Reflectance drawn;
    // What its neighbours told, see LobePrior::precision; zero where it was not drawn.
    Eigen::Matrix2f neighbor_information = Eigen::Matrix2f::Zero();
};

// Ps counts as measured when its standard error is below the larger of these two: a share of Ps,
// and an absolute one.
inline constexpr double kSpecularRelativeError = 0.2;
inline constexpr double kSpecularAbsoluteError = 0.01;
// A lobe is shown by a look that lies no further than this from the mirror direction [sigma].
inline constexpr double kInsideLobe = 2.0;
// Ps counts as told from zero from so many standard errors on.
inline constexpr double kSpecularDetection = 3.0;
// The standard errors below which Ps and sigma count as measured [-; rad].
[[nodiscard]] double largest_specular_error(double specular);
[[nodiscard]] double largest_roughness_error(double roughness);
// Whether some look lies inside a lobe of this sigma [rad].
[[nodiscard]] bool has_look_inside(std::span<const FitRow> rows,
                                   double roughness,
                                   double reach = kInsideLobe);

// Standard deviations of a texel's looks over the stated ones [-]: those of all texels
// (Estimate::noise_scale), or more where the model fits it worse than others.
[[nodiscard]] double noise_scale_of(const TexelFit& fit, double noise_scale);

// Decides which of the lobe's parameters in fit.reflectance count as measured. What was measured
// before stays so until it misses the mark by half. settled: what was not measured stays out.
void judge_lobe(std::span<const FitRow> rows,
                double noise_scale,
                bool settled,
                const FitOptions& options,
                TexelFit& fit);

// rows: with their classes. present: the texel's map, for the light that is predicted and
// subtracted. previous: of the turn before; its `joint` is this turn's. noise_scale: see Estimate.
// settled: no lobe becomes measured any more.
[[nodiscard]] TexelFit fit_texel(std::span<const FitRow> rows,
                                 const Reflectance& present,
                                 const TexelFit& previous,
                                 double noise_scale,
                                 bool settled,
                                 const FitOptions& options);

// How far the maps of all texels move in a turn.
struct MapChange {
    double moved = 0;  // sum of squared changes of Pd and of Ps sigma^2
    double size = 0;   // sum of Pd^2
    std::size_t num_clamped = 0;

    MapChange& operator+=(const MapChange& other);
    // Root mean square change of the maps' albedo [-].
    [[nodiscard]] double relative() const { return size > 0 ? std::sqrt(moved / size) : 0; }
};

// Makes `next`, held in the feasible set, the map.
MapChange move_map(Reflectance& map, const Reflectance& next);

// Takes back the measurements that their neighbours do not confirm: a lobe counts as measured only
// if half of the texels around it have one of a specular albedo within a factor of two (or are
// matte as it is), again and again as some are taken back, and if it is not one of a small clump. A
// stray fit would otherwise be spread far around by the filling. fits: one per texel of the atlas.
// Returns for each whether its measurement was taken back: its Pd is then still that of the stray
// lobe.
[[nodiscard]] std::vector<std::uint8_t> drop_unconfirmed(const TexelAtlas& atlas,
                                                         std::span<TexelFit> fits);

}  // namespace patina
