#include "patina/estimate/error_propagation.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>

namespace patina {
namespace {

constexpr int kSpecular = 3;
constexpr int kRoughness = 4;
// Information below this share of the largest counts as none.
constexpr double kNoInformation = 1e-12;

int num_free(KnownLobe known) {
    switch (known) {
        case KnownLobe::all:
            return 5;
        case KnownLobe::specular:
            return 4;
        case KnownLobe::none:
            return 3;
    }
    return 3;
}

}  // namespace

ResidualMoments& ResidualMoments::operator+=(const ResidualMoments& other) {
    own += other.own;
    shared += other.shared;
    freedom += other.freedom;
    return *this;
}

double ResidualMoments::shared_variance() const {
    // Six ordered pairs of channels for three squares.
    return freedom > 0 ? std::clamp(0.5 * shared, 0.0, own) / freedom : 0;
}

double ResidualMoments::own_variance() const {
    return freedom > 0 ? own / freedom - shared_variance() : 0;
}

ErrorPropagation::ErrorPropagation(std::span<const FitRow> rows,
                                   const Reflectance& fitted,
                                   KnownLobe known)
    : rows_(rows), residuals_(rows.size()), jacobians_(rows.size()) {
    const int free = num_free(known);
    Covariance information = Covariance::Zero();
    Covariance shared = Covariance::Zero();
    for (std::size_t j = 0; j < rows.size(); ++j) {
        const FitRow& row = rows[j];
        const Rgb h = row.irradiance / kPi;
        const Rgb b = lobe_basis(row, fitted.roughness) / kPi;
        const Rgb d = fitted.specular * direct_lobe_basis_by_roughness(row, fitted.roughness) / kPi;
        residuals_[j] = row.radiance - predict(row, fitted);
        Jacobian& jacobian = jacobians_[j];
        jacobian.setZero();
        Parameters sum = Parameters::Zero();
        for (int c = 0; c < 3; ++c) {
            jacobian(c, c) = h[c];
            if (free > kSpecular) jacobian(kSpecular, c) = b[c];
            if (free > kRoughness) jacobian(kRoughness, c) = d[c];
            const Parameters column = jacobian.col(c);
            information += row.weight[c] * column * column.transpose();
            sum += std::sqrt(row.weight[c]) * column;
        }
        shared += sum * sum.transpose();
    }
    // A channel's Pd is its own; the lobe's parameters are shared by the three channels.
    moments_.freedom =
        std::max(0.0, 3.0 * (double(rows.size()) - 1.0 - double(free - kSpecular) / 3.0));
    const double largest = information.diagonal().maxCoeff();
    for (int k = 0; k < kNumParameters; ++k) {
        // Not free, or not told: the large information makes the response to it vanish.
        if (information(k, k) <= kNoInformation * largest) information(k, k) = 1e30;
    }
    inverse_ = information.ldlt().solve(Covariance::Identity());
    own_variance_ = inverse_.diagonal().cwiseMax(0.0);
    shared_covariance_ = inverse_ * shared * inverse_;
    shared_variance_ = shared_covariance_.diagonal().cwiseMax(0.0);
    leave_least_residuals();
    for (std::size_t j = 0; j < rows.size(); ++j) {
        const Rgb z = rows[j].weight.sqrt() * residuals_[j];
        moments_.own += z.square().sum();
        moments_.shared += square(z.sum()) - z.square().sum();
    }
}

// A lobe that was drawn towards its neighbours' explains its own looks less well than it might.
void ErrorPropagation::leave_least_residuals() {
    const Parameters step = response(residuals_);
    for (std::size_t j = 0; j < rows_.size(); ++j) {
        residuals_[j] -= (jacobians_[j].transpose() * step).array();
    }
}

Parameters ErrorPropagation::pull(std::span<const Rgb> radiance_change) const {
    Parameters sum = Parameters::Zero();
    for (std::size_t j = 0; j < rows_.size(); ++j) {
        sum += jacobians_[j] * (rows_[j].weight * radiance_change[j]).matrix();
    }
    return sum;
}

Parameters ErrorPropagation::response(std::span<const Rgb> radiance_change) const {
    return inverse_ * pull(radiance_change);
}

// C - C E (I + P E' C E)^-1 P E' C, E the columns of Ps and sigma, P the other information
// (Woodbury).
Parameters ErrorPropagation::share_beside(const Eigen::Matrix2d& information,
                                          double noise_scale) const {
    const Covariance covariance = square(noise_scale) * inverse_;
    const Eigen::Matrix<double, kNumParameters, 2> by_lobe = covariance.middleCols<2>(kSpecular);
    const Eigen::Matrix2d told = information * by_lobe.middleRows<2>(kSpecular);
    const Eigen::Matrix2d taken = (Eigen::Matrix2d::Identity() + told).inverse() * information;
    const Eigen::Array<double, kNumParameters, 1> before = covariance.diagonal().array();
    const Eigen::Array<double, kNumParameters, 1> left =
        before - (by_lobe * taken * by_lobe.transpose()).diagonal().array();
    // A lobe so ill told that rounding decides is not told by others either.
    if (!(before > 0).all() || !left.allFinite()) return Parameters::Ones();
    return (left / before).max(0.0).min(1.0);
}

// The fit takes off a part of every residual, z = (I - H) e with H = D' M D, D = J W^(1/2), M the
// inverse of the information; so cov(z_k) is I - H_kk for independent e of variance 1, and
// S - H_kk S - S H_kk + D_k' M (sum_j D_j S D_j') M D_k for e alike in the channels, S all ones.
InfluenceMoments ErrorPropagation::influence() const {
    const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d ones = Eigen::Matrix3d::Ones();
    InfluenceMoments moments;
    for (std::size_t j = 0; j < rows_.size(); ++j) {
        const Eigen::Array3d root = rows_[j].weight.sqrt();
        const Jacobian weighted = jacobians_[j] * root.matrix().asDiagonal();
        const Jacobian gain = inverse_ * weighted;
        const Eigen::Matrix3d hat = weighted.transpose() * gain;
        const Eigen::Matrix3d shared =
            ones - hat * ones - ones * hat + weighted.transpose() * shared_covariance_ * weighted;
        moments.found += (gain * (root * residuals_[j]).matrix()).cwiseAbs2();
        moments.by_own += (gain * (identity - hat) * gain.transpose()).diagonal();
        moments.by_shared += (gain * shared * gain.transpose()).diagonal();
    }
    return moments;
}

}  // namespace patina
