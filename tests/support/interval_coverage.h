// How often the intervals of an estimate hold the truth.
#pragma once

#include "patina/capture/capture.h"
#include "patina/estimate/estimate.h"

#include <array>
#include <cmath>
#include <string>

namespace patina {

struct IntervalShares {
    std::string name;
    double share68 = 0;  // within one standard error
    double share95 = 0;  // within 1.96
    double count = 0;

    void add(double error, double standard_error) {
        share68 += std::abs(error) <= standard_error;
        share95 += std::abs(error) <= 1.96 * standard_error;
        count += 1;
    }
};

struct IntervalCoverage {
    IntervalShares diffuse{"Pd", 0, 0, 0};
    IntervalShares specular{"Ps", 0, 0, 0};
    IntervalShares roughness{"sigma", 0, 0, 0};

    // As shares of the texels.
    [[nodiscard]] std::array<IntervalShares, 3> each() const {
        std::array<IntervalShares, 3> result = {diffuse, specular, roughness};
        for (IntervalShares& shares : result) {
            shares.share68 /= shares.count;
            shares.share95 /= shares.count;
        }
        return result;
    }
};

// Over texels of status 1 inside the truth's mask.
[[nodiscard]] inline IntervalCoverage interval_coverage(const Capture& capture,
                                                        const TruthMaps& truth,
                                                        const Estimate& estimate) {
    IntervalCoverage coverage;
    for (std::size_t i = 0; i < estimate.maps.size(); ++i) {
        if (estimate.status[i] != TexelStatus::measured) continue;
        const int x = capture.atlas.texels[i].column;
        const int y = capture.atlas.texels[i].row;
        if (!truth.mask.empty() && truth.mask.at(x, y) == 0) continue;
        const Reflectance& map = estimate.maps[i];
        const Reflectance& error = estimate.errors[i];
        for (int c = 0; c < 3; ++c) {
            coverage.diffuse.add(map.diffuse[c] - double(truth.diffuse.at(x, y, c)),
                                 error.diffuse[c]);
        }
        coverage.specular.add(map.specular - double(truth.specular.at(x, y)), error.specular);
        coverage.roughness.add(map.roughness - double(truth.roughness.at(x, y)), error.roughness);
    }
    return coverage;
}

}  // namespace patina
