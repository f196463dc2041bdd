#include "patina/estimate/gather_iteration.h"

#include "patina/base/parallel.h"
#include "patina/estimate/finish.h"
#include "patina/math/statistics.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {
namespace {

// What counts as measured, the weights of outliers and the guide of the filling stay as they are
// once a turn has changed the maps and the bounced light by less than this, relative, after at
// least and at most so many turns: the bounced light is known then, and the iteration comes to
// rest. The light tells besides where maps lie on the border of the feasible set while it still
// grows.
constexpr double kMapsNearRest = 0.01;
constexpr double kLightNearRest = 0.05;
constexpr int kFewestFreeTurns = 3;
constexpr int kMostFreeTurns = 12;
// While the bounced light is hardly known, looks say nothing of lobes that they hardly show.
constexpr int kUninformedTurns = 2;
// What is filled is solved to this share of the last turn's change, at most so roughly.
constexpr double kFillShare = 0.01;
constexpr double kRoughestFill = 1e-3;
// A look whose residual is more standard deviations away than this counts for less (Huber's
// weight), and so many times further still less, by the square of it.
constexpr double kOutlier = 2.0;
constexpr double kGross = 7.0;
constexpr std::size_t kMinLooksForOutliers = 5;
// The median of |x| of three normal channels taken together, root of the median of chi^2(3) / 3.
constexpr double kMedianMisfit = 0.888;

struct TurnSums {
    double squared_error = 0;
    double count = 0;
};

}  // namespace

GatherIteration::GatherIteration(const Capture& capture,
                                 const SceneView& scene,
                                 const Observations& observations,
                                 const EstimateOptions& options)
    : capture_(capture),
      atlas_(capture.atlas),
      scene_(scene),
      observations_(observations),
      rows_(scene, observations),
      options_(options),
      num_texels_(atlas_.texels.size()),
      fits_(num_texels_),
      robust_(observations.rows.size(), 1.0f),
      geometry_fill_(atlas_, std::vector<Rgb>(num_texels_, Rgb::Ones())),
      lobe_filling_(atlas_) {
    Reflectance start;
    start.roughness = kInitialRoughness;
    result_.maps.assign(num_texels_, start);
    result_.seen = observations.seen;
}

void GatherIteration::start(Progress& progress) {
    progress.begin_stage("method direct");
    take_turn("direct", {}, false, false);
    progress.end_stage();
}

void GatherIteration::run(GatherEngine& engine, Progress& progress) {
    progress.begin_stage("method gather", std::uint64_t(options_.max_iterations), "turns");
    result_.converged = false;
    double previous_error = 0;
    double change = 1;
    bool frozen = false;
    int turn = 0;
    for (; turn < options_.max_iterations && !result_.converged; ++turn) {
        const bool was_frozen = frozen;
        frozen =
            was_frozen || turn >= kMostFreeTurns ||
            (turn >= kFewestFreeTurns && change < kMapsNearRest && light_.change < kLightNearRest);
        const IterationLog log = this->turn(engine, frozen);
        change = log.change;
        const double error_change =
            std::abs(log.error - previous_error) / std::max(log.error, 1e-300);
        previous_error = log.error;
        result_.converged =
            (was_frozen && change < options_.tolerance && error_change < options_.tolerance) ||
            log.error < options_.threshold;
        progress.advance(1);
    }
    const IterationLog& last = result_.iterations.back();
    progress.end_stage(fmt::format("{} turns, E {:.3g}, change {:.1e}, lambda {:.2f}",
                                   turn,
                                   last.error,
                                   last.change,
                                   last.spectral_radius));
    if (!result_.converged) {
        progress.note(fmt::format("warning: method gather had not settled after {} turns", turn));
    }
}

IterationLog GatherIteration::turn(GatherEngine& engine, bool frozen) {
    if (!frozen) held_weights_.clear();
    // Far from the end, as while light still grows or a trial begins, changes do not tell where
    // they lead.
    const bool settled = frozen && !is_held() && light_.change < kLightNearRest &&
                         result_.iterations.back().change < kMapsNearRest;
    engine.evaluate(result_.maps, observations_.seen, true, light_, settled);
    return take_turn("gather", light_, true, frozen);
}

void GatherIteration::set_lamp_factor(double factor) {
    const double ratio = lamp_factor_ / factor;
    lamp_factor_ = factor;
    rows_.set_lamp_factor(factor);
    for (TexelFit& fit : fits_) {
        fit.reflectance.diffuse *= ratio;
        fit.reflectance.specular *= ratio;
        fit.drawn.diffuse *= ratio;
        fit.drawn.specular *= ratio;
        fit.specular_error *= ratio;
    }
    priors_.clear();
    update_maps();
}

bool GatherIteration::has_lobes() const {
    return std::any_of(fits_.begin(), fits_.end(), [](const TexelFit& fit) {
        return fit.observed && fit.specular_measured;
    });
}

void GatherIteration::hold() {
    std::vector<Rgbf> weights(observations_.rows.size());
    parallel_blocks(num_texels_, kParallelBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<FitRow> rows;
        for (std::size_t i = begin; i < end; ++i) {
            make_rows(i, light_, rows);
            for (std::size_t k = 0; k < rows.size(); ++k) {
                weights[observations_.begin[i] + k] =
                    (rows[k].weight / square(lamp_factor_)).cast<float>();
            }
        }
    });
    held_weights_ = std::move(weights);
}

Estimate GatherIteration::finish() {
    finish_estimate(capture_, scene_, observations_, light_, fits_, robust_, result_);
    return std::move(result_);
}

std::span<float> GatherIteration::robust(std::size_t texel) {
    const std::uint32_t begin = observations_.begin[texel];
    return std::span(robust_).subspan(begin, observations_.begin[texel + 1] - begin);
}

void GatherIteration::make_rows(std::size_t texel,
                                const IndirectLight& light,
                                std::vector<FitRow>& rows) const {
    rows_.make(texel, light, result_.maps[texel], rows);
    const std::size_t begin = observations_.begin[texel];
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (is_held()) {
            rows[k].weight = square(lamp_factor_) * held_weights_[begin + k].cast<double>();
        } else {
            rows[k].weight *= double(robust_[begin + k]);
        }
    }
}

IterationLog GatherIteration::take_turn(const std::string& stage,
                                        const IndirectLight& light,
                                        bool has_maps,
                                        bool frozen) {
    const std::size_t num_blocks = (num_texels_ + kParallelBlock - 1) / kParallelBlock;
    std::vector<TurnSums> sums(num_blocks);
    parallel_blocks(num_texels_, kParallelBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<FitRow> rows;
        std::vector<double> misfits;
        JointFit fit;
        for (std::size_t i = begin; i < end; ++i) {
            if (i + kTexelsAhead < end) rows_.expect(i + kTexelsAhead, light);
            make_rows(i, light, rows);
            fit.load(rows);
            if (frozen) {
                follow_texel(fit, i);
            } else {
                fit_texel(rows, has_maps, fit, i);
                weigh_outliers(fit, i, misfits);
            }
            TurnSums& sum = sums[begin / kParallelBlock];
            sum.squared_error += fit.squared_error(
                fits_[i].roughness_measured ? fits_[i].drawn : with_lobe_shown(i));
            sum.count += 3.0 * double(rows.size());
        }
    });
    if (!frozen) {
        num_free_turns_ += light.irradiance.empty() ? 0 : 1;
        update_noise_scale();
        dropped_ = drop_unconfirmed(atlas_, fits_);
        refit_unconfirmed(light);
        lobe_filling_.set_guide(fits_);
    }
    const double last_change = result_.iterations.empty() ? 1 : result_.iterations.back().change;
    fill_unmeasured(
        light, std::clamp(kFillShare * last_change, LinkSolverOptions().tolerance, kRoughestFill));
    if (num_free_turns_ > kUninformedTurns) {
        if (!is_held()) ask_neighbors(frozen);
        inform_filled(light, frozen);
    }

    IterationLog log;
    log.stage = stage;
    double squared_error = 0;
    double count = 0;
    for (const TurnSums& block : sums) {
        squared_error += block.squared_error;
        count += block.count;
    }
    log.error = count > 0 ? squared_error / count : 0;
    log.spectral_radius = light.spectral_radius;
    log.retraced = light.retraced;
    log.change = update_maps();
    result_.iterations.push_back(log);
    return log;
}

// --- One texel -------------------------------------------------------------------------------

void GatherIteration::fit_texel(const std::vector<FitRow>& rows,
                                bool has_maps,
                                const JointFit& joint,
                                std::size_t i) {
    TexelFit& fit = fits_[i];
    fit.observed = !rows.empty();
    if (rows.empty()) return;
    fit.reflectance = joint.solve(options_.fit, has_maps ? fit.reflectance.roughness : 0.0);
    judge_lobe(rows, result_.noise_scale, false, options_.fit, fit);
    draw_texel(joint, i);
    // With a lobe that will be filled, Pd must fit that one and not the wild one found here.
    if (!fit.specular_measured) {
        fit.reflectance.diffuse =
            joint.diffuse_with(result_.maps[i].specular, result_.maps[i].roughness);
    }
}

// What is measured stays what it is.
void GatherIteration::follow_texel(const JointFit& joint, std::size_t i) {
    TexelFit& fit = fits_[i];
    if (!fit.observed) return;
    if (fit.specular_measured && is_held()) {
        fit.reflectance = joint.solve_at(fit.reflectance.roughness);
        fit.drawn = fit.reflectance;
        fit.neighbor_information.setZero();
    } else if (fit.roughness_measured) {
        fit.reflectance = joint.follow(options_.fit, fit.reflectance.roughness);
        draw_texel(joint, i);
    } else {
        fit.reflectance.diffuse =
            joint.diffuse_with(result_.maps[i].specular, result_.maps[i].roughness);
    }
}

// Towards what the neighbours' lobes were in the last turn.
void GatherIteration::draw_texel(const JointFit& joint, std::size_t i) {
    TexelFit& fit = fits_[i];
    fit.drawn = fit.reflectance;
    fit.neighbor_information.setZero();
    if (priors_.empty() || !fit.roughness_measured || !(fit.reflectance.specular > 0)) return;
    const LogLobe drawn =
        drawn_lobe(log_lobe(fit.reflectance), fit.lobe_information.cast<double>(), priors_[i]);
    if (!drawn.allFinite()) return;
    fit.neighbor_information = priors_[i].precision.cast<float>();
    fit.drawn.roughness =
        std::clamp(std::exp(drawn[1]), options_.fit.min_roughness, options_.fit.max_roughness);
    fit.drawn.specular = std::exp(drawn[0]) / square(fit.drawn.roughness);
    fit.drawn.diffuse = joint.diffuse_with(fit.drawn.specular, fit.drawn.roughness);
}

// The fit of a texel, with a lobe that is not measured as it was filled last.
Reflectance GatherIteration::with_lobe_shown(std::size_t i) const {
    Reflectance shown = fits_[i].reflectance;
    if (!fits_[i].specular_measured) {
        shown.specular = result_.maps[i].specular;
        shown.roughness = result_.maps[i].roughness;
    }
    return shown;
}

void GatherIteration::weigh_outliers(const JointFit& joint,
                                     std::size_t i,
                                     std::vector<double>& misfits) {
    const std::span<float> factors = robust(i);
    if (factors.size() < kMinLooksForOutliers) return;
    joint.misfits(with_lobe_shown(i), misfits);
    for (std::size_t k = 0; k < misfits.size(); ++k) {
        misfits[k] = std::sqrt(misfits[k] / double(factors[k]));
    }
    std::vector<double> sorted = misfits;
    const double local = median(std::move(sorted)) / kMedianMisfit;
    const double limit = kOutlier * std::max(result_.noise_scale, local);
    for (std::size_t k = 0; k < misfits.size(); ++k) {
        const double beyond = misfits[k] / limit;
        factors[k] = beyond > 1 ? float(std::min(1.0, square(kGross / beyond)) / beyond) : 1.0f;
    }
}

// --- All texels ------------------------------------------------------------------------------

void GatherIteration::update_noise_scale() {
    std::vector<double> misfits;
    for (std::size_t i = 0; i < num_texels_; ++i) {
        if (fits_[i].observed && observations_.of(i).size() > 2) {
            misfits.push_back(fits_[i].misfit);
        }
    }
    if (!misfits.empty()) result_.noise_scale = std::sqrt(median(std::move(misfits)));
}

void GatherIteration::fill_unmeasured(const IndirectLight& light, double tolerance) {
    std::vector<float> confidence(num_texels_);
    std::vector<double> values(num_texels_);
    for (const Eigen::Index channel : {0, 1, 2}) {
        parallel_for(num_texels_, [&](std::size_t i) {
            confidence[i] = fits_[i].observed ? 1.0f : 0.0f;
            values[i] = fits_[i].observed ? fits_[i].reflectance.diffuse[channel]
                                          : result_.maps[i].diffuse[channel];
        });
        geometry_fill_.fill(confidence, 0, values, tolerance);
        parallel_for(num_texels_,
                     [&](std::size_t i) { fits_[i].reflectance.diffuse[channel] = values[i]; });
    }
    if (!is_held()) {
        lobe_filling_.fill_roughness(tolerance, fits_);
        refit_matte(light);
    }
    lobe_filling_.fill_specular(tolerance, shared_lobe_, fits_);
}

// Texels whose Ps is measured but not their sigma: Ps again, with the filled sigma.
void GatherIteration::refit_matte(const IndirectLight& light) {
    parallel_blocks(num_texels_, 256, [&](std::size_t begin, std::size_t end) {
        std::vector<FitRow> rows;
        JointFit joint;
        for (std::size_t i = begin; i < end; ++i) {
            TexelFit& fit = fits_[i];
            if (!fit.observed || !fit.specular_measured || fit.roughness_measured) continue;
            make_rows(i, light, rows);
            joint.load(rows);
            fit.reflectance = joint.solve_at(fit.reflectance.roughness);
        }
    });
}

// Texels whose lobe was taken back: Pd again, with the lobe that they are filled with.
void GatherIteration::refit_unconfirmed(const IndirectLight& light) {
    parallel_blocks(num_texels_, 256, [&](std::size_t begin, std::size_t end) {
        std::vector<FitRow> rows;
        JointFit joint;
        for (std::size_t i = begin; i < end; ++i) {
            if (dropped_[i] == 0) continue;
            make_rows(i, light, rows);
            joint.load(rows);
            fits_[i].reflectance.diffuse =
                joint.diffuse_with(result_.maps[i].specular, result_.maps[i].roughness);
        }
    });
}

// The maps become the fits; returns the relative change of their albedo.
double GatherIteration::update_maps() {
    const auto move = [&](std::size_t i) {
        const TexelFit& fit = fits_[i];
        return move_map(result_.maps[i], fit.roughness_measured ? fit.drawn : fit.reflectance);
    };
    const auto change = ordered_reduce(num_texels_, MapChange(), move);
    result_.num_clamped = change.num_clamped;
    return change.relative();
}

}  // namespace patina
