// How well an unbiased estimate could know each texel's lobe at best: the Cramer-Rao bound.
//
// Based on: Kay. Fundamentals of Statistical Signal Processing: Estimation Theory. Prentice Hall
// 1993, section 3.
#pragma once

#include "patina/base/progress.h"
#include "patina/capture/capture.h"
#include "patina/capture/result_folder.h"
#include "patina/reflectance/lobe.h"

#include <span>
#include <vector>

namespace patina {

struct LobeBound {
    // Whether the bound passes the marks by which a fit's lobe counts as measured (judge_lobe()).
    bool measurable = false;
    double specular = 0;   // least standard error of Ps [-]; +infinity: no information
    double roughness = 0;  // of sigma [rad]
};

// One per texel of the atlas. truth: one per texel; noise: of the looks; the lobe seen by direct
// light alone, as judge_lobe() does. What the channels of a look share is no news from the second
// and third of them: the bound is that of weighted least squares under such noise.
[[nodiscard]] std::vector<LobeBound> lobe_bounds(const Capture& capture,
                                                 std::span<const Reflectance> truth,
                                                 const FitNoise& noise,
                                                 Progress& progress);

}  // namespace patina
