#include "patina/estimate/self_calibration.h"

#include "patina/math/statistics.h"

#include <Eigen/Cholesky>

#include <algorithm>

namespace patina {
namespace {

// The scores' scatter is taken about what is found, and what is found depends on it; after so many
// rounds both stand to a thousandth.
constexpr int kRounds = 8;
// What is found is believed unless stated errors would be as large once in a million captures: then
// the residuals tell of something else (surfaces of another kind, a wrong mesh).
constexpr double kIncredible = 1e-6;
// Keeps the scores' covariance regular, as a share of its mean [-].
constexpr double kRegular = 1e-9;

// A change with what it pulls the texel's own parameters by. Most lamps change one row alone.
struct Pulled {
    const SharedChange* change;
    std::size_t begin, end;  // rows that it changes
    Parameters pull;
    Parameters response;
};

Pulled pulled(const SharedChange& change, const ErrorPropagation& propagation) {
    const auto is_changed = [](const Rgb& value) { return (value != 0).any(); };
    const auto& values = change.radiance;
    const auto first = std::find_if(values.begin(), values.end(), is_changed);
    const auto last = std::find_if(values.rbegin(), values.rend(), is_changed).base();
    return {&change,
            std::size_t(first - values.begin()),
            std::size_t(std::max(first, last) - values.begin()),
            propagation.pull(values),
            propagation.response(values)};
}

// Sum over rows and channels of weight a b.
double product(std::span<const FitRow> rows,
               std::size_t begin,
               std::size_t end,
               const std::vector<Rgb>& a,
               const std::vector<Rgb>& b) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += (rows[k].weight * a[k] * b[k]).sum();
    return sum;
}

}  // namespace

std::size_t SelfCalibration::patch_of(const TexelAtlas& atlas, std::size_t texel) {
    const Texel& at = atlas.texels[texel];
    const auto row = std::size_t(at.row) * kPatchesPerSide / std::size_t(atlas.height);
    const auto column = std::size_t(at.column) * kPatchesPerSide / std::size_t(atlas.width);
    return row * kPatchesPerSide + column;
}

SelfCalibration::SelfCalibration(std::size_t num_errors)
    : num_errors_(num_errors), patches_(kNumPatches) {}

void SelfCalibration::add(std::size_t patch,
                          std::span<const FitRow> rows,
                          const ErrorPropagation& propagation,
                          std::span<const SharedChange> changes) {
    // More unknowns than patches: nothing will be told, so no memory is taken.
    if (changes.empty() || num_errors_ + 2 >= kNumPatches) return;
    const auto size = Eigen::Index(num_errors_);
    auto& [score, information] = patches_[patch];
    if (score.size() == 0) {
        score = Eigen::VectorXd::Zero(size);
        information = Eigen::MatrixXd::Zero(size, size);
    }
    const std::vector<Rgb>& residuals = propagation.residuals();
    const Parameters residual_pull = propagation.pull(residuals);
    std::vector<Pulled> all;
    for (const SharedChange& change : changes) all.push_back(pulled(change, propagation));
    for (const Pulled& a : all) {
        const auto i = Eigen::Index(a.change->error);
        score[i] += product(rows, a.begin, a.end, a.change->radiance, residuals) -
                    a.response.dot(residual_pull);
        for (const Pulled& b : all) {
            const std::size_t begin = std::max(a.begin, b.begin);
            const std::size_t end = std::min(a.end, b.end);
            information(i, Eigen::Index(b.change->error)) +=
                product(rows, begin, end, a.change->radiance, b.change->radiance) -
                a.pull.dot(b.response);
        }
    }
}

// Summed over patches the scores are s = A x + u for shared errors x, with cov(u) = B from the
// scatter of the patches' scores about A_patch x; x is normal with covariance 1 beforehand. An
// inverse of a covariance of n samples in d dimensions is too large by (n - 1) / (n - d - 2).
SharedErrors SelfCalibration::solve() const {
    const auto size = Eigen::Index(num_errors_);
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(size, size);
    SharedErrors errors{Eigen::VectorXd::Zero(size), identity};
    Eigen::VectorXd score = Eigen::VectorXd::Zero(size);
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
    double num_patches = 0;
    for (const Patch& patch : patches_) {
        if (patch.score.size() == 0) continue;
        score += patch.score;
        information += patch.information;
        num_patches += 1;
    }
    const double freedom = num_patches - double(size) - 2;
    if (!(freedom > 0) || !(information.trace() > 0)) return errors;
    const double too_large = (num_patches - 1) / freedom;
    for (int round = 0; round < kRounds; ++round) {
        Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(size, size);
        for (const Patch& patch : patches_) {
            if (patch.score.size() == 0) continue;
            const Eigen::VectorXd left = patch.score - patch.information * errors.value;
            scatter += left * left.transpose();
        }
        scatter += kRegular * scatter.trace() / double(size) * identity;
        // B^-1 A, with B enlarged so that its inverse is right in the mean.
        const Eigen::MatrixXd gain = scatter.ldlt().solve(information) / too_large;
        const Eigen::MatrixXd precision = identity + information * gain;
        errors.covariance = (0.5 * (precision + precision.transpose())).ldlt().solve(identity);
        errors.value = errors.covariance * (gain.transpose() * score);
    }
    if (chi_square_survival(errors.value.squaredNorm(), double(size)) < kIncredible) {
        return {Eigen::VectorXd::Zero(size), identity};
    }
    return errors;
}

}  // namespace patina
