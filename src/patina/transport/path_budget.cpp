#include "patina/transport/path_budget.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patina {
namespace {

// Pixels that a thread takes at once; short enough for progress and for Ctrl-C.
constexpr std::size_t kPixelBlock = 64;
// Paths of each of a pixel's pilot streams. They are to be an eighth of all paths at most: with
// fewer others a pilot costs more than it saves.
constexpr int kPilotPaths = 8;
constexpr int kPathsOverPilot = 8;
// A pixel has between a quarter and 16 times the mean of the image, in sixteenths of it.
constexpr int kUnitsOfMean = 16;
constexpr int kUnitsOfSmallest = 4;
constexpr int kUnitsOfLargest = 256;
// Noise is averaged over pixels so near: a pilot misses the rare paths of some and finds them
// beside.
constexpr int kSmoothingRadius = 2;
// Where the noise seems smaller than this share of its mean, the pilot has only missed it.
constexpr double kSmallestDeviation = 0.01;
// Halvings of the interval of log(paths per deviation), to the last bit of a double.
constexpr int kNumHalvings = 64;

int power_of_two_below(int number) {
    int power = 1;
    while (2 * power <= number) power *= 2;
    return power;
}

struct PixelNoise {
    bool is_shown = false;  // a path of the pilot shows the surface
    bool is_known = false;  // at least two streams do
    double variance = 0;    // of one stream's mean, summed over channels [radiance^2]
};

// From the spread of the pilot's streams: unlike that of single paths, it is free of what their
// stratification takes away.
PixelNoise pilot_noise(std::size_t pixel, const TracePaths& trace) {
    PixelNoise noise;
    Rgb sum = Rgb::Zero();
    Rgb squares = Rgb::Zero();
    int count = 0;
    for (std::uint32_t pilot = 0; pilot < kNumPilots; ++pilot) {
        const PathSum paths = trace(pixel, kNumHalves + pilot, kPilotPaths);
        if (paths.num_seen == 0) continue;
        const Rgb mean = paths.radiance / paths.num_seen;
        sum += mean;
        squares += mean.square();
        ++count;
    }
    noise.is_shown = count > 0;
    noise.is_known = count > 1;
    if (noise.is_known) {
        noise.variance = std::max(0.0, (squares - sum.square() / count).sum() / (count - 1));
    }
    return noise;
}

// Root of the mean variance around a pixel.
double smooth_deviation(std::span<const PixelNoise> noise, int width, int height, int pixel) {
    const int column = pixel % width;
    const int row = pixel / width;
    double sum = 0;
    int count = 0;
    for (int y = std::max(0, row - kSmoothingRadius);
         y <= std::min(height - 1, row + kSmoothingRadius);
         ++y) {
        for (int x = std::max(0, column - kSmoothingRadius);
             x <= std::min(width - 1, column + kSmoothingRadius);
             ++x) {
            const PixelNoise& near = noise[std::size_t(y) * std::size_t(width) + std::size_t(x)];
            if (!near.is_known) continue;
            sum += near.variance;
            ++count;
        }
    }
    return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

bool is_worth_a_pilot(int mean_paths) {
    return mean_paths >= kPathsOverPilot * kPilotPaths * int(kNumPilots);
}

std::vector<int> plan_paths(
    int width, int height, int mean_paths, const TracePaths& trace, Progress& progress) {
    PATINA_CHECK(is_worth_a_pilot(mean_paths));
    const std::size_t num_pixels = std::size_t(width) * std::size_t(height);
    const int of_pilot = kPilotPaths * int(kNumPilots);
    std::vector<PixelNoise> noise(num_pixels);
    parallel_blocks(num_pixels, kPixelBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) noise[i] = pilot_noise(i, trace);
        progress.advance((end - begin) * std::uint64_t(of_pilot));
    });

    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < num_pixels; ++i) {
        if (noise[i].is_shown) shown.push_back(i);
    }
    std::vector<double> deviation(shown.size());
    parallel_for(shown.size(), [&](std::size_t i) {
        deviation[i] = smooth_deviation(noise, width, height, int(shown[i]));
    });
    ShareLimits limits;
    limits.mean = mean_paths - of_pilot;
    limits.unit = power_of_two_below(mean_paths) / kUnitsOfMean;
    limits.smallest = kUnitsOfSmallest * limits.unit;
    limits.largest = kUnitsOfLargest * limits.unit;
    const std::vector<int> shared = share_paths(deviation, limits);
    std::vector<int> plan(num_pixels, limits.smallest);
    for (std::size_t i = 0; i < shown.size(); ++i) plan[shown[i]] = shared[i];
    return plan;
}

std::vector<int> share_paths(std::span<const double> deviation, const ShareLimits& limits) {
    PATINA_CHECK_LE(limits.smallest, limits.mean);
    PATINA_CHECK_LE(limits.mean, limits.largest);
    PATINA_CHECK_EQ(limits.smallest % limits.unit, 0);
    PATINA_CHECK_EQ(limits.largest % limits.unit, 0);
    if (deviation.empty()) return {};
    const double count = double(deviation.size());
    const double mean = std::accumulate(deviation.begin(), deviation.end(), 0.0) / count;
    const double least = mean > 0 ? kSmallestDeviation * mean : 1;
    const auto wanted = [&](std::size_t i, double factor) {
        return std::clamp(factor * std::max(deviation[i], least),
                          double(limits.smallest),
                          double(limits.largest));
    };

    // Between these factors everyone has the smallest and the largest number.
    const double most = std::max(least, *std::max_element(deviation.begin(), deviation.end()));
    double low = std::log(limits.smallest / most);
    double high = std::log(limits.largest / least);
    for (int halving = 0; halving < kNumHalvings; ++halving) {
        const double middle = 0.5 * (low + high);
        double sum = 0;
        for (std::size_t i = 0; i < deviation.size(); ++i) sum += wanted(i, std::exp(middle));
        (sum > count * limits.mean ? high : low) = middle;
    }

    // Whole units, then what is left over to those who lost most by rounding.
    std::vector<int> paths(deviation.size());
    std::vector<double> lost(deviation.size());
    std::int64_t left = std::int64_t(deviation.size()) * limits.mean;
    for (std::size_t i = 0; i < deviation.size(); ++i) {
        const double exact = wanted(i, std::exp(low));
        paths[i] = int(exact / limits.unit) * limits.unit;
        lost[i] = exact - paths[i];
        left -= paths[i];
    }
    std::vector<std::size_t> order(deviation.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return lost[a] > lost[b];
    });
    for (const std::size_t i : order) {
        if (left < limits.unit) break;
        if (paths[i] == limits.largest) continue;
        paths[i] += limits.unit;
        left -= limits.unit;
    }
    return paths;
}

Rgb noise_variance(const PathSum& first, const PathSum& second) {
    if (first.num_seen == 0 || second.num_seen == 0) return Rgb::Zero();
    const Rgb difference = first.radiance / first.num_seen - second.radiance / second.num_seen;
    const double share = first.num_seen / double(first.num_seen + second.num_seen);
    return share * (1 - share) * difference.square();
}

}  // namespace patina
