#include "patina/estimate/informed_lobe.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace patina {
namespace {

// Lobes that never differ are still not known better than this [-].
constexpr double kLeastSpread = 1e-6;
// Of measured lobes, to judge evidence by.
constexpr std::size_t kFewestJudges = 50;
constexpr std::array<double, 4> kEvidenceWeights = {1, 1.0 / 4, 1.0 / 16, 1.0 / 64};

// Each texel's evidence and, with their links, its neighbours'.
LargeVector<LobeEvidence> with_neighbors(const TexelAtlas& atlas,
                                         std::span<const float> links,
                                         const LargeVector<LobeEvidence>& evidence) {
    LargeVector<LobeEvidence> sums = evidence;
    parallel_for(sums.size(), [&](std::size_t i) {
        for (std::uint32_t k = atlas.neighbor_begin[i]; k < atlas.neighbor_begin[i + 1]; ++k) {
            LobeEvidence of_neighbor = evidence[atlas.neighbors[k]];
            of_neighbor *= double(links[k]);
            sums[i] += of_neighbor;
        }
    });
    return sums;
}

Eigen::Matrix2d precision_of(const LobeSpread& spread) {
    return LogLobe(1 / square(std::max(spread.specular_albedo, kLeastSpread)),
                   1 / square(std::max(spread.roughness, kLeastSpread)))
        .asDiagonal();
}

}  // namespace

LogLobe log_lobe(const Reflectance& reflectance) {
    const double log_roughness = std::log(reflectance.roughness);
    return {std::log(reflectance.specular) + 2 * log_roughness, log_roughness};
}

Eigen::Matrix2d by_log_lobe(const Reflectance& reflectance) {
    Eigen::Matrix2d derivative;
    derivative << reflectance.specular, -2 * reflectance.specular, 0, reflectance.roughness;
    return derivative;
}

LobeEvidence& LobeEvidence::operator+=(const LobeEvidence& other) {
    information += other.information;
    pull += other.pull;
    return *this;
}

LobeEvidence& LobeEvidence::operator*=(double factor) {
    information *= factor;
    pull *= factor;
    return *this;
}

LobeEvidence lobe_evidence(std::span<const FitRow> rows,
                           const Reflectance& reflectance,
                           const LogLobe& filled,
                           double noise_scale) {
    LobeEvidence evidence;
    Rgb hh = Rgb::Zero();
    std::array<Rgb, 2> hx = {Rgb::Zero(), Rgb::Zero()};
    for (const FitRow& row : rows) {
        const Rgb h = row.irradiance / kPi;
        const LobeBasis lobe = lobe_basis_and_slope(row, reflectance.roughness);
        const double specular = reflectance.specular / kPi;
        const Rgb residual = row.radiance - reflectance.diffuse * h - specular * lobe.whole;
        // Change with ln(Ps sigma^2), sigma given, and with ln sigma, Ps sigma^2 given.
        const std::array<Rgb, 2> x = {
            specular * lobe.direct,
            specular * (reflectance.roughness * lobe.by_roughness - 2 * lobe.direct)};
        hh += row.weight * h * h;
        for (std::size_t a = 0; a < 2; ++a) {
            const Rgb weighted = row.weight * x[a];
            hx[a] += weighted * h;
            evidence.pull[Eigen::Index(a)] += (weighted * residual).sum();
            for (std::size_t b = 0; b < 2; ++b) {
                evidence.information(Eigen::Index(a), Eigen::Index(b)) += (weighted * x[b]).sum();
            }
        }
    }
    for (std::size_t a = 0; a < 2; ++a) {
        for (std::size_t b = 0; b < 2; ++b) {
            const Rgb taken = (hh > 0).select(hx[a] * hx[b] / hh, 0.0);
            evidence.information(Eigen::Index(a), Eigen::Index(b)) -= taken.sum();
        }
    }
    evidence.pull += evidence.information * (log_lobe(reflectance) - filled);
    evidence *= 1 / square(noise_scale);
    return evidence;
}

void pool_evidence(const TexelAtlas& atlas,
                   std::span<const float> links,
                   LargeVector<LobeEvidence>& evidence) {
    PATINA_CHECK_EQ(links.size(), atlas.neighbors.size());
    evidence = with_neighbors(atlas, links, with_neighbors(atlas, links, evidence));
    parallel_for(evidence.size(), [&](std::size_t i) {
        double ways_back = 1;
        for (std::uint32_t k = atlas.neighbor_begin[i]; k < atlas.neighbor_begin[i + 1]; ++k) {
            ways_back += square(double(links[k]));
        }
        evidence[i] *= 1 / ways_back;
    });
}

Eigen::Matrix2d informed_covariance(const LobeSpread& spread, const Eigen::Matrix2d& information) {
    return (precision_of(spread) + information).inverse();
}

void add_filled_errors(const LobeSpread& spread,
                       const Eigen::Matrix2d& information,
                       const Eigen::Matrix<double, 3, 2>& diffuse_by_lobe,
                       const Reflectance& map,
                       Reflectance& error) {
    // Where no lobe was measured at all, any may be there.
    const Eigen::Matrix2d lobe = informed_covariance(
        {std::min(spread.specular_albedo, 1.0), std::min(spread.roughness, 1.0)}, information);
    const Eigen::Array3d by_lobe =
        (diffuse_by_lobe * lobe * diffuse_by_lobe.transpose()).diagonal().array();
    error.diffuse = (error.diffuse.square() + by_lobe).sqrt();
    error.specular = error.roughness = std::numeric_limits<double>::infinity();
    if (!std::isfinite(spread.specular_albedo) || !std::isfinite(spread.roughness)) return;
    const Eigen::Matrix2d known = informed_covariance(spread, information);
    error.specular = map.specular * std::sqrt(known(0, 0) - 4 * known(0, 1) + 4 * known(1, 1));
    error.roughness = map.roughness * std::sqrt(known(1, 1));
}

double evidence_weight(std::span<const LobeEvidence> evidence, const LobeSpread& spread) {
    if (evidence.size() < kFewestJudges) return 0;
    const Eigen::Matrix2d precision = precision_of(spread);
    double best = 0;
    double least = 2.0 * double(evidence.size());  // the filling alone, in units of its variances
    for (const double weight : kEvidenceWeights) {
        double sum = 0;
        for (LobeEvidence of_texel : evidence) {
            of_texel *= weight;
            const Eigen::Matrix2d covariance = informed_covariance(spread, of_texel.information);
            const Eigen::Matrix2d left = covariance * precision;  // of an error of the filling
            const LogLobe wrong = covariance * of_texel.pull;
            sum += (left * left).trace() + wrong.dot(precision * wrong);
        }
        if (sum < least) {
            least = sum;
            best = weight;
        }
    }
    return best;
}

LogLobe informed_lobe(const LogLobe& filled,
                      const LobeSpread& spread,
                      const LobeEvidence& evidence) {
    return filled + informed_covariance(spread, evidence.information) * evidence.pull;
}

}  // namespace patina
