// Object B: a sitting cat, tail round its feet.
#include "patina/scan/figurines.h"
#include "patina/scan/material.h"

#include <algorithm>
#include <array>

namespace patina {
namespace {

constexpr double kCentimeter = 0.01;  // [m]
constexpr double kFoldWidth = 0.12;   // of the seam between the halves [cm]

constexpr double kTailHeight = 0.75;  // of its middle line [cm]
constexpr double kTailRadius = 1.2;   // at its root [cm]

// Where shape and markings must agree [cm].
const Vec3 kNose(0, 14.05, 4.55);
const Vec3 kNoseRadii(0.5, 0.35, 0.35);
const Vec3 kEye(1.3, 14.95, 3.05);
const Vec3 kEyeRadii(0.8, 0.75, 0.65);

// All shapes below are in centimetres; q is p folded to positive x, so one half stands for both.
double body(const Vec3& p, const Vec3& q) {
    double d = rounded_cone_distance(p, {0, 3.7, -0.9}, {0, 10.4, 0.7}, 4.4, 2.25);
    const double chest = ellipsoid_distance(p, {0, 8.3, 1.7}, {2.75, 3.0, 2.3});
    d = smooth_union(d, chest, 1.2);
    const double haunch = ellipsoid_distance(q, {3.4, 3.0, -0.2}, {1.9, 3.5, 3.3});
    return smooth_union(d, haunch, 0.5);
}

double legs(const Vec3& q) {
    const double front = rounded_cone_distance(q, {1.4, 7.5, 3.0}, {1.4, 1.3, 3.7}, 1.3, 1.3);
    const double front_paw = ellipsoid_distance(q, {1.45, 0.4, 4.3}, {1.4, 1.6, 1.6});
    const double hind_paw = ellipsoid_distance(q, {3.7, 0.35, 2.5}, {1.3, 1.6, 2.0});
    // Fills the narrow gap between the front feet, where no range finder sees the ground.
    const double between = ellipsoid_distance(q, {0, 0.4, 3.7}, {1.2, 1.7, 1.5});
    const double front_feet = smooth_union(smooth_union(front, front_paw, 1.0), between, 0.6);
    return smooth_union(front_feet, hind_paw, 0.5);
}

using TailPoints = std::array<ChainPoint, 17>;

TailPoints make_tail() {
    TailPoints points;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double t = double(i) / double(points.size() - 1);
        const double azimuth = radians(185.0 - 140.0 * t);
        const double distance = 4.35 + 0.3 * std::sin(kPi * t);
        const Vec3 position(
            distance * std::sin(azimuth), kTailHeight, distance * std::cos(azimuth));
        points[i] = {position, kTailRadius - 0.3 * t};
    }
    return points;
}

double tail(const Vec3& p) {
    static const TailPoints points = make_tail();
    // High above it, the distance to its highest plane is bound enough, and quicker.
    const double above = p.y() - (kTailHeight + kTailRadius);
    return above > 1.0 ? above : chain_distance(p, points);
}

double ears(const Vec3& q) {
    const double shell = rounded_cone_distance(q, {1.7, 16.0, 0.7}, {2.35, 18.9, 0.6}, 1.5, 0.4);
    const double slab = std::abs(q.z() - 0.65) - 0.9;
    const double flattened = smooth_difference(shell, -slab, 0.5);
    const double hollow = ellipsoid_distance(q, {2.05, 17.1, 2.1}, {0.85, 1.5, 0.8});
    return smooth_difference(flattened, hollow, 0.5);
}

double head(const Vec3& p, const Vec3& q) {
    double d = ellipsoid_distance(p, {0, 14.4, 0.9}, {3.5, 2.9, 3.1});
    const double cheek = sphere_distance(q, {1.9, 13.6, 1.7}, 1.7);
    d = smooth_union(d, cheek, 0.8);
    d = smooth_union(d, ears(q), 0.8);
    const double muzzle = ellipsoid_distance(q, {0.72, 13.35, 3.75}, {0.95, 0.8, 0.85});
    d = smooth_union(d, muzzle, 0.3);
    const double chin = sphere_distance(p, {0, 12.75, 3.4}, 0.7);
    d = smooth_union(d, chin, 0.25);
    const double bridge = capsule_distance(p, {0, 14.1, 4.0}, {0, 15.6, 3.3}, 0.5);
    d = smooth_union(d, bridge, 0.5);
    const double nose = ellipsoid_distance(p, kNose, kNoseRadii);
    d = smooth_union(d, nose, 0.12);
    const double socket = ellipsoid_distance(q, {1.35, 15.0, 3.85}, {1.1, 0.9, 0.6});
    d = smooth_difference(d, socket, 0.6);
    const double eye = ellipsoid_distance(q, kEye, kEyeRadii);
    return smooth_union(d, eye, 0.3);
}

double cat_distance(const Vec3& p) {
    const Vec3 q = fold_at_x0(p, kFoldWidth);
    double d = smooth_union(body(p, q), legs(q), 0.5);
    d = smooth_union(d, tail(p), 0.6);
    d = smooth_union(d, head(p, q), 0.5);
    return smooth_difference(d, p.y(), 0.2);
}

// Ginger stripes: waves round the body's axis, bent and broken by noise. 0 between them, 1 on them.
double stripes(const Vec3& p) {
    const double bend = 0.9 * smooth_noise(p, 2.5, 11) + 0.35 * std::abs(p.x());
    const double wave = std::sin(2 * kPi * (p.y() + 0.5 * p.z() + bend) / 2.1);
    return smooth_step(0.1, 0.6, wave + 0.35 * smooth_noise(p, 1.6, 12));
}

// White on the muzzle, the chest and the feet.
double white_parts(const Vec3& p, const Vec3& q) {
    const double wobble = 0.35 * smooth_noise(p, 1.2, 13);
    const double bib = ellipsoid_distance(p, {0, 8.2, 4.6}, {1.9, 3.6, 2.6});
    const double muzzle = ellipsoid_distance(q, {0.5, 13.1, 3.9}, {1.5, 1.2, 1.6});
    const double feet = std::max(p.y() - 1.7, 1.2 - p.z());
    const double tail_tip = sphere_distance(p, {3.8, 0.6, 3.8}, 1.6);
    const double distance = std::min({bib, muzzle, feet, tail_tip}) + wobble;
    return 1 - smooth_step(-0.2, 0.2, distance);
}

// p: in centimetres; crease: depth of the crease there, 0 to 1.
Finish cat_finish(const Vec3& p, double crease) {
    const Vec3 q = fold_at_x0(p, kFoldWidth);
    const Finish ginger{Rgb(0.60, 0.34, 0.16), 0.022, 0.19};
    const Finish stripe{Rgb(0.30, 0.15, 0.11), 0.030, 0.14};
    const Finish white{Rgb(0.78, 0.74, 0.66), 0.014, 0.23};
    const Finish nose{Rgb(0.66, 0.34, 0.32), 0.045, 0.11};
    const Finish eye{Rgb(0.22, 0.38, 0.14), 0.048, 0.09};
    const Finish pupil{Rgb(0.11, 0.11, 0.11), 0.048, 0.09};
    const Finish pale{Rgb(0.82, 0.76, 0.68), 0.016, 0.24};
    Finish finish = blend(ginger, stripe, stripes(p));
    finish = blend(finish, white, white_parts(p, q));
    finish.gloss *= 1 + 0.35 * smooth_noise(p, 3.0, 14);
    finish.roughness *= 1 + 0.25 * smooth_noise(p, 2.2, 15);
    finish.diffuse *= 1 + 0.08 * smooth_noise(p, 0.5, 16);
    // The glaze of an old figurine stays bright where nobody touches it.
    finish = blend(finish, pale, smooth_step(0.06, 0.3, crease));
    finish =
        blend(finish, nose, 1 - smooth_step(0.0, 0.15, ellipsoid_distance(p, kNose, kNoseRadii)));
    const double iris = (q - kEye).cwiseQuotient(kEyeRadii).norm();
    finish = blend(finish, eye, 1 - smooth_step(1.03, 1.15, iris));
    const double slit = (q - kEye).cwiseQuotient(Vec3(0.26, 0.63, 1.0)).norm();
    return blend(finish, pupil, 1 - smooth_step(0.8, 1.0, slit));
}

}  // namespace

Figurine make_cat() {
    Figurine cat;
    cat.distance = [](const Vec3& p) { return kCentimeter * cat_distance(p / kCentimeter); };
    cat.bounds = {Vec3(-0.085, -0.01, -0.08), Vec3(0.085, 0.205, 0.08)};
    cat.reflectance = [distance = cat.distance](const Vec3& p, const Vec3& n) {
        const double crease = crease_depth(distance, p, n, kCreaseRadius);
        return make_reflectance(cat_finish(p / kCentimeter, crease));
    };
    return cat;
}

}  // namespace patina
