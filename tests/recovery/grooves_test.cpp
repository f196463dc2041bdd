// Where the paper's loop does not converge, and the damped one does: light bounces so often in a
// groove that "solve the whole transport, then fit" answers an error by a larger one of the other
// sign (docs/theory.md, "The iteration").
#include <gtest/gtest.h>

#include "simulated_capture.h"
#include <numeric>
#include <vector>

namespace patina {
namespace {

// Of the mean Pd: what method photon claims where texels are small against the groove.
constexpr double kTolerance = 0.02;
// A loop that has not settled still moves the maps by more than this, relative, in each turn.
constexpr double kStillMoving = 0.1;

// Each point of a wall is lit by one lamp alone: other lamps would damp the plain loop, as a
// change of the indirect light that differs from lamp to lamp does not pass for a change of Pd.
// Of any Pd, alike everywhere.
SimulatedCapture simulate_groove(double diffuse) {
    ScanOptions options;
    options.columns = 240;  // square texels of 2.5 mm, eight rows on each wall
    options.rows = 16;
    options.samples_per_pixel = 64;
    options.heldout_sample_factor = 1;
    SimulatedObject groove = make_object(ObjectKind::v45, options.columns, options.rows);
    for (Reflectance& vertex : groove.reflectance) vertex.diffuse = Rgb::Constant(diffuse);
    constexpr std::size_t kAbove = 24;
    return {groove, {kAbove}, options};
}

SimulatedCapture simulate_channel() {
    ScanOptions options;
    options.columns = 90;
    options.rows = 30;  // 12, 6 and 12 on rear wall, floor and front wall
    options.samples_per_pixel = 64;
    options.heldout_sample_factor = 1;
    // 0.15 m aside: they light both walls at less than 80 degrees and the floor together.
    constexpr std::size_t kFront = 17;
    constexpr std::size_t kRear = 41;
    return {ObjectKind::u, {kFront, kRear}, options};
}

EstimateOptions loop_options(Loop loop) {
    EstimateOptions options;
    options.method = Method::photon;
    options.loop = loop;
    options.photons.photons = 100'000;
    options.max_iterations = 40;
    options.tolerance = 1e-3;
    return options;
}

double mean(const std::vector<double>& errors) {
    return std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size());
}

// Beside the groove's edge and its openings, texels and kernels are as wide as what they resolve.
bool is_beside_an_edge(std::size_t row) {
    const std::size_t on_wall = row % 8;
    return on_wall == 0 || on_wall == 7;
}

void expect_still_moving(const Estimate& plain, const Estimate& damped) {
    EXPECT_FALSE(plain.converged);
    EXPECT_GE(plain.iterations.size(), damped.iterations.size());
    EXPECT_GT(plain.iterations.back().change, kStillMoving);
    // The maps swing between two that explain the images badly, one of them worse than the other.
    const std::size_t last = plain.iterations.size() - 1;
    for (const std::size_t turn : {last - 1, last}) {
        EXPECT_GT(plain.iterations[turn].error, 10 * damped.iterations.back().error);
    }
}

TEST(GrooveOf45Degrees, DampedLoopFindsTheTruthAndThePlainOneDoesNot) {
    const SimulatedCapture capture = simulate_groove(kGrooveDiffuse);
    const Estimate damped = capture.estimate(loop_options(Loop::damped));
    EXPECT_TRUE(damped.converged);
    const std::vector<double> errors = capture.row_errors(damped, 0);
    for (std::size_t row = 0; row < errors.size(); ++row) {
        if (is_beside_an_edge(row)) continue;
        EXPECT_NEAR(errors[row], 0, kTolerance) << "row " << row;
    }
    expect_still_moving(capture.estimate(loop_options(Loop::plain)), damped);
}

// Texels are a fifth of the channel's width here, so single rows are smoothed; their mean is not.
TEST(Channel, DampedLoopFindsTheTruthAndThePlainOneDoesNot) {
    const SimulatedCapture capture = simulate_channel();
    const Estimate damped = capture.estimate(loop_options(Loop::damped));
    EXPECT_TRUE(damped.converged);
    EXPECT_NEAR(mean(capture.row_errors(damped, 0)), 0, kTolerance);
    expect_still_moving(capture.estimate(loop_options(Loop::plain)), damped);
}

// One sweep for each fit, undamped.
EstimateOptions gather_options() {
    EstimateOptions options;
    options.method = Method::gather;
    return options;
}

TEST(GrooveOf45Degrees, GatheringConvergesToTheTruth) {
    const SimulatedCapture capture = simulate_groove(kGrooveDiffuse);
    const Estimate gathered = capture.estimate(gather_options());
    EXPECT_TRUE(gathered.converged);
    const std::vector<double> errors = capture.row_errors(gathered, 0);
    for (std::size_t row = 0; row < errors.size(); ++row) {
        if (is_beside_an_edge(row)) continue;
        EXPECT_NEAR(errors[row], 0, kTolerance) << "row " << row;
    }
}

// The maps lie on the border of the feasible set, and do not move, until light that bounces far
// more often is nearly known.
TEST(GrooveOf45Degrees, GatheringConvergesToNearlyWhite) {
    const SimulatedCapture capture = simulate_groove(0.95);
    const Estimate gathered = capture.estimate(gather_options());
    EXPECT_TRUE(gathered.converged);
    // Single rows err by more than those of a darker groove, as more of their light has bounced.
    EXPECT_NEAR(mean(capture.row_errors(gathered, 0)), 0, kTolerance);
}

TEST(Channel, GatheringConvergesToTheTruth) {
    const SimulatedCapture capture = simulate_channel();
    const Estimate gathered = capture.estimate(gather_options());
    EXPECT_TRUE(gathered.converged);
    EXPECT_NEAR(mean(capture.row_errors(gathered, 0)), 0, kTolerance);
}

}  // namespace
}  // namespace patina
