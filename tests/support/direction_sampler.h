// Chi-square test of a sampler of directions against its density, as in Mitsuba's chi2.py and
// pbrt's bsdfs_test.cpp: counts in cells of the sphere against the density integrated over them.
#pragma once

#include "patina/base/random.h"
#include "patina/math/statistics.h"
#include "patina/math/warp.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace patina {

struct DirectionSampler {
    Vec3 axis = Vec3::UnitZ();                        // the cells are finest about it
    std::function<std::optional<Vec3>(Rng&)> sample;  // nothing: a lost sample
    std::function<double(const Vec3&)> pdf;           // [1/sr]
};

struct DirectionSamplerTest {
    ChiSquareTest chi_square;  // lost samples are one more cell
    double pdf_integral = 0;   // of the density over the sphere
    double lost_share = 0;     // of the samples
};

namespace direction_sampler_detail {

constexpr int kNumRings = 24;
constexpr int kNumSectors = 12;
// Midpoints per cell and dimension: a density that jumps inside a cell (a horizon) is then
// integrated to about a percent of the cell, below the counting noise of the samples.
constexpr int kNumMidpoints = 48;

inline double ring_edge(int ring) { return kPi * square(double(ring) / kNumRings); }

inline std::size_t cell_of(const Frame& frame, const Vec3& w) {
    const double angle = std::acos(std::clamp(frame.normal.dot(w), -1.0, 1.0));
    const double azimuth = std::atan2(frame.bitangent.dot(w), frame.tangent.dot(w)) + kPi;
    const int ring = std::min(int(kNumRings * std::sqrt(angle / kPi)), kNumRings - 1);
    const int sector = std::min(int(kNumSectors * azimuth / (2 * kPi)), kNumSectors - 1);
    return std::size_t(ring * kNumSectors + sector);
}

inline double integrate_cell(const DirectionSampler& sampler,
                             const Frame& frame,
                             int ring,
                             int sector) {
    const double z_begin = std::cos(ring_edge(ring));
    const double z_step = (std::cos(ring_edge(ring + 1)) - z_begin) / kNumMidpoints;
    const double azimuth_step = 2 * kPi / (kNumSectors * kNumMidpoints);
    double sum = 0;
    for (int i = 0; i < kNumMidpoints; ++i) {
        const double z = z_begin + (i + 0.5) * z_step;
        const double radius = std::sqrt(1 - z * z);
        for (int j = 0; j < kNumMidpoints; ++j) {
            const double azimuth = (sector * kNumMidpoints + j + 0.5) * azimuth_step - kPi;
            sum += sampler.pdf(
                frame.to_world({radius * std::cos(azimuth), radius * std::sin(azimuth), z}));
        }
    }
    return sum * -z_step * azimuth_step;
}

}  // namespace direction_sampler_detail

[[nodiscard]] inline DirectionSamplerTest test_direction_sampler(const DirectionSampler& sampler,
                                                                 int num_samples,
                                                                 std::uint64_t seed) {
    using namespace direction_sampler_detail;
    const Frame frame(sampler.axis);
    std::vector<double> observed(kNumRings * kNumSectors + 1, 0.0);
    std::vector<double> expected(observed.size(), 0.0);
    for (int i = 0; i < num_samples; ++i) {
        Rng rng(seed, Pass::tests, std::uint64_t(i));
        const std::optional<Vec3> w = sampler.sample(rng);
        observed[w ? cell_of(frame, *w) : observed.size() - 1] += 1;
    }
    DirectionSamplerTest test;
    for (int ring = 0; ring < kNumRings; ++ring) {
        for (int sector = 0; sector < kNumSectors; ++sector) {
            const double mass = integrate_cell(sampler, frame, ring, sector);
            expected[std::size_t(ring * kNumSectors + sector)] = mass * num_samples;
            test.pdf_integral += mass;
        }
    }
    expected.back() = std::max(0.0, 1 - test.pdf_integral) * num_samples;
    test.chi_square = chi_square_test(observed, expected);
    test.lost_share = observed.back() / num_samples;
    return test;
}

}  // namespace patina
