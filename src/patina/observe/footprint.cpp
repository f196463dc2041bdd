#include "patina/observe/footprint.h"

#include <algorithm>
#include <cmath>

namespace patina {

FootprintAxis footprint_axis(float position, int size) {
    constexpr float kSnap = 1e-3f;  // [pixels]
    const float centered = std::clamp(position - 0.5f, 0.0f, float(size - 1));
    const float nearest = std::round(centered);
    if (std::abs(centered - nearest) < kSnap) return {int(nearest), int(nearest), 0.0f};
    const int first = std::min(int(centered), size - 2);
    return {first, first + 1, centered - float(first)};
}

}  // namespace patina
