// A profile of the misfit over one unknown that all texels share: everything else is fitted anew at
// each of its values. The lowest point and its error, robust against residuals that neighbours or
// looks under one lamp share.
//
// Based on: Cameron, Gelbach, Miller. Robust Inference With Multiway Clustering. J. Bus. Econ.
// Stat. 29(2), 2011, eq. 2.7 (the error). docs/theory.md, "Absolute scale".
#pragma once

#include <cstddef>
#include <vector>

namespace patina {

// What the looks say against one value of the unknown.
struct ProfileTrial {
    // Weighted squared residuals [-], block of texels by block, per block one number for each set
    // of lamps.
    std::vector<double> costs;
    double clamped_share = 0;  // of the texels: they would reflect more light than they get

    [[nodiscard]] double total() const;
};

// The costs, as a function of the unknown x.
class ProfileTrials {
  public:
    ProfileTrials() = default;
    ProfileTrials(const ProfileTrials&) = delete;
    ProfileTrials& operator=(const ProfileTrials&) = delete;
    virtual ~ProfileTrials() = default;

    // Decides at x what all further trials share: weights, and what is measured at all.
    virtual void settle(double x) = 0;
    // Fits again until the maps move by less than the tolerance, relative.
    [[nodiscard]] virtual ProfileTrial try_at(double x, double tolerance) = 0;
};

// The parabola through three trials about x, and its vertex.
struct Vertex {
    double offset = 0;          // of the vertex from x
    double standard_error = 0;  // of the vertex; at least what noise of the looks' weights leaves
    bool exists = false;        // there is a lowest point
    double clamped_share = 0;   // at x [-]
};

// Trials at x, x - arm and x + arm, which rest when the maps move by less than a thousandth.
[[nodiscard]] Vertex vertex_at(ProfileTrials& trials,
                               double x,
                               double arm,
                               std::size_t num_lamp_sets);

// Standard deviation of the sum of all scores, if those of one block or of one set of lamps
// may depend on each other in any way, and others do not. The larger of the one-way estimates where
// the two-way one is smaller. Infinite where fewer than two blocks have
// scores. scores: like ProfileTrial::costs, with sum 0.
[[nodiscard]] double clustered_deviation(const std::vector<double>& scores,
                                         std::size_t num_lamp_sets);

}  // namespace patina
