#include "patina/math/statistics.h"

#include "patina/base/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace patina {
namespace {

// Places in the sorted order, from 0; equal values get the mean of theirs.
std::vector<double> ranks(std::span<const double> values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        return values[i] < values[j];
    });
    std::vector<double> result(values.size());
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
        for (std::size_t k = begin; k < end; ++k) {
            result[order[k]] = 0.5 * double(begin + end - 1);
        }
    }
    return result;
}

constexpr double kSmallestPoolExpectation = 5.0;
constexpr int kMaxSeriesTerms = 10000;
constexpr double kSeriesTolerance = 1e-15;

// Regularised lower incomplete gamma function by its power series; for x < a + 1.
double lower_gamma_series(double a, double x) {
    double term = 1.0 / a;
    double sum = term;
    for (int n = 1; n < kMaxSeriesTerms && term > sum * kSeriesTolerance; ++n) {
        term *= x / (a + n);
        sum += term;
    }
    return sum * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

// Regularised upper incomplete gamma function by its continued fraction (modified Lentz); x >= a
// + 1.
double upper_gamma_fraction(double a, double x) {
    constexpr double kTiny = 1e-300;
    double b = x + 1.0 - a;
    double c = 1.0 / kTiny;
    double d = 1.0 / b;
    double h = d;
    for (int n = 1; n < kMaxSeriesTerms; ++n) {
        const double an = -n * (n - a);
        b += 2.0;
        d = 1.0 / std::copysign(std::max(std::abs(an * d + b), kTiny), an * d + b);
        c = b + an / c;
        if (std::abs(c) < kTiny) c = kTiny;
        const double factor = d * c;
        h *= factor;
        if (std::abs(factor - 1.0) < kSeriesTolerance) break;
    }
    return h * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

}  // namespace

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const double position = share * static_cast<double>(values.size() - 1);
    const auto lower = static_cast<std::size_t>(position);
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(lower);
    std::nth_element(values.begin(), nth, values.end());
    const double low = *nth;
    if (lower + 1 >= values.size()) return low;
    const double high = *std::min_element(nth + 1, values.end());
    return low + (position - static_cast<double>(lower)) * (high - low);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

Moments moments(std::span<const double> values) {
    Moments result;
    result.count = values.size();
    if (values.empty()) return result;
    const double count = static_cast<double>(values.size());
    result.mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double sum = 0;
    for (const double value : values) sum += (value - result.mean) * (value - result.mean);
    result.variance = sum / count;
    return result;
}

double rank_correlation(std::span<const double> a, std::span<const double> b) {
    PATINA_CHECK_EQ(a.size(), b.size());
    const std::vector<double> first = ranks(a);
    const std::vector<double> second = ranks(b);
    const Moments first_moments = moments(first);
    const Moments second_moments = moments(second);
    if (!(first_moments.variance > 0) || !(second_moments.variance > 0)) return 0;
    double sum = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        sum += (first[i] - first_moments.mean) * (second[i] - second_moments.mean);
    }
    return sum / double(first.size()) / std::sqrt(first_moments.variance * second_moments.variance);
}

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double normal_quantile(double probability) {
    PATINA_CHECK(probability > 0 && probability < 1);
    constexpr double a[] = {-3.969683028665376e+01,
                            2.209460984245205e+02,
                            -2.759285104469687e+02,
                            1.383577518672690e+02,
                            -3.066479806614716e+01,
                            2.506628277459239e+00};
    constexpr double b[] = {-5.447609879822406e+01,
                            1.615858368580409e+02,
                            -1.556989798598866e+02,
                            6.680131188771972e+01,
                            -1.328068155288572e+01};
    constexpr double c[] = {-7.784894002430293e-03,
                            -3.223964580411365e-01,
                            -2.400758277161838e+00,
                            -2.549732539343734e+00,
                            4.374664141464968e+00,
                            2.938163982698783e+00};
    constexpr double d[] = {
        7.784695709041462e-03, 3.224671290700398e-01, 2.445134137142996e+00, 3.754408661907416e+00};
    constexpr double kTail = 0.02425;
    const double tail = std::min(probability, 1 - probability);
    double z = 0;
    if (tail < kTail) {
        const double q = std::sqrt(-2 * std::log(tail));
        z = (((((c[0] * q + c[1]) * q + c[2]) * q + c[3]) * q + c[4]) * q + c[5]) /
            ((((d[0] * q + d[1]) * q + d[2]) * q + d[3]) * q + 1);
        if (probability > 0.5) z = -z;
    } else {
        const double q = probability - 0.5;
        const double r = q * q;
        z = (((((a[0] * r + a[1]) * r + a[2]) * r + a[3]) * r + a[4]) * r + a[5]) * q /
            (((((b[0] * r + b[1]) * r + b[2]) * r + b[3]) * r + b[4]) * r + 1);
    }
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
    return z - (normal_cdf(z) - probability) / density;
}

double chi_square_survival(double statistic, double degrees_of_freedom) {
    const double a = 0.5 * degrees_of_freedom;
    const double x = 0.5 * statistic;
    if (x <= 0) return 1.0;
    return x < a + 1.0 ? 1.0 - lower_gamma_series(a, x) : upper_gamma_fraction(a, x);
}

ChiSquareTest chi_square_test(std::span<const double> observed, std::span<const double> expected) {
    PATINA_CHECK_EQ(observed.size(), expected.size());
    std::vector<std::size_t> order(observed.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        return expected[i] < expected[j];
    });
    struct Pool {
        double observed = 0;
        double expected = 0;
    };
    std::vector<Pool> pools(1);
    for (const std::size_t i : order) {
        if (pools.back().expected >= kSmallestPoolExpectation) pools.emplace_back();
        pools.back().observed += observed[i];
        pools.back().expected += expected[i];
    }
    // What is left at the end is too small to stand alone.
    if (pools.size() > 1 && pools.back().expected < kSmallestPoolExpectation) {
        const Pool rest = pools.back();
        pools.pop_back();
        pools.back().observed += rest.observed;
        pools.back().expected += rest.expected;
    }
    ChiSquareTest test;
    for (const Pool& pool : pools) {
        if (pool.expected > 0) {
            test.statistic +=
                (pool.observed - pool.expected) * (pool.observed - pool.expected) / pool.expected;
        }
    }
    test.degrees_of_freedom = std::max(static_cast<int>(pools.size()) - 1, 1);
    test.p_value = chi_square_survival(test.statistic, test.degrees_of_freedom);
    return test;
}

}  // namespace patina
