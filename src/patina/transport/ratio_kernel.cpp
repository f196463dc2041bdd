#include "patina/transport/ratio_kernel.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace patina {
namespace {

constexpr double kMinNormalCosine = 0.7;
constexpr double kPlaneShare = 0.1;  // of the radius
// Beyond this many sigma of the widest of the three lobes nothing is added: 1 % of that one's
// light, and less than 1e-7 of the middle one's.
constexpr float kLobeReachSquared = 3.0f * 3.0f;
constexpr std::size_t kTexelsPerBlock = 1024;
// A lobe is seen through at most about this many arrivals; of more, every n-th is taken.
constexpr std::size_t kMaxLobeArrivals = 192;

float square_of(float x) { return x * x; }

// Square of the angle whose cosine is 1 - u [rad^2]: the series of arccos^2, relative error below
// 2e-4 for u <= 0.7, where every lobe narrower than a fifth of a radian has faded.
float squared_angle(float u) {
    return u * (2.0f +
                u * (1.0f / 3 +
                     u * (4.0f / 45 + u * (1.0f / 35 + u * (16.0f / 1575 + u * (8.0f / 2079))))));
}

// exp(x) for -20 < x <= 0, relative error below 2e-6: exp(x / 16) by its series, squared four
// times.
float exp_of_negative(float x) {
    const float t = x * 0.0625f;
    float e =
        1 + t * (1 + t * (1.0f / 2 +
                          t * (1.0f / 6 + t * (1.0f / 24 + t * (1.0f / 120 + t * (1.0f / 720))))));
    e *= e;
    e *= e;
    e *= e;
    return e * e;
}

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

// Finds kernels one after the other, reusing its memory.
class KernelFinder {
  public:
    KernelFinder(const TexelAtlas& atlas,
                 std::span<const double> arrivals,
                 const RatioKernelOptions& options)
        : atlas_(atlas),
          arrivals_(arrivals),
          options_(options),
          visited_(atlas.texels.size(), kNoTexel) {}

    void append(TexelId center, std::vector<KernelEntry>& entries) {
        const Texel& texel = atlas_.texels[center];
        const double size = std::sqrt(texel.area);
        collect(center, options_.max_radius * size);
        std::sort(candidates_.begin(), candidates_.end());
        if (candidates_.size() > std::size_t(options_.max_texels)) {
            candidates_.resize(std::size_t(options_.max_texels));
        }
        double count = 0;
        double radius = 0;
        for (const Candidate& candidate : candidates_) {
            count += arrivals_[candidate.texel];
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
            area += kappa * atlas_.texels[candidate.texel].area;
        }
        for (std::size_t i = first; i < entries.size(); ++i) entries[i].weight /= float(area);
    }

  private:
    void collect(TexelId center, double reach) {
        const SurfacePoint& middle = atlas_.texels[center].point;
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
                const SurfacePoint& point = atlas_.texels[to].point;
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
    std::span<const double> arrivals_;
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
    std::vector<std::vector<KernelEntry>> blocks(num_blocks);
    RatioKernel kernel;
    kernel.begin.assign(num_texels + 1, 0);
    // One finder serves a long run of blocks: its memory is as large as the atlas.
    const std::size_t blocks_per_run = std::max<std::size_t>(1, num_blocks / 8);
    parallel_blocks(num_blocks, blocks_per_run, [&](std::size_t first, std::size_t last) {
        KernelFinder finder(atlas, arrivals, options);
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
    kernel.texel.reserve(kernel.begin.back());
    kernel.weight.reserve(kernel.begin.back());
    for (std::vector<KernelEntry>& block : blocks) {
        for (const KernelEntry& entry : block) {
            kernel.texel.push_back(entry.texel);
            kernel.weight.push_back(entry.weight);
        }
        block = {};
    }
    return kernel;
}

IndirectIrradiance indirect_irradiance(const RatioKernel& kernel,
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
    IndirectIrradiance result;
    for (int half = 0; half < 2; ++half) {
        result.halves[half].assign(num_texels, Rgbf::Zero());
        parallel_for(num_texels, [&](std::size_t i) {
            Rgbf sum = Rgbf::Zero();
            for (std::size_t k = kernel.begin[i]; k < kernel.begin[i + 1]; ++k) {
                sum += kernel.weight[k] * sums[half][kernel.texel[k]];
            }
            // Half of the photons carries half of the power.
            result.halves[half][i] = 2 * sum;
        });
    }
    return result;
}

namespace {

// The arrivals in one lobe, side by side so that the exponentials are taken in SIMD lanes.
class LobeBatch {
  public:
    void clear() { size_ = 0; }

    // versine: 1 - cos of the mirror angle. light: power times everything that does not depend on
    // sigma.
    void add(float versine, const Rgbf& light) {
        versine_[size_] = versine;
        for (std::size_t c = 0; c < 3; ++c) light_[c][size_] = light[Eigen::Index(c)];
        ++size_;
    }
    [[nodiscard]] bool full() const { return size_ == kCapacity; }

    // Adds the batch, in its order, to the three sums.
    void add_to(IndirectLobe& sum, float inverse_widest) {
        for (std::size_t i = 0; i < size_; ++i) {
            // The three Gaussians are powers of each other.
            twice_[i] = exp_of_negative(-0.5f * squared_angle(versine_[i]) * inverse_widest);
            same_[i] = square_of(square_of(twice_[i]));
            half_[i] = square_of(square_of(same_[i]));
        }
        for (std::size_t c = 0; c < 3; ++c) {
            const auto channel = Eigen::Index(c);
            for (std::size_t i = 0; i < size_; ++i) {
                sum.twice[channel] += light_[c][i] * twice_[i];
                sum.same[channel] += light_[c][i] * same_[i];
                sum.half[channel] += light_[c][i] * half_[i];
            }
        }
        clear();
    }

  private:
    static constexpr std::size_t kCapacity = 256;
    std::array<float, kCapacity> versine_, twice_, same_, half_;
    std::array<std::array<float, kCapacity>, 3> light_;
    std::size_t size_ = 0;
};

// Every stride-th arrival in reach of a kernel, so that about kMaxLobeArrivals are looked at.
std::uint32_t lobe_stride(const RatioKernel& kernel, const PhotonPaths& paths, std::size_t texel) {
    std::size_t count = 0;
    for (std::size_t k = kernel.begin[texel]; k < kernel.begin[texel + 1]; ++k) {
        const TexelId y = kernel.texel[k];
        count += paths.arrivals_begin[y + 1] - paths.arrivals_begin[y];
    }
    return std::uint32_t((count + kMaxLobeArrivals - 1) / kMaxLobeArrivals);
}

}  // namespace

std::vector<IndirectLobe> indirect_lobe(const RatioKernel& kernel,
                                        const PhotonPaths& paths,
                                        std::span<const Rgbf> power,
                                        const TexelAtlas& atlas,
                                        std::span<const Vec3f> w_v,
                                        std::span<const Reflectance> maps,
                                        std::span<const std::uint8_t> wanted) {
    std::vector<IndirectLobe> result(atlas.texels.size());
    parallel_blocks(result.size(), kTexelsPerBlock, [&](std::size_t begin, std::size_t end) {
        LobeBatch batch;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3f normal = atlas.texels[i].point.normal.cast<float>();
            const float cos_v = normal.dot(w_v[i]);
            if (wanted[i] == 0 || cos_v <= 0) continue;
            const Vec3f mirror = 2 * cos_v * normal - w_v[i];
            const float variance = float(square(maps[i].roughness));
            // Of the widest lobe. theta^2 >= 2 (1 - cos): a test without an arc cosine.
            const float inverse_widest = 1 / (4 * variance);
            const float max_versine = 0.5f * kLobeReachSquared / inverse_widest;
            const std::uint32_t stride = lobe_stride(kernel, paths, i);
            // From the middle of the first stride, so that no arrival is favoured.
            std::uint32_t to_skip = stride / 2;
            IndirectLobe& sum = result[i];
            for (std::size_t k = kernel.begin[i]; k < kernel.begin[i + 1]; ++k) {
                const std::uint32_t last = paths.arrivals_begin[kernel.texel[k] + 1];
                std::uint32_t a = paths.arrivals_begin[kernel.texel[k]] + to_skip;
                for (; a < last; a += stride) {
                    const Vec3f& w_i = paths.arrival_direction[a];
                    const float versine = 1 - mirror.dot(w_i);
                    const float cos_i = normal.dot(w_i);
                    if (versine > max_versine || cos_i <= 0) continue;
                    batch.add(versine,
                              power[a] * (kernel.weight[k] / std::max(cos_i, float(kCosineFloor))));
                    if (batch.full()) batch.add_to(sum, inverse_widest);
                }
                to_skip = a - last;
            }
            batch.add_to(sum, inverse_widest);
            const float scale = float(stride) / (std::max(cos_v, float(kCosineFloor)) * variance);
            sum.half *= 4 * scale;
            sum.same *= scale;
            sum.twice *= 0.25f * scale;
        }
    });
    return result;
}

}  // namespace patina
