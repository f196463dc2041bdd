#include "patina/transport/ratio_kernel.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/reflectance/lobe_lanes.h"
#include "patina/transport/lobe_reach.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace patina {
namespace {

constexpr double kMinNormalCosine = 0.7;
constexpr double kPlaneShare = 0.1;  // of the radius
constexpr float kLobeReachSquared = kLobeReach * kLobeReach;
constexpr std::size_t kTexelsPerBlock = 1024;
// A lobe is seen through at most about this many arrivals; of more, every n-th is taken.
constexpr std::size_t kMaxLobeArrivals = 192;

float square_of(float x) { return x * x; }

struct Candidate {
    double distance = 0;  // [length]
    TexelId texel = kNoTexel;
    bool operator<(const Candidate& other) const {
        return distance != other.distance ? distance < other.distance : texel < other.texel;
    }
};

struct KernelEntry {
    TexelId texel;
    float weight;
};

// What a kernel needs to know of a texel: one cache line.
struct alignas(64) KernelPoint {
    Vec3 position;
    Vec3 normal;
    double area = 0;
    double arrivals = 0;
};

LargeVector<KernelPoint> kernel_points(const TexelAtlas& atlas, std::span<const double> arrivals) {
    LargeVector<KernelPoint> points(atlas.texels.size());
    parallel_for(points.size(), [&](std::size_t i) {
        const Texel& texel = atlas.texels[i];
        points[i] = {texel.point.position, texel.point.normal, texel.area, arrivals[i]};
    });
    return points;
}

// Finds kernels one after the other, reusing its memory.
class KernelFinder {
  public:
    KernelFinder(const TexelAtlas& atlas,
                 std::span<const KernelPoint> points,
                 const RatioKernelOptions& options)
        : atlas_(atlas),
          points_(points),
          options_(options),
          visited_(atlas.texels.size(), kNoTexel) {}

    void append(TexelId center, std::vector<KernelEntry>& entries) {
        const double size = std::sqrt(points_[center].area);
        collect(center, options_.max_radius * size);
        std::sort(candidates_.begin(), candidates_.end());
        if (candidates_.size() > std::size_t(options_.max_texels)) {
            candidates_.resize(std::size_t(options_.max_texels));
        }
        double count = 0;
        double radius = 0;
        for (const Candidate& candidate : candidates_) {
            count += points_[candidate.texel].arrivals;
            radius = candidate.distance;
            if (count >= options_.arrivals && radius >= options_.min_radius * size) break;
        }
        if (count <= 0) return;
        // The outermost texel keeps a positive weight.
        radius = std::max(radius, options_.min_radius * size) * 1.05;
        double area = 0;
        const std::size_t first = entries.size();
        for (const Candidate& candidate : candidates_) {
            if (candidate.distance >= radius) break;
            const double kappa = 1 - square(candidate.distance / radius);
            entries.push_back({candidate.texel, float(kappa)});
            area += kappa * points_[candidate.texel].area;
        }
        for (std::size_t i = first; i < entries.size(); ++i) entries[i].weight /= float(area);
    }

  private:
    void collect(TexelId center, double reach) {
        const KernelPoint& middle = points_[center];
        candidates_.clear();
        candidates_.push_back({0.0, center});
        visited_[center] = center;
        for (std::size_t i = 0; i < candidates_.size(); ++i) {
            const TexelId from = candidates_[i].texel;
            for (std::uint32_t k = atlas_.neighbor_begin[from]; k < atlas_.neighbor_begin[from + 1];
                 ++k) {
                const TexelId to = atlas_.neighbors[k];
                if (visited_[to] == center) continue;
                visited_[to] = center;
                const KernelPoint& point = points_[to];
                const Vec3 offset = point.position - middle.position;
                const double distance = offset.norm();
                if (distance >= reach || point.normal.dot(middle.normal) < kMinNormalCosine ||
                    std::abs(offset.dot(middle.normal)) > kPlaneShare * reach) {
                    continue;
                }
                candidates_.push_back({distance, to});
            }
        }
    }

    const TexelAtlas& atlas_;
    std::span<const KernelPoint> points_;
    const RatioKernelOptions& options_;
    std::vector<TexelId> visited_;  // the centre that saw this texel last
    std::vector<Candidate> candidates_;
};

}  // namespace

RatioKernel build_ratio_kernel(const TexelAtlas& atlas,
                               std::span<const double> arrivals,
                               const RatioKernelOptions& options) {
    PATINA_CHECK_EQ(arrivals.size(), atlas.texels.size());
    const std::size_t num_texels = atlas.texels.size();
    const std::size_t num_blocks = (num_texels + kTexelsPerBlock - 1) / kTexelsPerBlock;
    const LargeVector<KernelPoint> points = kernel_points(atlas, arrivals);
    std::vector<std::vector<KernelEntry>> blocks(num_blocks);
    RatioKernel kernel;
    kernel.begin.assign(num_texels + 1, 0);
    // One finder serves a long run of blocks: its memory is as large as the atlas.
    const std::size_t blocks_per_run = std::max<std::size_t>(1, num_blocks / 8);
    parallel_blocks(num_blocks, blocks_per_run, [&](std::size_t first, std::size_t last) {
        KernelFinder finder(atlas, points, options);
        for (std::size_t block = first; block < last; ++block) {
            const std::size_t end = std::min(num_texels, (block + 1) * kTexelsPerBlock);
            for (std::size_t i = block * kTexelsPerBlock; i < end; ++i) {
                const std::size_t before = blocks[block].size();
                finder.append(TexelId(i), blocks[block]);
                kernel.begin[i + 1] = blocks[block].size() - before;
            }
        }
    });
    std::partial_sum(kernel.begin.begin(), kernel.begin.end(), kernel.begin.begin());
    kernel.texel.resize(kernel.begin.back());
    kernel.weight.resize(kernel.begin.back());
    parallel_for(
        num_blocks,
        [&](std::size_t block) {
            std::size_t k = kernel.begin[block * kTexelsPerBlock];
            for (const KernelEntry& entry : blocks[block]) {
                kernel.texel[k] = entry.texel;
                kernel.weight[k++] = entry.weight;
            }
            blocks[block] = {};
        },
        1);
    return kernel;
}

std::vector<IndirectIrradiance> indirect_irradiance(const RatioKernel& kernel,
                                                    const PhotonPaths& paths,
                                                    std::span<const Rgbf> power) {
    const std::size_t num_texels = kernel.begin.size() - 1;
    std::vector<Rgbf> sums[2];
    for (auto& half : sums) half.assign(num_texels, Rgbf::Zero());
    parallel_for(num_texels, [&](std::size_t i) {
        for (std::uint32_t k = paths.arrivals_begin[i]; k < paths.arrivals_begin[i + 1]; ++k) {
            sums[paths.arrival_half[k]][i] += power[k];
        }
    });
    std::vector<IndirectIrradiance> result(num_texels);
    for (std::size_t half = 0; half < 2; ++half) {
        parallel_for(num_texels, [&](std::size_t i) {
            Rgbf sum = Rgbf::Zero();
            for (std::size_t k = kernel.begin[i]; k < kernel.begin[i + 1]; ++k) {
                sum += kernel.weight[k] * sums[half][kernel.texel[k]];
            }
            // Half of the photons carries half of the power.
            result[i].halves[half] = 2 * sum;
        });
    }
    return result;
}

namespace {

// How a texel is looked at: where its lobe points and how far it reaches.
struct LobeView {
    Vec3f normal;
    Vec3f mirror;
    float inverse_widest = 0;  // 1 / sigma^2 of the widest of the three lobes [rad^-2]
    float max_versine = 0;     // 1 - cos of the mirror angle that it reaches to
};

// The arrivals that a lobe looks at, side by side so that everything is computed in SIMD lanes. The
// lanes are summed apart, so the sums do not depend on how many the processor has.
class LobeBatch {
  public:
    void add(const Vec3f& w_i, const Rgbf& light) {
        x_[size_] = w_i.x();
        y_[size_] = w_i.y();
        z_[size_] = w_i.z();
        for (std::size_t c = 0; c < 3; ++c) light_[c][size_] = light[Eigen::Index(c)];
        ++size_;
    }
    [[nodiscard]] bool full() const { return size_ == kCapacity; }

    // Adds the batch to the three sums and empties it.
    void add_to(IndirectLobe& sum, const LobeView& view) {
        // Whole groups of lanes; what fills up the last one is dark.
        for (; size_ % kSumLanes != 0;) add(view.mirror, Rgbf::Zero());
        weigh(view);
        for (std::size_t c = 0; c < 3; ++c) {
            const auto channel = Eigen::Index(c);
            sum.twice[channel] += lane_sum(light_[c], twice_);
            sum.same[channel] += lane_sum(light_[c], same_);
            sum.half[channel] += lane_sum(light_[c], half_);
        }
        size_ = 0;
    }

  private:
    static constexpr std::size_t kCapacity = 256;
    static constexpr std::size_t kSumLanes = 8;
    using Lane = std::array<float, kCapacity>;

    // The three Gaussians over max(cos_i, c0); zero out of reach.
    // view by value, size kept: nothing that is stored may change them, or the loop has no lanes.
    void weigh(const LobeView view) {
        const std::size_t size = size_;
        for (std::size_t i = 0; i < size; ++i) {
            const float versine =
                1 - (view.mirror.x() * x_[i] + view.mirror.y() * y_[i] + view.mirror.z() * z_[i]);
            const float cos_i =
                view.normal.x() * x_[i] + view.normal.y() * y_[i] + view.normal.z() * z_[i];
            const float over_cosine = 1 / std::max(cos_i, float(kCosineFloor));
            const float in_reach = (versine <= view.max_versine) & (cos_i > 0) ? over_cosine : 0.0f;
            // The three are powers of each other. The reach keeps them from underflow, which is
            // slow.
            const float twice = exp_of_negative(
                -0.5f * squared_angle(std::min(versine, view.max_versine)) * view.inverse_widest);
            const float same = square_of(square_of(twice));
            twice_[i] = in_reach * twice;
            same_[i] = in_reach * same;
            half_[i] = in_reach * square_of(square_of(same));
        }
    }

    [[nodiscard]] float lane_sum(const Lane& light, const Lane& weight) const {
        std::array<float, kSumLanes> sums{};
        for (std::size_t i = 0; i < size_; i += kSumLanes) {
            for (std::size_t k = 0; k < kSumLanes; ++k) sums[k] += light[i + k] * weight[i + k];
        }
        float sum = 0;
        for (const float part : sums) sum += part;
        return sum;
    }

    Lane x_, y_, z_, twice_, same_, half_;
    std::array<Lane, 3> light_;
    std::size_t size_ = 0;
};

// The arrivals within reach of a kernel: a range per texel of the kernel.
struct ArrivalRange {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
    float weight = 0;  // the kernel's [1/length^2]
};

// Returns how many arrivals there are.
std::size_t find_arrivals(const RatioKernel& kernel,
                          const PhotonPaths& paths,
                          std::size_t texel,
                          std::vector<ArrivalRange>& ranges) {
    ranges.clear();
    std::size_t count = 0;
    for (std::size_t k = kernel.begin[texel]; k < kernel.begin[texel + 1]; ++k) {
        const std::uint32_t* begin = &paths.arrivals_begin[kernel.texel[k]];
        if (begin[0] == begin[1]) continue;
        ranges.push_back({begin[0], begin[1], kernel.weight[k]});
        count += begin[1] - begin[0];
    }
    return count;
}

}  // namespace

void add_indirect_lobe(const RatioKernel& kernel,
                       const PhotonPaths& paths,
                       std::span<const Rgbf> power,
                       const TexelAtlas& atlas,
                       std::span<const Vec3f> w_v,
                       std::span<const Reflectance> maps,
                       std::span<const std::uint8_t> wanted,
                       LobeColumn sums) {
    parallel_blocks(atlas.texels.size(), kTexelsPerBlock, [&](std::size_t begin, std::size_t end) {
        LobeBatch batch;
        std::vector<ArrivalRange> ranges;
        for (std::size_t i = begin; i < end; ++i) {
            LobeView view;
            view.normal = atlas.texels[i].point.normal.cast<float>();
            const float cos_v = view.normal.dot(w_v[i]);
            if (wanted[i] == 0 || cos_v <= 0) continue;
            view.mirror = 2 * cos_v * view.normal - w_v[i];
            const float variance = float(square(maps[i].roughness));
            // Of the widest lobe. theta^2 >= 2 (1 - cos): a test without an arc cosine.
            view.inverse_widest = 1 / (4 * variance);
            view.max_versine = 0.5f * kLobeReachSquared / view.inverse_widest;
            const std::size_t count = find_arrivals(kernel, paths, i, ranges);
            // Of many, every stride-th is taken, from the middle of the first stride on, so that
            // no arrival is favoured.
            const auto stride = std::uint32_t((count + kMaxLobeArrivals - 1) / kMaxLobeArrivals);
            std::uint32_t to_skip = stride / 2;
            IndirectLobe sum;
            for (const ArrivalRange& range : ranges) {
                std::uint32_t a = range.begin + to_skip;
                for (; a < range.end; a += stride) {
                    batch.add(paths.arrival_direction[a], power[a] * range.weight);
                    if (batch.full()) batch.add_to(sum, view);
                }
                to_skip = a - range.end;
            }
            batch.add_to(sum, view);
            const float scale = float(stride) / (std::max(cos_v, float(kCosineFloor)) * variance);
            sum.half *= 4 * scale;
            sum.same *= scale;
            sum.twice *= 0.25f * scale;
            sums[i] += sum;
        }
    });
}

}  // namespace patina
