#include "patina/estimate/footprint_blur.h"

#include "patina/base/parallel.h"
#include "patina/estimate/ring_sums.h"
#include "patina/scene/grid_neighbors.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {
namespace {

constexpr int kRings = 1;

// Root of the ratio of the second differences over one and over two texels, and the root mean
// square difference between a texel's mean and its centre over the second difference: at edges of
// Gaussian profile from infinite width to none, in the mean over where they lie in a texel.
struct EdgeRatio {
    double differences;
    double blur;
};
constexpr std::array<EdgeRatio, 9> kEdges = {{{0.25, 1.0 / 24},
                                              {0.326, 0.0485},
                                              {0.402, 0.0595},
                                              {0.469, 0.0775},
                                              {0.507, 0.0973},
                                              {0.542, 0.134},
                                              {0.567, 0.199},
                                              {0.574, 0.250},
                                              {0.577350269, 0.288675135}}};
constexpr double kTableMoment = 1.0 / 12;  // of the footprint that the table holds for

// Squares of the second differences about one texel, over one and over two texels.
struct Differences {
    Parameters over_one = Parameters::Zero();
    Parameters over_two = Parameters::Zero();
    double count = 0;

    Differences& operator+=(const Differences& other) {
        over_one += other.over_one;
        over_two += other.over_two;
        count += other.count;
        return *this;
    }
};

class Blur {
  public:
    Blur(const TexelAtlas& atlas,
         std::span<const Parameters> maps,
         std::span<const Parameters> noise,
         std::span<const std::uint8_t> observed)
        : atlas_(atlas), maps_(maps), noise_(noise), observed_(observed) {}

    [[nodiscard]] Differences differences(std::size_t i) const {
        Differences result;
        if (observed_[i] == 0) return result;
        const GridNeighbors near = grid_neighbors(atlas_, i);
        for (const std::size_t axis : {0, 2}) {
            const TexelId before = near[axis];
            const TexelId after = near[axis + 1];
            if (!usable(before) || !usable(after)) continue;
            const TexelId far_before = grid_neighbors(atlas_, before)[axis];
            const TexelId far_after = grid_neighbors(atlas_, after)[axis + 1];
            if (!usable(far_before) || !usable(far_after)) continue;
            result.over_one += second(before, i, after).cwiseAbs2() - noise_[before] -
                               noise_[after] - 4 * noise_[i];
            result.over_two += second(far_before, i, far_after).cwiseAbs2() - noise_[far_before] -
                               noise_[far_after] - 4 * noise_[i];
            result.count = 1;
        }
        return result;
    }

  private:
    [[nodiscard]] bool usable(TexelId texel) const {
        return texel != kNoTexel && observed_[texel] != 0;
    }
    [[nodiscard]] Parameters second(TexelId before, std::size_t i, TexelId after) const {
        return maps_[before] + maps_[after] - 2 * maps_[i];
    }

    const TexelAtlas& atlas_;
    std::span<const Parameters> maps_;
    std::span<const Parameters> noise_;
    std::span<const std::uint8_t> observed_;
};

double blur_ratio(double differences) {
    if (differences <= kEdges.front().differences) return kEdges.front().blur;
    for (std::size_t k = 1; k < kEdges.size(); ++k) {
        if (differences > kEdges[k].differences) continue;
        const EdgeRatio& low = kEdges[k - 1];
        const EdgeRatio& high = kEdges[k];
        const double t = (differences - low.differences) / (high.differences - low.differences);
        return low.blur + t * (high.blur - low.blur);
    }
    return kEdges.back().blur;
}

// over_one, over_two: mean squares.
double blur_variance(double over_one, double over_two) {
    if (!(over_two > 0) || !(over_one > 0)) return 0;
    // White noise adds alike to both; a jump, three times as much to the second.
    const double texture = std::min(over_one, 0.5 * (over_two - over_one));
    if (!(texture > 0)) return 0;
    const double ratio = texture < over_one ? 1.0 : std::sqrt(over_one / over_two);
    return square(blur_ratio(ratio)) * texture;
}

}  // namespace

LargeVector<Parameters> footprint_blur(const TexelAtlas& atlas,
                                       std::span<const Parameters> maps,
                                       std::span<const Parameters> noise,
                                       std::span<const std::uint8_t> observed,
                                       double moment) {
    const Blur blur(atlas, maps, noise, observed);
    LargeVector<Differences> sums(maps.size());
    parallel_for(sums.size(), [&](std::size_t i) { sums[i] = blur.differences(i); });
    sum_over_rings(atlas, kRings, sums);
    LargeVector<Parameters> variance(maps.size(), Parameters::Zero());
    parallel_for(sums.size(), [&](std::size_t i) {
        if (sums[i].count == 0) return;
        for (int k = 0; k < kNumParameters; ++k) {
            variance[i][k] =
                square(moment / kTableMoment) * blur_variance(sums[i].over_one[k] / sums[i].count,
                                                              sums[i].over_two[k] / sums[i].count);
        }
    });
    return variance;
}

}  // namespace patina
