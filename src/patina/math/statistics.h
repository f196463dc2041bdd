// Order statistics and the quantiles that statistical tests and error bars need.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace patina {

// Value at `share` in [0, 1] of the sorted values, linear between neighbours. NaN when empty.
[[nodiscard]] double quantile(std::vector<double> values, double share);
[[nodiscard]] double median(std::vector<double> values);

struct Moments {
    std::size_t count = 0;
    double mean = 0;
    double variance = 0;  // population variance; 0 for fewer than two values
};
[[nodiscard]] Moments moments(std::span<const double> values);

// Spearman's rank correlation of pairs [-]; equal values share their mean rank. 0 where either side
// has one value only. Both of the same length.
[[nodiscard]] double rank_correlation(std::span<const double> a, std::span<const double> b);

// Standard normal distribution function and its inverse (Acklam's rational approximation with one
// Newton step; relative error below 1e-12).
[[nodiscard]] double normal_cdf(double z);
[[nodiscard]] double normal_quantile(double probability);

// P(X >= statistic) of the chi-square distribution; regularised upper incomplete gamma function.
[[nodiscard]] double chi_square_survival(double statistic, double degrees_of_freedom);

// Result of comparing counts with expectations; cells of small expectation are pooled.
struct ChiSquareTest {
    double statistic = 0;
    int degrees_of_freedom = 0;
    double p_value = 1;
};
// observed, expected: counts per cell, the same length. Cells are pooled, in ascending order of
// expectation, until each pool expects at least 5.
[[nodiscard]] ChiSquareTest chi_square_test(std::span<const double> observed,
                                            std::span<const double> expected);

}  // namespace patina
