#include "patina/estimate/estimate.h"

#include "patina/base/check.h"
#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/estimate/fill.h"
#include "patina/estimate/finish.h"
#include "patina/estimate/gather_method.h"
#include "patina/estimate/indirect.h"
#include "patina/estimate/texel_turn.h"
#include "patina/math/statistics.h"
#include "patina/reflectance/albedo_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace patina {
namespace {

// After so many turns no texel's lobe becomes measured any more: what comes and goes would keep the
// iteration from coming to rest.
constexpr int kSettleAfter = 8;
// Method I alternates (a) and (b) without any transport; it needs no more turns than this.
constexpr int kDirectIterations = 12;
// Method II before method photon is only a start: it may stop this much earlier.
constexpr double kStartTolerance = 20.0;
constexpr double kMinDamping = 0.1;
constexpr double kLobeDamping = 0.6;
constexpr double kInitialRoughness = 0.2;  // [rad]
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Sums over looks for E, and over texels for the change.
struct TurnSums {
    double squared_error = 0;
    double count = 0;
    TurnSums& operator+=(const TurnSums& other) {
        squared_error += other.squared_error;
        count += other.count;
        return *this;
    }
};

class Iteration {
  public:
    Iteration(const Capture& capture,
              const SceneView& scene,
              const Observations& observations,
              const EstimateOptions& options,
              Progress& progress)
        : capture_(capture),
          scene_(scene),
          observations_(observations),
          rows_(scene, observations),
          options_(options),
          progress_(progress),
          num_texels_(capture.atlas.texels.size()),
          classes_(observations.rows.size(), PixelClass::neither),
          fits_(num_texels_) {
        Reflectance start;
        start.roughness = kInitialRoughness;
        result_.maps.assign(num_texels_, start);
        result_.seen = observations.seen;
    }

    void run_direct() {
        progress_.begin_stage("method direct", kDirectIterations, "turns");
        const IndirectLight none;
        for (int turn = 0; turn < kDirectIterations; ++turn) {
            const IterationLog log = take_turn("direct", none, turn > 0, turn);
            progress_.advance(1);
            if (turn > 2 && log.change < options_.tolerance) break;
        }
        result_.converged = true;
        progress_.end_stage(last_turn());
    }

    void run_indirect(IndirectEngine& engine,
                      const std::string& stage,
                      bool with_specular,
                      double tolerance) {
        progress_.begin_stage("method " + stage, std::uint64_t(options_.max_iterations), "turns");
        result_.converged = false;
        double previous_error = kInfinity;
        int turn = 0;
        for (; turn < options_.max_iterations && !result_.converged; ++turn) {
            indirect_ = engine.evaluate(result_.maps, observations_.seen, with_specular);
            const IterationLog log = take_turn(stage, indirect_, true, turn);
            const double error_change =
                std::abs(log.error - previous_error) / std::max(log.error, 1e-300);
            previous_error = log.error;
            result_.converged =
                (log.change < tolerance && error_change < tolerance && !log.retraced) ||
                log.error < options_.threshold;
            progress_.advance(1);
        }
        progress_.end_stage(last_turn());
        if (!result_.converged) {
            progress_.note(
                fmt::format("warning: method {} had not settled after {} turns", stage, turn));
        }
    }

    [[nodiscard]] Estimate finish() {
        progress_.begin_stage("standard errors");
        finish_estimate(capture_, scene_, observations_, indirect_, fits_, {}, result_);
        progress_.end_stage();
        return std::move(result_);
    }

  private:
    // --- One turn --------------------------------------------------------------------------------

    IterationLog take_turn(const std::string& stage,
                           const IndirectLight& light,
                           bool has_maps,
                           int turn) {
        const bool settled = turn >= kSettleAfter;
        const std::size_t num_blocks = (num_texels_ + kParallelBlock - 1) / kParallelBlock;
        std::vector<TurnSums> sums(num_blocks);
        parallel_blocks(num_texels_, kParallelBlock, [&](std::size_t begin, std::size_t end) {
            std::vector<FitRow> rows;
            for (std::size_t i = begin; i < end; ++i) {
                rows_.make(i, light, result_.maps[i], rows);
                for (const FitRow& row : rows) {
                    sums[begin / kParallelBlock] +=
                        {(row.radiance - predict(row, result_.maps[i])).square().sum(), 3.0};
                }
                assign_classes(i, has_maps, settled, rows);
                fits_[i] = fit_texel(
                    rows, result_.maps[i], fits_[i], result_.noise_scale, settled, options_.fit);
            }
        });
        TurnSums total;
        for (const TurnSums& block : sums) total += block;
        if (!settled) update_noise_scale();
        refit_unconfirmed(light, drop_unconfirmed(capture_.atlas, fits_));
        fill_unmeasured(light);

        IterationLog log;
        log.stage = stage;
        log.error = total.count > 0 ? total.squared_error / total.count : 0;
        log.spectral_radius = light.spectral_radius;
        log.retraced = light.retraced;
        if (options_.loop == Loop::damped && !light.irradiance.empty()) {
            log.damping = std::max(kMinDamping, 1 - square(std::min(1.0, light.spectral_radius)));
        }
        // Indirect light seen through a lobe follows the lobe's own fit, which may answer by
        // swinging back.
        const bool swings = settled && options_.loop == Loop::damped;
        log.change = update_maps(log.damping, swings ? kLobeDamping * log.damping : log.damping);
        result_.iterations.push_back(log);
        return log;
    }

    // Once settled, a texel whose pixels still change their class is fitted by all of them at once.
    void assign_classes(std::size_t texel, bool has_maps, bool settled, std::vector<FitRow>& rows) {
        PixelClass* const stored = classes_.data() + observations_.begin[texel];
        bool& joint = fits_[texel].joint;
        if (!settled) joint = false;
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const PixelClass previous = stored[k];
            stored[k] =
                has_maps ? classify_by_share(rows[k], result_.maps[texel], previous, options_.fit)
                         : classify_by_angle(rows[k], options_.fit);
            if (settled && stored[k] != previous) joint = true;
        }
        set_classes(texel, rows);
        if (!has_diffuse_row(rows)) joint = true;
    }

    void set_classes(std::size_t texel, std::vector<FitRow>& rows) const {
        const PixelClass* const stored = classes_.data() + observations_.begin[texel];
        for (std::size_t k = 0; k < rows.size(); ++k) {
            rows[k].pixel_class = fits_[texel].joint ? PixelClass::neither : stored[k];
        }
    }

    void update_noise_scale() {
        std::vector<double> misfits;
        for (std::size_t i = 0; i < num_texels_; ++i) {
            if (fits_[i].observed && observations_.of(i).size() > 2)
                misfits.push_back(fits_[i].misfit);
        }
        if (!misfits.empty()) result_.noise_scale = std::sqrt(median(std::move(misfits)));
    }

    // --- Filling ---------------------------------------------------------------------------------

    void fill_unmeasured(const IndirectLight& light) {
        std::vector<std::uint8_t> observed(num_texels_), specular(num_texels_),
            roughness(num_texels_);
        std::vector<double> values(num_texels_);
        for (std::size_t i = 0; i < num_texels_; ++i) {
            observed[i] = fits_[i].observed;
            specular[i] = fits_[i].observed && fits_[i].specular_measured;
            roughness[i] = fits_[i].observed && fits_[i].roughness_measured;
        }
        const auto fill =
            [&](const std::vector<std::uint8_t>& known, double fallback, const auto& field) {
                for (std::size_t i = 0; i < num_texels_; ++i)
                    values[i] = field(fits_[i].reflectance);
                interpolate_linearly(capture_.atlas, known, fallback, values);
                for (std::size_t i = 0; i < num_texels_; ++i)
                    field(fits_[i].reflectance) = values[i];
            };
        for (const Eigen::Index channel : {0, 1, 2}) {
            fill(
                observed, 0.0, [channel](Reflectance& r) -> double& { return r.diffuse[channel]; });
        }
        fill(roughness, kInitialRoughness, [](Reflectance& r) -> double& { return r.roughness; });
        refit_matte(light, specular, roughness);
        // Ps sigma^2, half the lobe's albedo, is what varies slowly where sigma does not.
        for (std::size_t i = 0; i < num_texels_; ++i) {
            const Reflectance& fit = fits_[i].reflectance;
            values[i] = fit.specular * square(fit.roughness);
        }
        interpolate_linearly(capture_.atlas, specular, 0.0, values);
        for (std::size_t i = 0; i < num_texels_; ++i) {
            if (specular[i] != 0) continue;
            Reflectance& fit = fits_[i].reflectance;
            fit.specular = values[i] / square(fit.roughness);
        }
    }

    // Texels whose lobe was taken back: Pd again, with the lobe that they are filled with.
    void refit_unconfirmed(const IndirectLight& light, const std::vector<std::uint8_t>& dropped) {
        parallel_blocks(num_texels_, 256, [&](std::size_t begin, std::size_t end) {
            std::vector<FitRow> rows;
            for (std::size_t i = begin; i < end; ++i) {
                if (dropped[i] == 0) continue;
                rows_.make(i, light, result_.maps[i], rows);
                set_classes(i, rows);
                fits_[i].reflectance.diffuse = fit_diffuse(rows, result_.maps[i], options_.fit);
            }
        });
    }

    // Texels whose Ps is measured but not their sigma: Ps again, with the filled sigma.
    void refit_matte(const IndirectLight& light,
                     const std::vector<std::uint8_t>& specular,
                     const std::vector<std::uint8_t>& roughness) {
        parallel_blocks(num_texels_, 256, [&](std::size_t begin, std::size_t end) {
            std::vector<FitRow> rows;
            for (std::size_t i = begin; i < end; ++i) {
                if (specular[i] == 0 || roughness[i] != 0) continue;
                rows_.make(i, light, result_.maps[i], rows);
                Reflectance& fitted = fits_[i].reflectance;
                fitted.specular = fit_specular_at(rows, fitted.diffuse, fitted.roughness).specular;
            }
        });
    }

    // Moves the maps towards the fits; returns the relative change.
    double update_maps(double damping, double lobe_damping) {
        const auto move = [&](std::size_t i) {
            Reflectance& map = result_.maps[i];
            const Reflectance& fit = fits_[i].reflectance;
            Reflectance next;
            next.diffuse = map.diffuse + damping * (fit.diffuse - map.diffuse);
            next.specular = map.specular + lobe_damping * (fit.specular - map.specular);
            next.roughness = map.roughness + lobe_damping * (fit.roughness - map.roughness);
            return move_map(map, next);
        };
        const auto change = ordered_reduce(num_texels_, MapChange(), move);
        result_.num_clamped = change.num_clamped;
        return change.relative();
    }

    [[nodiscard]] std::string last_turn() const {
        const IterationLog& log = result_.iterations.back();
        return fmt::format(
            "{} turns, E {:.3g}, change {:.1e}, lambda {:.2f}",
            std::count_if(result_.iterations.begin(),
                          result_.iterations.end(),
                          [&](const IterationLog& other) { return other.stage == log.stage; }),
            log.error,
            log.change,
            log.spectral_radius);
    }

    const Capture& capture_;
    const SceneView& scene_;
    const Observations& observations_;
    FitRowMaker rows_;
    const EstimateOptions& options_;
    Progress& progress_;
    std::size_t num_texels_;
    std::vector<PixelClass> classes_;  // per row of the observations
    std::vector<TexelFit> fits_;
    IndirectLight indirect_;
    Estimate result_;
};

void require(bool holds, const std::string& option, const std::string& expected) {
    if (!holds) throw Error(option, "", "is out of range", expected);
}

}  // namespace

void validate(const EstimateOptions& options) {
    require(options.photons.photons >= 2 && options.photons.photons <= 1'000'000'000,
            "--photons",
            "2 to 1000000000");
    // See GatherOptions: two halves of equal size, of each of which a half goes on.
    require(options.gather.rays >= 4 && options.gather.rays % 4 == 0,
            "--gather-rays",
            "a multiple of 4");
    require(options.gather.lobe_rays >= 8 && options.gather.lobe_rays % 8 == 0,
            "--lobe-rays",
            "a multiple of 8");
    if (!options.graph_file.empty() && options.method != Method::gather) {
        throw Error("--graph", "", "is of no use to this method", "--method gather");
    }
    if (options.memory && options.method != Method::gather) {
        throw Error("--memory", "", "is not known to this method", "--method gather");
    }
    require(options.max_iterations >= 1, "--iterations", "1 or more");
    require(options.threshold >= 0, "--threshold", "0 or more");
    require(options.tolerance > 0, "--tolerance", "a number above 0");
}

Estimate estimate_reflectance(const Capture& capture,
                              const EstimateOptions& options,
                              Progress& progress) {
    validate(options);
    // By all threads; at the first call inside of a loop one would build it and the others wait.
    static_cast<void>(albedo_table());
    progress.begin_stage("acceleration structure");
    const Tracer tracer(capture.mesh);
    const Surface surface{&capture.mesh, &tracer};
    progress.end_stage(fmt::format("{} triangles", capture.mesh.triangles.size()));
    if (options.method == Method::gather) {
        return estimate_by_gathering(capture, surface, options, progress);
    }
    const SceneView scene = view_scene(capture, surface, progress);
    const Observations observations =
        collect_observations(capture, scene, options.observations, progress);
    Iteration iteration(capture, scene, observations, options, progress);
    iteration.run_direct();
    if (options.method != Method::direct) {
        PhotonEngine engine(surface, capture.atlas, scene, options, progress);
        const bool is_start = options.method == Method::photon;
        iteration.run_indirect(
            engine, "diffuse", false, options.tolerance * (is_start ? kStartTolerance : 1.0));
        if (is_start) iteration.run_indirect(engine, "photon", true, options.tolerance);
    }
    Estimate estimate = iteration.finish();
    if (capture.description.radiometry.scale_unknown) {
        estimate.scale.emplace().reason = "only method gather looks for it";
        progress.note(untold_note(*estimate.scale));
    }
    return estimate;
}

}  // namespace patina
