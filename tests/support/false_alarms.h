// Whether the mean of a random quantity is what it should be.
#pragma once

#include "patina/math/statistics.h"

#include <gtest/gtest.h>

#include "support/comparison_level.h"
#include <cmath>
#include <cstddef>
#include <span>

namespace patina {

// Mean of independent, equally distributed numbers, and its standard error.
struct SampleMean {
    double mean = 0;
    double standard_error = 0;
    std::size_t count = 0;
};

[[nodiscard]] inline SampleMean estimate_of(std::span<const double> values) {
    const Moments all = moments(values);
    return {all.mean, std::sqrt(all.variance / double(all.count - 1)), all.count};
}

// Whether the mean is `expected`. bias: largest error that theory allows besides the random one
// (tessellation, truncation, interpolation), same unit.
[[nodiscard]] inline testing::AssertionResult agrees(const SampleMean& estimate,
                                                     double expected,
                                                     double bias = 0,
                                                     double level = kComparisonLevel) {
    const double allowed =
        bias + estimate.standard_error * student_threshold(double(estimate.count - 1), level);
    if (std::abs(estimate.mean - expected) <= allowed) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << "mean " << estimate.mean << " +- " << estimate.standard_error << " of "
           << estimate.count << " values, expected " << expected << " +- " << allowed;
}

}  // namespace patina
