// The paper's comparison (its Figure 5) on object A: two glossy plates at a right angle, one
// material, so that Pd along the vertical should be a flat line.
#include <gtest/gtest.h>

#include "simulated_capture.h"
#include <cmath>
#include <numeric>
#include <vector>

namespace patina {
namespace {

constexpr int kRows = 60;
// Rows of both plates within a tenth of their depth from the edge.
constexpr std::size_t kFirstNearEdge = 27;
constexpr std::size_t kLastNearEdge = 32;

class Plates : public testing::Test {
  protected:
    static SimulatedCapture simulate() {
        ScanOptions options;
        options.columns = 40;
        options.rows = kRows;
        options.samples_per_pixel = 128;
        options.heldout_sample_factor = 1;
        // As 'patina plan' chooses.
        return {ObjectKind::a, {25, 55, 9, 39, 6, 36, 5, 35, 14, 44, 29, 59, 10}, options};
    }

    // Relative errors of red Pd, row by row.
    [[nodiscard]] std::vector<double> profile(Method method) const {
        EstimateOptions options;
        options.method = method;
        options.photons.photons = 100'000;
        options.max_iterations = 20;
        options.tolerance = 1e-3;
        return capture_.row_errors(capture_.estimate(options), 0);
    }

    static double near_edge(const std::vector<double>& profile) {
        const auto first = profile.begin() + std::ptrdiff_t(kFirstNearEdge);
        const auto last = profile.begin() + std::ptrdiff_t(kLastNearEdge) + 1;
        return std::accumulate(first, last, 0.0) / double(last - first);
    }

    SimulatedCapture capture_ = simulate();
};

TEST_F(Plates, EachMethodFlattensTheProfileFurther) {
    const std::vector<double> direct = profile(Method::direct);
    const std::vector<double> diffuse = profile(Method::diffuse);
    const std::vector<double> photon = profile(Method::photon);
    // The sensor's and the renderer's noise are 2 % per texel and independent; that of photons and
    // of a filled lobe is shared by neighbours, so a row is no better than a texel: 3 % at 3
    // standard errors of 1 %.
    for (std::size_t row = 0; row < photon.size(); ++row) {
        EXPECT_NEAR(photon[row], 0, 0.03) << "row " << row;
    }
    EXPECT_NEAR(near_edge(photon), 0, 0.015);
    // Beside the edge one sixth of red light has come by way of the other plate.
    EXPECT_GT(near_edge(direct), 0.15);
    // Method II leaves what comes by way of the lobe: the plates' specular albedo is 0.03 and more
    // at the slant of the other plate, against a diffuse one of 0.74.
    EXPECT_GT(near_edge(diffuse), 0.03);
    EXPECT_LT(near_edge(diffuse), 0.5 * near_edge(direct));
}

}  // namespace
}  // namespace patina
