// What other ways of choosing lamps would have shown with as many: curves over the number of lamps.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace patina {

// Shares of the seen texels with the first n lamps of a rule, besides those taken already [-]: one
// entry for n = 0, 1, 2 ..., as many in each list, at least one.
struct LampRule {
    std::string rule;              // "d-optimal", "paper", "uniform", "random"
    std::vector<double> known;     // Ps known to 10 % by the standard error that the looks allow
    std::vector<double> specular;  // measurable: two lamps near the highlight
    std::vector<double> diffuse;   // measurable: one lamp away from it
};

// Three charts with their legend and caption. num_chosen: lamps, marked in the charts.
[[nodiscard]] std::string lamp_rule_charts(const std::vector<LampRule>& rules,
                                           std::size_t num_chosen);

// The rules at this number of lamps, or as far as each goes.
[[nodiscard]] std::string lamp_rule_table(const std::vector<LampRule>& rules,
                                          std::size_t num_chosen);

}  // namespace patina
