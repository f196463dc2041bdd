// What the paper prints in its Table 1, to set ours beside it.
//
// Machida, Takemura, Yokoya. Dense Estimation of Surface Reflectance Properties Based on Inverse
// Global Illumination Rendering. 2004.
#pragma once

#include <optional>
#include <string>

namespace patina {

// Of |real - synthetic|.
struct PaperDifference {
    double levels_mean = 0;      // [8-bit levels]
    double levels_variance = 0;  // [8-bit levels^2]
};

// For objects "B" and "C" and methods "diffuse" (conventional II) and "photon" alone.
[[nodiscard]] std::optional<PaperDifference> paper_table_1(const std::string& object,
                                                           const std::string& method);

}  // namespace patina
