// Where an image that counts as free of noise spends its paths: where the noise is.
//
// A few pixels, those that rare bright paths reach, have most of the noise of a path-traced image.
// A pilot of few paths tells which ones, and the other paths are shared out in proportion to the
// noise's deviation, which makes the mean variance of all pixels the smallest.
//
// Based on: Neyman. On the Two Different Aspects of the Representative Method. JRSS 97(4), 1934.
#pragma once

#include "patina/base/progress.h"
#include "patina/math/types.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace patina {

// Every pixel has streams of random numbers of its own: those of the image come first, two halves
// whose difference tells the noise that is left, or one alone; then those of the pilot.
inline constexpr std::uint32_t kNumHalves = 2;
inline constexpr std::uint32_t kNumPilots = 4;
inline constexpr std::uint32_t kNumPathStreams = kNumHalves + kNumPilots;

// What some paths through one pixel add up to.
struct PathSum {
    Rgb radiance = Rgb::Zero();  // of the paths that count [radiance]
    int num_seen = 0;            // paths that count: they show the surface
};

// Sum over the first num_paths paths of one stream of a pixel. Called from many threads.
using TracePaths = std::function<PathSum(std::size_t pixel, std::uint32_t stream, int num_paths)>;

// Whether so many paths per pixel are enough for a pilot that tells anything.
[[nodiscard]] bool is_worth_a_pilot(int mean_paths);

// Paths of every pixel's image streams together, row by row: multiples of 4, so that halves stay
// stratified. With those of the pilot they are mean_paths per pixel that shows the surface, or less
// by what rounding leaves; the rest of the pixels cost little and have the smallest number there
// is. An image of these paths is as unbiased as one of a fixed number: the pilot decides how many
// paths a pixel has, and none of its own is among them. mean_paths: is_worth_a_pilot(). Adds the
// pilot's paths to the progress. The same for any number of threads. Throws Interrupted.
[[nodiscard]] std::vector<int> plan_paths(
    int width, int height, int mean_paths, const TracePaths& trace, Progress& progress);

struct ShareLimits {
    int mean = 0;      // paths per element, over all of them; from smallest to largest
    int smallest = 0;  // paths of an element; a multiple of unit
    int largest = 0;   // paths of an element; a multiple of unit
    int unit = 1;      // paths come in multiples of it; >= 1
};
// Paths in proportion to `deviation` (>= 0, any unit) within the limits; all alike where all are 0.
// Their sum is deviation.size() * mean, less than one unit short of it.
[[nodiscard]] std::vector<int> share_paths(std::span<const double> deviation,
                                           const ShareLimits& limits);

// Variance of (first + second) / (paths of both that count) as an estimate of the pixel
// [radiance^2], from the difference of two independent halves: unbiased, with one degree of
// freedom. 0 where one of them shows no surface.
[[nodiscard]] Rgb noise_variance(const PathSum& first, const PathSum& second);

}  // namespace patina
