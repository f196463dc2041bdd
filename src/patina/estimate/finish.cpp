#include "patina/estimate/finish.h"

#include "patina/base/large_vector.h"
#include "patina/base/parallel.h"
#include "patina/estimate/calibration_errors.h"
#include "patina/estimate/error_propagation.h"
#include "patina/estimate/fill_errors.h"
#include "patina/estimate/footprint_blur.h"
#include "patina/estimate/informed_lobe.h"
#include "patina/estimate/lobe_misfit.h"
#include "patina/estimate/lobe_spread.h"
#include "patina/estimate/mean_specular.h"
#include "patina/estimate/residual_variance.h"
#include "patina/estimate/ring_sums.h"
#include "patina/estimate/self_calibration.h"
#include "patina/math/statistics.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

namespace patina {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// What the engines' indirect light may be off by beyond its noise, relative: the lobe's even
// spreading of indirect light, the texels' finite size, the smoothing (docs/uncertainty.md).
constexpr double kIndirectError = 0.02;
// The noise of the indirect light is taken over so many rings of neighbours.
constexpr int kRings = 2;

KnownLobe known_lobe(const TexelFit& fit) {
    if (fit.roughness_measured) return KnownLobe::all;
    return fit.specular_measured ? KnownLobe::specular : KnownLobe::none;
}

Parameters parameters_of(const Reflectance& r) {
    return {r.diffuse[0], r.diffuse[1], r.diffuse[2], r.specular, r.roughness};
}

// The parts of a texel's variance before they are put together.
struct ErrorBudget {
    Parameters stated = Parameters::Zero();     // stated errors, and the indirect light's bias
    Parameters transport = Parameters::Zero();  // the indirect light's noise
    Parameters blur = Parameters::Zero();       // pixels wider than a point
    // What is left of the looks' random errors when neighbours have their say [0 to 1].
    Parameters share = Parameters::Ones();
    Eigen::Matrix<double, 3, 2> diffuse_by_lobe =
        Eigen::Matrix<double, 3, 2>::Zero();  // see add_filled_errors()
};

class Finisher {
  public:
    Finisher(const Capture& capture,
             const SceneView& scene,
             const Observations& observations,
             const IndirectLight& light,
             std::span<const TexelFit> fits,
             std::span<const float> robust,
             Estimate& estimate)
        : atlas_(capture.atlas),
          scene_(scene),
          observations_(observations),
          rows_(scene, observations),
          calibration_(capture, scene, observations),
          self_calibration_(calibration_.shared().size()),
          light_(light),
          fits_(fits),
          robust_(robust),
          estimate_(estimate),
          budgets_(fits.size()),
          evidence_(fits.size()),
          left_out_(fits.size()),
          misfit_stride_(misfit_stride(fits)),
          footprints_(footprint_moments(capture, scene)) {}

    void run() {
        const std::size_t num_texels = fits_.size();
        estimate_.errors.resize(num_texels);
        estimate_.status.assign(num_texels, TexelStatus::filled);
        estimate_.measurability.resize(num_texels);
        estimate_.indirect_over_direct.assign(num_texels, 0.0f);
        look_at_all();
        add_shared_errors();
        smooth_transport();
        find_noise();
        find_blur();
        estimate_.lobe_misfit = lobe_misfit_factor(left_out_);
        specular_ratios_ = mean_over_own_specular(atlas_, estimate_.maps, fits_);
        parallel_for(num_texels, [&](std::size_t i) {
            estimate_.errors[i] = errors_with(i, random_variance(i));
        });
        add_fill_errors();
    }

  private:
    // Patch by patch, as their sums ask for.
    void look_at_all() {
        std::vector<std::vector<std::size_t>> patches(SelfCalibration::kNumPatches);
        for (std::size_t i = 0; i < fits_.size(); ++i) {
            patches[SelfCalibration::patch_of(atlas_, i)].push_back(i);
        }
        parallel_for(
            patches.size(),
            [&](std::size_t patch) {
                std::vector<FitRow> rows;
                const std::vector<std::size_t>& texels = patches[patch];
                for (std::size_t k = 0; k < texels.size(); ++k) {
                    const std::size_t ahead = std::min(k + kTexelsAhead, texels.size() - 1);
                    rows_.expect(texels[ahead], light_);
                    look_at(texels[k], patch, rows);
                }
            },
            1);
    }

    // With the weights of the fit.
    void make_rows(std::size_t i, std::vector<FitRow>& rows) const {
        rows_.make(i, light_, estimate_.maps[i], rows);
        for (std::size_t k = 0; k < rows.size() && !robust_.empty(); ++k) {
            rows[k].weight *= double(robust_[observations_.begin[i] + k]);
        }
    }

    void look_at(std::size_t i, std::size_t patch, std::vector<FitRow>& rows) {
        make_rows(i, rows);
        if (rows.empty()) return;
        estimate_.status[i] =
            fits_[i].specular_measured ? TexelStatus::measured : TexelStatus::diffuse_measured;
        const Reflectance& fitted = estimate_.maps[i];
        estimate_.measurability[i] =
            texel_measurability(rows, fitted, fits_[i], estimate_.noise_scale);
        const ErrorPropagation propagation(rows, fitted, known_lobe(fits_[i]));
        ErrorBudget& budget = budgets_[i];
        evidence_[i] = residual_evidence(propagation);
        if (was_drawn(i)) {
            const Eigen::Matrix2d to_log = by_log_lobe(fitted).inverse();
            budget.share = propagation.share_beside(
                to_log.transpose() * fits_[i].neighbor_information.cast<double>() * to_log,
                noise_scale_of(fits_[i], estimate_.noise_scale));
        }
        const bool is_left_out = fits_[i].roughness_measured && i % misfit_stride_ == 0;
        std::vector<std::vector<Rgb>> changes;
        std::vector<SharedChange> shared = calibration_.light_shifts(i, rows, fitted);
        calibration_.visit(i, rows, fitted, [&](std::span<const Rgb> change, auto shared_error) {
            if (!shared_error) {
                budget.stated += propagation.response(change).cwiseAbs2();
            } else if (!is_shift(*shared_error)) {
                shared.push_back({*shared_error, {change.begin(), change.end()}});
            }
            if (is_left_out) changes.emplace_back(change.begin(), change.end());
        });
        self_calibration_.add(patch, rows, propagation, shared);
        if (is_left_out) {
            left_out_[i] =
                left_out_misfit(rows, fitted, changes, estimate_.noise_scale, FitOptions());
        }
        add_indirect(i, rows, propagation);
        if (known_lobe(fits_[i]) == KnownLobe::none) add_filled_lobe(i, rows, propagation);
    }

    [[nodiscard]] bool was_drawn(std::size_t i) const {
        return fits_[i].roughness_measured && estimate_.maps[i].specular > 0 &&
               !fits_[i].neighbor_information.isZero();
    }

    [[nodiscard]] bool is_shift(std::size_t shared_error) const {
        return calibration_.shared()[shared_error].kind == SharedErrorKind::image_shift;
    }

    // What the residuals tell of errors that all texels share: lamps are put right in the maps; a
    // shift of the images is not, as maps and images would no longer lie on each other, but counts
    // as it was found.
    void add_shared_errors() {
        const std::vector<SharedError>& all = calibration_.shared();
        if (all.empty()) return;
        // Without indirect light, residuals tell of that.
        const SharedErrors found = light_.irradiance.empty() ? SelfCalibration(all.size()).solve()
                                                             : self_calibration_.solve();
        for (std::size_t k = 0; k < all.size(); ++k) {
            const auto i = Eigen::Index(k);
            estimate_.calibration.push_back(
                calibration_.found(all[k], found.value[i], std::sqrt(found.covariance(i, i))));
        }
        parallel_blocks(fits_.size(), kParallelBlock, [&](std::size_t begin, std::size_t end) {
            std::vector<FitRow> rows;
            for (std::size_t i = begin; i < end; ++i) {
                make_rows(i, rows);
                if (!rows.empty()) add_shared_errors(i, rows, found);
            }
        });
    }

    void add_shared_errors(std::size_t i,
                           const std::vector<FitRow>& rows,
                           const SharedErrors& found) {
        const Reflectance& fitted = estimate_.maps[i];
        const ErrorPropagation propagation(rows, fitted, known_lobe(fits_[i]));
        std::vector<Eigen::Index> touched;
        std::vector<Parameters> responses;
        Parameters by_lamps = Parameters::Zero();
        Parameters by_shift = Parameters::Zero();
        calibration_.visit(i, rows, fitted, [&](std::span<const Rgb> change, auto shared_error) {
            if (!shared_error) return;
            const auto k = Eigen::Index(*shared_error);
            touched.push_back(k);
            responses.push_back(propagation.response(change));
            (is_shift(*shared_error) ? by_shift : by_lamps) += found.value[k] * responses.back();
        });
        Parameters& stated = budgets_[i].stated;
        stated += by_shift.cwiseAbs2();
        for (std::size_t a = 0; a < touched.size(); ++a) {
            for (std::size_t b = 0; b < touched.size(); ++b) {
                stated += found.covariance(touched[a], touched[b]) *
                          responses[a].cwiseProduct(responses[b]);
            }
        }
        estimate_.maps[i] = project_to_feasible({fitted.diffuse - by_lamps.head<3>().array(),
                                                 fitted.specular - by_lamps[3],
                                                 fitted.roughness - by_lamps[4]})
                                .reflectance;
    }

    // What the fit of Pd takes off for the lobe, if that is brighter or wider than it was filled.
    void add_filled_lobe(std::size_t i,
                         const std::vector<FitRow>& rows,
                         const ErrorPropagation& propagation) {
        const Reflectance& map = estimate_.maps[i];
        std::vector<Rgb> brighter(rows.size());
        std::vector<Rgb> wider(rows.size());
        for (std::size_t k = 0; k < rows.size(); ++k) {
            brighter[k] = -map.specular / kPi * lobe_basis(rows[k], map.roughness);
            wider[k] = -map.specular / kPi * map.roughness *
                           direct_lobe_basis_by_roughness(rows[k], map.roughness) -
                       2 * brighter[k];
        }
        budgets_[i].diffuse_by_lobe << propagation.response(brighter).head<3>(),
            propagation.response(wider).head<3>();
    }

    void add_indirect(std::size_t i,
                      const std::vector<FitRow>& rows,
                      const ErrorPropagation& propagation) {
        const Reflectance& fitted = estimate_.maps[i];
        const double hidden = light_.hidden.empty() ? 0.0 : double(light_.hidden[i]);
        double direct = 0;
        double whole = 0;
        std::vector<Rgb> bias(rows.size());
        std::vector<Rgb> difference(rows.size(), Rgb::Zero());
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const FitRow& row = rows[k];
            Rgb from_lamps = Rgb::Zero();
            for (const LampTerm& lamp : row.lamps) from_lamps += lamp.irradiance.cast<double>();
            direct += from_lamps.mean();
            whole += row.irradiance.mean();
            const Rgb from_lobe =
                lobe_basis(row, fitted.roughness) - direct_lobe_basis(row, fitted.roughness);
            bias[k] =
                std::hypot(kIndirectError, hidden) *
                (fitted.diffuse * (row.irradiance - from_lamps) + fitted.specular * from_lobe) /
                kPi;
            if (light_.irradiance.empty()) continue;
            const Observation& look = observations_.of(i)[k];
            const IndirectIrradiance& indirect =
                light_.irradiance.of(i)[scene_.lamp_set_of_shot[look.shot]];
            difference[k] = fitted.diffuse * indirect.half_difference() / kPi;
        }
        if (direct > 0) estimate_.indirect_over_direct[i] = float(whole / direct - 1);
        ErrorBudget& budget = budgets_[i];
        budget.stated += propagation.response(bias).cwiseAbs2();
        budget.transport = propagation.response(difference).cwiseAbs2();
    }

    // One difference of two halves is one draw: its square becomes a variance in the mean over the
    // neighbours.
    void smooth_transport() {
        struct Sum {
            Parameters value = Parameters::Zero();
            double count = 0;
            Sum& operator+=(const Sum& other) {
                value += other.value;
                count += other.count;
                return *this;
            }
        };
        LargeVector<Sum> sums(budgets_.size());
        parallel_for(sums.size(), [&](std::size_t i) {
            if (fits_[i].observed) sums[i] = {budgets_[i].transport, 1.0};
        });
        sum_over_rings(atlas_, kRings, sums);
        parallel_for(sums.size(), [&](std::size_t i) {
            if (sums[i].count > 0) budgets_[i].transport = sums[i].value / sums[i].count;
        });
    }

    void find_blur() {
        const std::size_t num_texels = budgets_.size();
        LargeVector<Parameters> maps(num_texels);
        LargeVector<Parameters> noise(num_texels);
        std::vector<std::uint8_t> observed(num_texels);
        parallel_for(num_texels, [&](std::size_t i) {
            maps[i] = parameters_of(estimate_.maps[i]);
            noise[i] = random_variance(i);
            observed[i] = fits_[i].observed;
        });
        const double moment = *std::max_element(footprints_.begin(), footprints_.end());
        const LargeVector<Parameters> blur = footprint_blur(atlas_, maps, noise, observed, moment);
        parallel_for(num_texels, [&](std::size_t i) { budgets_[i].blur = blur[i]; });
    }

    // What differs from texel to texel at random, of a lobe that was drawn towards its neighbours'.
    [[nodiscard]] Parameters random_variance(std::size_t i) const {
        return own_random_variance(i).cwiseProduct(budgets_[i].share);
    }
    // Of its own looks alone.
    [[nodiscard]] Parameters own_random_variance(std::size_t i) const {
        return residual_.variance[i] + budgets_[i].transport;
    }

    void find_noise() {
        residual_ = residual_variance(atlas_, evidence_);
        estimate_.noise_own = residual_.own;
        estimate_.noise_shared = residual_.shared;
    }

    [[nodiscard]] Reflectance errors_with(std::size_t i, const Parameters& random) const {
        Reflectance error;
        error.diffuse = Rgb::Constant(kInfinity);
        error.specular = kInfinity;
        error.roughness = kInfinity;
        if (!fits_[i].observed) return error;
        const ErrorBudget& budget = budgets_[i];
        const Parameters variance = random + budget.stated + budget.blur;
        const double misfit = estimate_.lobe_misfit;
        error.diffuse = variance.head<3>().array().sqrt();
        if (fits_[i].specular_measured) {
            error.specular = misfit * specular_ratios_[i] * std::sqrt(variance[3]);
        }
        if (fits_[i].roughness_measured) error.roughness = misfit * std::sqrt(variance[4]);
        return error;
    }

    // Of lobes that others filled, and of the Pd that was fitted with them.
    void add_fill_errors() {
        const std::size_t num_texels = fits_.size();
        std::vector<std::uint8_t> measured(num_texels);
        // Lobes as they were before their neighbours had a say: these filled the others.
        std::vector<Reflectance> own = estimate_.maps;
        std::vector<Reflectance> own_errors = estimate_.errors;
        parallel_for(num_texels, [&](std::size_t i) {
            measured[i] = fits_[i].observed && fits_[i].roughness_measured;
            if (!was_drawn(i)) return;
            own[i] = fits_[i].reflectance;
            own_errors[i] = errors_with(i, own_random_variance(i));
        });
        const std::vector<LobeSpread> spread = fill_errors(atlas_, own, own_errors, measured);
        parallel_for(num_texels, [&](std::size_t i) {
            if (!fits_[i].observed || fits_[i].specular_measured) return;
            add_filled_errors(spread[i],
                              fits_[i].lobe_information.cast<double>(),
                              budgets_[i].diffuse_by_lobe,
                              estimate_.maps[i],
                              estimate_.errors[i]);
        });
    }

    const TexelAtlas& atlas_;
    const SceneView& scene_;
    const Observations& observations_;
    FitRowMaker rows_;
    CalibrationErrors calibration_;
    SelfCalibration self_calibration_;
    const IndirectLight& light_;
    std::span<const TexelFit> fits_;
    std::span<const float> robust_;
    Estimate& estimate_;
    std::vector<double> specular_ratios_;  // see mean_over_own_specular()
    LargeVector<ErrorBudget> budgets_;
    LargeVector<ResidualEvidence> evidence_;
    std::vector<std::optional<double>> left_out_;  // see left_out_misfit()
    std::size_t misfit_stride_;
    std::vector<double> footprints_;  // see footprint_moments()
    ResidualVariance residual_;
};

}  // namespace

void finish_estimate(const Capture& capture,
                     const SceneView& scene,
                     const Observations& observations,
                     const IndirectLight& light,
                     std::span<const TexelFit> fits,
                     std::span<const float> robust,
                     Estimate& estimate) {
    Finisher(capture, scene, observations, light, fits, robust, estimate).run();
}

}  // namespace patina
