#include "patina/scan/material.h"

#include "patina/base/random.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {
namespace {

double lattice_value(const std::array<std::int32_t, 3>& cell, std::uint32_t which) {
    std::uint32_t hash = which;
    for (const std::int32_t coordinate : cell) {
        hash = hash_combine(hash, static_cast<std::uint32_t>(coordinate));
    }
    return hash * (2.0 / 4294967295.0) - 1.0;
}

double lerp(double a, double b, double t) { return a + (b - a) * t; }

double quintic(double t) { return t * t * t * (t * (6 * t - 15) + 10); }

}  // namespace

Reflectance make_reflectance(const Finish& finish) {
    Reflectance result;
    result.diffuse = finish.diffuse.max(kObjectMinDiffuse).min(kObjectMaxDiffuse);
    result.roughness = std::clamp(finish.roughness, kObjectMinRoughness, kObjectMaxRoughness);
    const double gloss = std::clamp(finish.gloss, kObjectMinGloss, kObjectMaxGloss);
    result.specular = gloss / (2 * square(result.roughness));
    return result;
}

Finish blend(const Finish& a, const Finish& b, double t) {
    const double weight = std::clamp(t, 0.0, 1.0);
    return {a.diffuse + (b.diffuse - a.diffuse) * weight,
            lerp(a.gloss, b.gloss, weight),
            lerp(a.roughness, b.roughness, weight)};
}

double smooth_step(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

double smooth_noise(const Vec3& p, double size, std::uint32_t which) {
    const Vec3 scaled = p / size;
    const Vec3 corner = scaled.array().floor();
    const Vec3 t = (scaled - corner).unaryExpr(&quintic);
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
        std::array<std::int32_t, 3> cell;
        double weight = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const int upper = c >> axis & 1;
            cell[std::size_t(axis)] = std::int32_t(corner[axis]) + upper;
            weight *= upper != 0 ? t[axis] : 1 - t[axis];
        }
        sum += weight * lattice_value(cell, which);
    }
    return sum;
}

}  // namespace patina
