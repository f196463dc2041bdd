#include "patina/scan/figurines.h"

#include <algorithm>

namespace patina {

double crease_depth(const SignedDistance& distance, const Vec3& p, const Vec3& n, double radius) {
    return std::clamp(1.0 - distance(p + radius * n) / radius, 0.0, 1.0);
}

}  // namespace patina
