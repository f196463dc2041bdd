#include "patina/estimate/drawn_lobe.h"

#include "patina/base/random.h"

#include <gtest/gtest.h>

#include "support/scenes.h"
#include <cmath>
#include <vector>

namespace patina {
namespace {

constexpr int kSide = 64;
constexpr double kOwnError = 0.1;  // of ln sigma; half as much of ln(Ps sigma^2), independent

class DrawnLobes : public testing::Test {
  protected:
    DrawnLobes() : fits_(atlas_.texels.size()), links_(atlas_.neighbors.size(), 1.0f) {
        for (std::size_t i = 0; i < fits_.size(); ++i) set_lobe(i, truth_);
    }

    void set_lobe(std::size_t i, const LogLobe& lobe) {
        TexelFit& fit = fits_[i];
        fit.reflectance = {
            Rgb::Constant(0.5), std::exp(lobe[0]) / square(std::exp(lobe[1])), std::exp(lobe[1])};
        fit.observed = fit.specular_measured = fit.roughness_measured = true;
        fit.lobe_information =
            LogLobe(4 / square(kOwnError), 1 / square(kOwnError)).cast<float>().asDiagonal();
        state_error_of(i, kOwnError);
    }
    void state_error_of(std::size_t i, double error) {
        fits_[i].specular_error = error * fits_[i].reflectance.specular;
        fits_[i].roughness_error = error * fits_[i].reflectance.roughness;
    }
    void add_noise() {
        for (std::size_t i = 0; i < fits_.size(); ++i) {
            Rng rng(1, Pass::tests, i);
            LogLobe noisy = log_lobe(fits_[i].reflectance);
            noisy[0] += 0.5 * kOwnError * rng.normal();
            noisy[1] += kOwnError * rng.normal();
            set_lobe(i, noisy);
        }
    }

    [[nodiscard]] LogLobe drawn(const LargeVector<LobePrior>& priors, std::size_t i) const {
        return drawn_lobe(log_lobe(fits_[i].reflectance), information(i), priors[i]);
    }
    // What is left of the variance of ln sigma.
    [[nodiscard]] double share(const LargeVector<LobePrior>& priors, std::size_t i) const {
        const Eigen::Matrix2d left = (information(i) + priors[i].precision).inverse();
        return left(1, 1) / information(i).inverse()(1, 1);
    }
    [[nodiscard]] Eigen::Matrix2d information(std::size_t i) const {
        return fits_[i].lobe_information.cast<double>();
    }

    TexelAtlas atlas_ =
        build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), kSide, kSide);
    LogLobe truth_ = {std::log(0.01), std::log(0.15)};
    std::vector<TexelFit> fits_;
    std::vector<float> links_;
};

TEST_F(DrawnLobes, NeighborsOfOneMaterialDifferByTheirErrorsAlone) {
    add_noise();
    // Twice the squared error of 0.1, from 8000 pairs, two of a texel's at a time: 3 % of it.
    const double five_sigma = 5 * 0.03 * 2 * square(kOwnError);
    EXPECT_LT(square(neighbor_spread(atlas_, fits_).roughness), five_sigma);
    // Even where the errors are stated four times too small.
    for (std::size_t i = 0; i < fits_.size(); ++i) state_error_of(i, 0.25 * kOwnError);
    EXPECT_NEAR(square(neighbor_spread(atlas_, fits_).roughness),
                2 * square(kOwnError) * (1 - square(0.25)),
                five_sigma);
}

TEST_F(DrawnLobes, NeighborsDifferOnASlopeHoweverLargeTheStatedErrors) {
    constexpr double kSlope = 0.02;
    for (std::size_t i = 0; i < fits_.size(); ++i) {
        set_lobe(i, truth_ + LogLobe(0, kSlope * atlas_.texels[i].column));
    }
    // Half of the pairs lie along the columns and do not differ.
    EXPECT_NEAR(neighbor_spread(atlas_, fits_).roughness, kSlope / std::sqrt(2.0), 0.02 * kSlope);
    EXPECT_NEAR(neighbor_spread(atlas_, fits_).specular_albedo, 0, 1e-6);
}

TEST_F(DrawnLobes, TooFewSayNothing) {
    for (std::size_t i = 10; i < fits_.size(); ++i) fits_[i].roughness_measured = false;
    EXPECT_TRUE(std::isinf(neighbor_spread(atlas_, fits_).roughness));
    EXPECT_TRUE(std::isinf(neighbor_spread(atlas_, fits_).specular_albedo));
    const LobePrior prior =
        neighbor_priors(atlas_, links_, fits_, neighbor_spread(atlas_, fits_)).front();
    EXPECT_TRUE(prior.precision.isZero());
}

TEST_F(DrawnLobes, StayAsTheyAreWithoutNeighbors) {
    const LargeVector<LobePrior> none(fits_.size());
    EXPECT_LT((drawn(none, 0) - truth_).norm(), 1e-6);
    EXPECT_NEAR(share(none, 0), 1, 1e-9);
}

// One material, every lobe known with the same errors.
TEST_F(DrawnLobes, KeepTheShareOfTheirErrorsThatIsSaid) {
    add_noise();
    const LargeVector<LobePrior> priors = neighbor_priors(atlas_, links_, fits_, {0, 0});
    LogLobe squares = LogLobe::Zero();
    double shares = 0;
    double count = 0;
    for (std::size_t i = 0; i < fits_.size(); ++i) {
        const Texel& texel = atlas_.texels[i];
        if (std::min(texel.column, texel.row) < 2) continue;
        if (std::max(texel.column, texel.row) >= kSide - 2) continue;
        shares += share(priors, i);
        squares += (drawn(priors, i) - truth_).cwiseAbs2();
        count += 1;
    }
    // 13 texels alike, but for neighbours that differ by chance: the squared distance d of two
    // numbers is chi-square with two degrees of freedom, and the mean of min(1, 4 / d) is
    // 1 - exp(-2) + 2 E_1(2) = 0.962. The mean of the inverse lies above the inverse of the mean by
    // a few thousandths.
    EXPECT_NEAR((1 + 12 * 0.962) * shares / count, 1, 0.02);
    // Means of 13 texels, so that there are a thirteenth as many independent ones.
    const double five_sigma = 5 * std::sqrt(2.0 / (count / 13));
    EXPECT_NEAR(squares[1] / shares / square(kOwnError), 1, five_sigma);
    EXPECT_NEAR(squares[0] / shares / square(0.5 * kOwnError), 1, five_sigma);
}

TEST_F(DrawnLobes, HeedWeakLinksLess) {
    add_noise();
    const LobeSpread between = {0.05, 0.05};
    const std::vector<float> weak(links_.size(), 0.01f);
    const auto share_with = [&](const std::vector<float>& links) {
        return share(neighbor_priors(atlas_, links, fits_, between), fits_.size() / 2 + kSide / 2);
    };
    // Precisions over the own one, e^2 / (e^2 + (s d)^2): at most 4 / 1.25 + 8 / 2 = 7.2, and over
    // weak links 4 / 26 + 8 / 101 = 0.23; by half less if many differ by chance.
    EXPECT_GT(share_with(links_), 1 / 8.3);
    EXPECT_LT(share_with(links_), 1 / 4.6);
    EXPECT_GT(share_with(weak), 1 / 1.24);
    EXPECT_LT(share_with(weak), 1 / 1.11);
}

TEST_F(DrawnLobes, DoNotReachOverABorder) {
    add_noise();
    const auto is_left = [&](std::size_t i) { return atlas_.texels[i].column < kSide / 2; };
    for (std::size_t i = 0; i < fits_.size(); ++i) {
        if (is_left(i)) continue;
        set_lobe(i, log_lobe(fits_[i].reflectance) + LogLobe(0, 2.0));
    }
    const LargeVector<LobePrior> priors = neighbor_priors(atlas_, links_, fits_, {0, 0});
    double sum = 0;
    double count = 0;
    for (std::size_t i = 0; i < fits_.size(); ++i) {
        if (atlas_.texels[i].column != kSide / 2 - 1) continue;
        sum += drawn(priors, i)[1] - truth_[1];
        count += 1;
    }
    // Four of the thirteen lie on the other side, 14 standard deviations of a pair away, and count
    // for (2 / 14)^2 = 0.02 of themselves: 2 x 4 x 0.02 / 9, where all alike would draw by 0.6. The
    // noise of such a mean is 0.1 / 3 / sqrt(64 / 3).
    EXPECT_NEAR(sum / count, 0.018, 5 * 0.0072);
}

}  // namespace
}  // namespace patina
