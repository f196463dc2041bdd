#include "patina/reflectance/lobe_lanes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

constexpr int kSteps = 100'000;

struct Errors {
    double absolute = 0;
    double relative = 0;
};

// Largest errors of f against exact over [0, end], 0 itself left out.
template <typename Function, typename Exact>
Errors errors_up_to(double end, const Function& f, const Exact& exact) {
    Errors errors;
    for (int i = 1; i <= kSteps; ++i) {
        const auto x = float(end * i / kSteps);
        const double expected = exact(double(x));
        const double error = std::abs(double(f(x)) - expected);
        errors.absolute = std::max(errors.absolute, error);
        errors.relative = std::max(errors.relative, error / std::abs(expected));
    }
    return errors;
}

Errors squared_angle_errors(double largest_versine) {
    // arccos(1 - v) without its cancellation.
    return errors_up_to(largest_versine, squared_angle<float>, [](double versine) {
        const double angle = 2 * std::asin(std::sqrt(0.5 * versine));
        return angle * angle;
    });
}

Errors exp_errors(double smallest) {
    return errors_up_to(smallest, exp_of_negative<float>, [](double x) { return std::exp(x); });
}

TEST(SquaredAngle, IsThatOfTheArcCosine) {
    EXPECT_EQ(squared_angle(0.0F), 0.0F);
    EXPECT_LT(squared_angle_errors(0.7).relative, 2e-4);
    EXPECT_LT(squared_angle_errors(1.5).relative, 0.02);
}

TEST(ExpOfNegative, IsTheExponential) {
    EXPECT_EQ(exp_of_negative(0.0F), 1.0F);
    EXPECT_LT(exp_errors(-4).relative, 2e-6);
    EXPECT_LT(exp_errors(-20).relative, 0.05);
    EXPECT_LT(exp_errors(-20).absolute, 1e-6);
}

TEST(ExpOfNegative, StaysSmallFarOut) {
    for (const float x : {-21.0F, -100.0F, -1e30F}) {
        EXPECT_EQ(exp_of_negative(x), exp_of_negative(-20.0F)) << x;
    }
}

}  // namespace
}  // namespace patina
