#include "patina/reflectance/albedo_table.h"

#include "patina/base/parallel.h"
#include "patina/math/types.h"
#include "patina/reflectance/lobe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace patina {
namespace {

constexpr int kNumElevations = 257;
constexpr int kNumRoughnesses = 49;
constexpr double kElevationStep = 0.5 * kPi / (kNumElevations - 1);  // [rad]
// Points per elevation step at which the largest albedo is looked for.
constexpr int kMaximumSearchSteps = 16;
// Beyond this many sigma the Gaussian is below 1e-17.
constexpr double kGaussianReach = 9;

// Gauss-Legendre nodes and weights of order 16 on [-1, 1]; the positive half.
constexpr std::array<double, 8> kGaussNodes = {0.0950125098376374402,
                                               0.2816035507792589132,
                                               0.4580167776572273863,
                                               0.6178762444026437484,
                                               0.7554044083550030339,
                                               0.8656312023878317439,
                                               0.9445750230732325761,
                                               0.9894009349916499326};
constexpr std::array<double, 8> kGaussWeights = {0.1894506104550684963,
                                                 0.1826034150449235889,
                                                 0.1691565193950025382,
                                                 0.1495959888165767321,
                                                 0.1246289712555338721,
                                                 0.0951585116824927848,
                                                 0.0622535239386478929,
                                                 0.0271524594117540949};

// R(theta): mean over phi of min(1, max(cos_o, 0) / c0), cos_o = along + across cos(phi).
double mean_over_circle(double elevation, double theta) {
    const double along = std::sin(elevation) * std::cos(theta);
    const double across = std::max(std::cos(elevation) * std::sin(theta), 1e-300);
    const double phi_floor = std::acos(std::clamp((kCosineFloor - along) / across, -1.0, 1.0));
    const double phi_horizon = std::acos(std::clamp(-along / across, -1.0, 1.0));
    const double ramp =
        along * (phi_horizon - phi_floor) + across * (std::sin(phi_horizon) - std::sin(phi_floor));
    return (phi_floor + ramp / kCosineFloor) / kPi;
}

// Integral over [begin, end] of exp(-theta^2 / (2 sigma^2)) sin(theta) R(theta). The substitution
// theta = begin + (end - begin) (3 t^2 - 2 t^3) removes the square roots that R has at the ends.
double integrate_piece(double elevation, double roughness, double begin, double end) {
    double sum = 0;
    for (std::size_t i = 0; i < kGaussNodes.size(); ++i) {
        for (const double node : {-kGaussNodes[i], kGaussNodes[i]}) {
            const double t = 0.5 * (1 + node);
            const double theta = begin + (end - begin) * t * t * (3 - 2 * t);
            const double speed = 6 * t * (1 - t);
            sum += kGaussWeights[i] * speed * lobe_gaussian(theta * theta, roughness) *
                   std::sin(theta) * mean_over_circle(elevation, theta);
        }
    }
    return 0.5 * (end - begin) * sum;
}

double log_roughness_step() {
    return std::log(kMaxRoughness / kMinRoughness) / (kNumRoughnesses - 1);
}

double roughness_at(int row) { return kMinRoughness * std::exp(row * log_roughness_step()); }

// Four neighbours of a position on a regular grid, and their weights in Lagrange's cubic.
struct CubicStencil {
    CubicStencil(double position, int count) {
        first = std::clamp(static_cast<int>(position) - 1, 0, count - 4);
        const double x = position - first;
        weights = {-(x - 1) * (x - 2) * (x - 3) / 6,
                   x * (x - 2) * (x - 3) / 2,
                   -x * (x - 1) * (x - 3) / 2,
                   x * (x - 1) * (x - 2) / 6};
    }
    [[nodiscard]] double apply(const double* values) const {
        return weights[0] * values[first] + weights[1] * values[first + 1] +
               weights[2] * values[first + 2] + weights[3] * values[first + 3];
    }

    int first = 0;
    std::array<double, 4> weights{};
};

CubicStencil roughness_stencil(double roughness) {
    const double inside = std::clamp(roughness, kMinRoughness, kMaxRoughness);
    return {std::log(inside / kMinRoughness) / log_roughness_step(), kNumRoughnesses};
}

double largest_of_row(const double* row) {
    double largest = 0;
    const auto try_elevation = [&](double elevation) {
        const double g = CubicStencil(elevation / kElevationStep, kNumElevations).apply(row);
        largest = std::max(largest, g * kCosineFloor / std::max(std::sin(elevation), kCosineFloor));
    };
    for (int i = 0; i <= (kNumElevations - 1) * kMaximumSearchSteps; ++i) {
        try_elevation(i * kElevationStep / kMaximumSearchSteps);
    }
    try_elevation(std::asin(kCosineFloor));
    return largest;
}

}  // namespace

double relative_albedo_by_quadrature(double elevation, double roughness) {
    const double floor_elevation = std::asin(kCosineFloor);
    const double reach = std::min(kPi, kGaussianReach * roughness);
    // Where the circle touches the horizon or the floor, R has kinks.
    std::array<double, 8> cuts = {0,
                                  std::abs(elevation - floor_elevation),
                                  elevation,
                                  kPi - elevation,
                                  kPi - elevation - floor_elevation,
                                  2 * roughness,
                                  5 * roughness,
                                  reach};
    for (double& cut : cuts) cut = std::clamp(cut, 0.0, reach);
    std::sort(cuts.begin(), cuts.end());
    double sum = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (cuts[i + 1] > cuts[i]) {
            sum += integrate_piece(elevation, roughness, cuts[i], cuts[i + 1]);
        }
    }
    return sum / square(roughness);
}

AlbedoTable::AlbedoTable()
    : values_(std::size_t{kNumElevations} * kNumRoughnesses), maximum_(kNumRoughnesses) {
    const auto fill_row = [this](std::size_t row) {
        double* values = &values_[row * kNumElevations];
        for (int i = 0; i < kNumElevations; ++i) {
            values[i] = relative_albedo_by_quadrature(i * kElevationStep, roughness_at(int(row)));
        }
        maximum_[row] = largest_of_row(values);
    };
    parallel_for(kNumRoughnesses, fill_row, 1);
}

double AlbedoTable::relative(double cos_i, double roughness) const {
    const CubicStencil columns(std::asin(std::clamp(cos_i, 0.0, 1.0)) / kElevationStep,
                               kNumElevations);
    const CubicStencil rows = roughness_stencil(roughness);
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
        const std::size_t row = static_cast<std::size_t>(rows.first + i);
        sum += rows.weights[static_cast<std::size_t>(i)] *
               columns.apply(&values_[row * kNumElevations]);
    }
    return sum;
}

double AlbedoTable::relative_maximum(double roughness) const {
    return roughness_stencil(roughness).apply(maximum_.data());
}

const AlbedoTable& albedo_table() {
    static const AlbedoTable table;
    return table;
}

}  // namespace patina
