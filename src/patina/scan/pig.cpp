// Object C: a plump pig standing on four short legs.
#include "patina/scan/figurines.h"
#include "patina/scan/material.h"

#include <algorithm>
#include <array>

namespace patina {
namespace {

constexpr double kCentimeter = 0.01;  // [m]
constexpr double kFoldWidth = 0.12;   // of the seam between the halves [cm]

constexpr double kTailFront = -8.0;  // where the tail begins [cm]

// Where shape and markings must agree [cm].
const Vec3 kEye(1.68, 9.95, 4.95);
const Vec3 kEyeRadii(0.7, 0.7, 0.65);

// All shapes below are in centimetres; q is p folded to positive x, so one half stands for both.
// The axis of the scanner goes through the neck, which both head and body contain: so the neck's
// crease is seen.
double trunk(const Vec3& p) {
    const double barrel = ellipsoid_distance(p, {0, 6.9, -3.4}, {5.6, 5.3, 6.3});
    const double belly = ellipsoid_distance(p, {0, 3.2, -2.6}, {4.6, 3.4, 5.4});
    return smooth_union(barrel, belly, 1.0);
}

double legs(const Vec3& q) {
    const double front = rounded_cone_distance(q, {2.9, 3.6, 1.1}, {3.0, 0.8, 1.5}, 1.75, 1.45);
    const double hind = rounded_cone_distance(q, {3.2, 3.6, -6.3}, {3.3, 0.8, -6.8}, 1.9, 1.5);
    return std::min(front, hind);
}

double snout(const Vec3& p, const Vec3& q) {
    const double disc = rounded_cylinder_distance(p, {0, 8.0, 5.5}, {0, 7.85, 8.3}, 1.75, 0.35);
    const double nostril = ellipsoid_distance(q, {0.65, 7.95, 8.35}, {0.33, 0.6, 0.5});
    return smooth_difference(disc, nostril, 0.3);
}

double ears(const Vec3& q) {
    const double shell = rounded_cone_distance(q, {2.0, 11.5, 1.6}, {3.3, 13.6, 2.8}, 1.6, 0.5);
    // A slab across the direction in which the ear faces: forwards, outwards and a little upwards.
    const Vec3 facing = Vec3(0.15, -0.5, 0.85).normalized();
    const double slab = std::abs((q - Vec3(2.7, 12.7, 2.2)).dot(facing)) - 0.8;
    const double flap = smooth_difference(shell, -slab, 0.5);
    const double hollow = ellipsoid_distance(q, {2.7, 12.5, 3.35}, {0.85, 1.2, 0.65});
    return smooth_difference(flap, hollow, 0.5);
}

double head(const Vec3& p, const Vec3& q) {
    double d = ellipsoid_distance(p, {0, 8.8, 2.2}, {4.1, 4.0, 4.0});
    const double cheek = sphere_distance(q, {2.1, 7.3, 3.2}, 1.9);
    d = smooth_union(d, cheek, 0.9);
    d = smooth_union(d, snout(p, q), 0.35);
    d = smooth_union(d, ears(q), 0.8);
    const double socket = ellipsoid_distance(q, {1.75, 10.0, 5.8}, {1.0, 1.0, 0.55});
    d = smooth_difference(d, socket, 0.6);
    const double eye = ellipsoid_distance(q, kEye, kEyeRadii);
    return smooth_union(d, eye, 0.35);
}

using TailPoints = std::array<ChainPoint, 17>;

TailPoints make_tail() {
    TailPoints points;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double t = double(i) / double(points.size() - 1);
        const double turn = 2 * kPi * (0.25 + 1.05 * t);
        const double rise = 1.25 * std::sin(turn) - 0.3 * t;
        // Lies on the rump, which leans by a third there.
        const Vec3 position(1.25 * std::cos(turn), 8.3 + rise, -9.2 + 0.33 * rise - 0.15 * t);
        points[i] = {position, 0.7 - 0.1 * t};
    }
    return points;
}

double tail(const Vec3& p) {
    static const TailPoints points = make_tail();
    // Far in front of it, the distance to its foremost plane is bound enough, and quicker.
    const double before = p.z() - kTailFront;
    return before > 1.0 ? before : chain_distance(p, points);
}

double pig_distance(const Vec3& p) {
    const Vec3 q = fold_at_x0(p, kFoldWidth);
    double d = smooth_union(trunk(p), legs(q), 0.5);
    d = smooth_union(d, head(p, q), 0.45);
    d = smooth_union(d, tail(p), 0.6);
    return smooth_difference(d, p.y(), 0.2);
}

// Brown patches where a noise of large features is high. 0 outside, 1 inside.
double patches(const Vec3& p) {
    const double noise = smooth_noise(p, 4.2, 21) + 0.25 * smooth_noise(p, 1.1, 22);
    return smooth_step(0.20, 0.32, noise);
}

// p: in centimetres; crease: depth of the crease there, 0 to 1.
Finish pig_finish(const Vec3& p, double crease) {
    const Vec3 q = fold_at_x0(p, kFoldWidth);
    const Finish pink{Rgb(0.70, 0.44, 0.40), 0.026, 0.17};
    const Finish brown{Rgb(0.31, 0.20, 0.14), 0.036, 0.12};
    const Finish rosy{Rgb(0.74, 0.34, 0.33), 0.038, 0.13};
    const Finish hoof{Rgb(0.24, 0.18, 0.15), 0.018, 0.25};
    const Finish eye{Rgb(0.12, 0.11, 0.11), 0.048, 0.09};
    const Finish pale{Rgb(0.82, 0.70, 0.66), 0.016, 0.24};
    Finish finish = blend(pink, brown, patches(p));
    finish.gloss *= 1 + 0.35 * smooth_noise(p, 3.4, 23);
    finish.roughness *= 1 + 0.25 * smooth_noise(p, 2.6, 24);
    finish.diffuse *= 1 + 0.08 * smooth_noise(p, 0.6, 25);
    finish = blend(finish, hoof, 1 - smooth_step(0.9, 1.1, p.y()));
    finish = blend(finish, rosy, smooth_step(6.3, 6.9, p.z()));
    // The glaze of an old figurine stays bright where nobody touches it.
    finish = blend(finish, pale, smooth_step(0.06, 0.3, crease));
    const double eyeball = (q - kEye).cwiseQuotient(kEyeRadii).norm();
    return blend(finish, eye, 1 - smooth_step(1.03, 1.15, eyeball));
}

}  // namespace

Figurine make_pig() {
    Figurine pig;
    pig.distance = [](const Vec3& p) { return kCentimeter * pig_distance(p / kCentimeter); };
    pig.bounds = {Vec3(-0.075, -0.01, -0.12), Vec3(0.075, 0.155, 0.1)};
    pig.reflectance = [distance = pig.distance](const Vec3& p, const Vec3& n) {
        const double crease = crease_depth(distance, p, n, kCreaseRadius);
        return make_reflectance(pig_finish(p / kCentimeter, crease));
    };
    return pig;
}

}  // namespace patina
