// Method gather's filled lobes, corrected by what looks tell of them. docs/theory.md, "Filling".
#include "patina/base/parallel.h"
#include "patina/estimate/gather_iteration.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// A filled lobe heeds looks that lie no further than this from the mirror direction [sigma], and
// moves by so much in a turn at most [log].
constexpr double kInformedReach = 3.0;
constexpr double kLongestStep = 0.5;
constexpr double kTurnedStep = 0.5;
constexpr double kGrowth = 1.1;
constexpr double kLeastGain = 1.0 / 16;
// The filling must say how bright a look at that angle is within this factor [log], or there is
// nothing near enough to start from.
constexpr double kVaguestFilling = 1.0;
constexpr std::size_t kBlock = 256;
// Of squares of so many texels, which hang together for pooling, one in so many is called to judge.
constexpr int kJudgeSquare = 16;
constexpr int kJudgeStride = 5;

bool is_called(const Texel& texel) {
    const int column = texel.column / kJudgeSquare;
    const int row = texel.row / kJudgeSquare;
    return (column + 2 * row) % kJudgeStride == 0;
}

}  // namespace

void GatherIteration::ask_neighbors(bool frozen) {
    if (!frozen) between_neighbors_ = neighbor_spread(atlas_, fits_);
    priors_ = neighbor_priors(atlas_, lobe_filling_.links(), fits_, between_neighbors_);
}

void GatherIteration::inform_filled(const IndirectLight& light, bool frozen) {
    if (!frozen) {
        lobe_filling_.find_spread(fits_);
        choose_informed();
        trust_ = trust_in_looks(light);
        if (trust_ == 0) {
            parallel_for(num_texels_, [&](std::size_t i) { fits_[i].informed = false; });
        }
    }
    parallel_for(num_texels_, [&](std::size_t i) {
        if (!fits_[i].roughness_measured) fits_[i].lobe_information.setZero();
    });
    if (trust_ == 0) return;
    LargeVector<LobeEvidence> evidence = evidence_of_looks(light);
    pool_evidence(atlas_, lobe_filling_.links(), evidence);
    take_informed(light, evidence, frozen);
}

// Texels with a filled lobe that some look reaches, unless their looks were fitted by a stray one.
void GatherIteration::choose_informed() {
    parallel_for(num_texels_, [&](std::size_t i) {
        TexelFit& fit = fits_[i];
        const double reach = kInformedReach * fit.reflectance.roughness;
        const auto looks = observations_.of(i);
        const bool was_informed = fit.informed;
        fit.informed = fit.observed && !fit.specular_measured && dropped_[i] == 0 &&
                       lobe_filling_.has_lobe(i) && result_.maps[i].specular > 0 &&
                       std::isfinite(lobe_filling_.spread(i).roughness) &&
                       std::any_of(looks.begin(), looks.end(), [reach](const Observation& look) {
                           return double(look.theta_r) < reach;
                       });
        if (fit.informed && !was_informed) {
            fit.informed_step.setZero();
            fit.informed_gain.setOnes();
        }
    });
}

// Measured lobes are the judges: what the looks outside of each, as filled lobes have them, say of
// it.
double GatherIteration::trust_in_looks(const IndirectLight& light) const {
    LobeSpread spread = {0, 0};
    double num_informed = 0;
    for (std::size_t i = 0; i < num_texels_; ++i) {
        if (!fits_[i].informed) continue;
        spread.specular_albedo += square(lobe_filling_.spread(i).specular_albedo);
        spread.roughness += square(lobe_filling_.spread(i).roughness);
        num_informed += 1;
    }
    if (num_informed == 0) return 0;
    spread = {std::sqrt(spread.specular_albedo / num_informed),
              std::sqrt(spread.roughness / num_informed)};
    // Of ln(Ps exp(-theta^2 / (2 sigma^2))), Ps sigma^2 and sigma off by their standard errors.
    const double by_roughness = square(kInformedReach) - 2;
    if (std::hypot(spread.specular_albedo, by_roughness * spread.roughness) > kVaguestFilling) {
        return 0;
    }
    LargeVector<LobeEvidence> evidence(num_texels_);
    std::vector<std::uint8_t> is_judge(num_texels_, 0);
    parallel_blocks(num_texels_, kBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<FitRow> rows;
        JointFit joint;
        for (std::size_t i = begin; i < end; ++i) {
            const TexelFit& fit = fits_[i];
            if (!is_called(atlas_.texels[i]) || !fit.observed || !fit.roughness_measured ||
                !(fit.reflectance.specular > 0)) {
                continue;
            }
            make_rows(i, light, rows);
            std::erase_if(rows, [&](const FitRow& row) {
                return row.theta_r < kInsideLobe * fit.reflectance.roughness;
            });
            if (!has_look_inside(rows, fit.reflectance.roughness, kInformedReach)) continue;
            joint.load(rows);
            Reflectance seen = fit.reflectance;
            seen.diffuse = joint.diffuse_with(seen.specular, seen.roughness);
            evidence[i] =
                lobe_evidence(rows, seen, log_lobe(seen), noise_scale_of(fit, result_.noise_scale));
            is_judge[i] = 1;
        }
    });
    pool_evidence(atlas_, lobe_filling_.links(), evidence);
    std::vector<LobeEvidence> judges;
    for (std::size_t i = 0; i < num_texels_; ++i) {
        if (is_judge[i] != 0) judges.push_back(evidence[i]);
    }
    return evidence_weight(judges, spread);
}

LargeVector<LobeEvidence> GatherIteration::evidence_of_looks(const IndirectLight& light) const {
    LargeVector<LobeEvidence> evidence(num_texels_);
    parallel_blocks(num_texels_, kBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<FitRow> rows;
        for (std::size_t i = begin; i < end; ++i) {
            const TexelFit& fit = fits_[i];
            if (!fit.informed) continue;
            make_rows(i, light, rows);
            const Reflectance& last = result_.maps[i];
            evidence[i] = lobe_evidence(rows,
                                        {fit.reflectance.diffuse, last.specular, last.roughness},
                                        lobe_filling_.lobe(i),
                                        noise_scale_of(fit, result_.noise_scale));
            evidence[i] *= trust_;
        }
    });
    return evidence;
}

void GatherIteration::take_informed(const IndirectLight& light,
                                    std::span<const LobeEvidence> evidence,
                                    bool frozen) {
    parallel_blocks(num_texels_, kBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<FitRow> rows;
        JointFit joint;
        for (std::size_t i = begin; i < end; ++i) {
            TexelFit& fit = fits_[i];
            if (!fit.informed) continue;
            const LogLobe last = log_lobe(result_.maps[i]);
            LogLobe step =
                informed_lobe(lobe_filling_.lobe(i), lobe_filling_.spread(i), evidence[i]) - last;
            // What does not come to rest is left to the filling.
            if (frozen && step.cwiseAbs().maxCoeff() > kLongestStep) {
                fit.informed = false;
                continue;
            }
            step = step.cwiseMax(-kLongestStep).cwiseMin(kLongestStep);
            // Steps too long would lead to and fro about the lobe sought: of one that leads back
            // by more than this share of the last, and of later ones, only that share is taken,
            // and again more from turn to turn while they lead ahead.
            for (const Eigen::Index k : {0, 1}) {
                const double before = fit.informed_step[k];
                double gain = fit.informed_gain[k];
                if (-gain * step[k] * before > kTurnedStep * square(before)) {
                    gain = std::max(kLeastGain, kTurnedStep * gain);
                } else if (step[k] * before > 0) {
                    gain = std::min(1.0, kGrowth * gain);
                }
                step[k] *= gain;
                fit.informed_gain[k] = float(gain);
            }
            fit.informed_step = step.cast<float>();
            const LogLobe lobe = last + step;
            fit.reflectance.roughness =
                std::clamp(std::exp(lobe[1]), options_.fit.min_roughness, kMaxRoughness);
            fit.reflectance.specular = std::exp(lobe[0]) / square(fit.reflectance.roughness);
            fit.lobe_information = evidence[i].information.cast<float>();
            make_rows(i, light, rows);
            joint.load(rows);
            fit.reflectance.diffuse =
                joint.diffuse_with(fit.reflectance.specular, fit.reflectance.roughness);
        }
    });
}

}  // namespace patina
