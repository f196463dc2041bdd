#include "patina/transport/photon_paths.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/base/random.h"
#include "patina/transport/photon_wave.h"

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <numeric>
#include <utility>

namespace patina {
namespace {

// Photons handed to a thread at once; fixes the order in which paths are stored.
constexpr std::size_t kPhotonsPerBlock = 8 * PhotonWave::kSize;
// Runs of blocks that are sorted side by side; each takes four bytes per texel.
constexpr std::size_t kSortRuns = 8;
// Guides never give one of the two lobes up altogether.
constexpr double kMinGuideDiffuse = 0.02;
// Turning lamps: most photons take a lamp near the first texel's column, some a far one.
constexpr double kNearAzimuth = radians(25.0);
constexpr double kFarAzimuth = radians(110.0);
constexpr double kNearShare = 0.8;
// Turning lamps: a texel that its own column's lamp leaves dark may be lit from another column.
constexpr double kUnlitImportance = 0.2;

// Offset of the lamp's azimuth from the first texel's: a mixture of two uniform densities.
struct AzimuthSample {
    double offset = 0;   // [rad]
    double density = 1;  // [1/rad]
};

AzimuthSample sample_azimuth(double choice, double u) {
    const double half_width = choice < kNearShare ? kNearAzimuth : kFarAzimuth;
    const double offset = (2 * u - 1) * half_width;
    double density = (1 - kNearShare) / (2 * kFarAzimuth);
    if (std::abs(offset) <= kNearAzimuth) density += kNearShare / (2 * kNearAzimuth);
    return {offset, density};
}

// Where photons begin: texels in proportion to the light they send on, by stratified inversion.
class StartDistribution {
  public:
    StartDistribution(const TexelAtlas& atlas,
                      const LampSet& lamps,
                      std::span<const Reflectance> guide) {
        std::vector<double> importance(atlas.texels.size(), 0.0);
        double mean_irradiance = 0;
        for (const auto* direct : lamps.direct) {
            for (const DirectLight& light : *direct)
                mean_irradiance += double(light.irradiance.mean());
        }
        mean_irradiance /= double(std::max<std::size_t>(atlas.texels.size(), 1));
        parallel_for(importance.size(), [&](std::size_t i) {
            double irradiance = lamps.turns_with_scanner ? kUnlitImportance * mean_irradiance : 0.0;
            for (const auto* direct : lamps.direct)
                irradiance += double((*direct)[i].irradiance.mean());
            if (irradiance <= 0) return;
            const double albedo =
                guide[i].diffuse.mean() + guide[i].specular * max_lobe_albedo(guide[i].roughness);
            importance[i] = irradiance * atlas.texels[i].area * std::max(albedo, kMinGuideDiffuse);
        });
        cumulative_.resize(importance.size());
        std::partial_sum(importance.begin(), importance.end(), cumulative_.begin());
    }

    [[nodiscard]] double total() const { return cumulative_.empty() ? 0 : cumulative_.back(); }

    // Goes through the texels in their order.
    class Cursor {
      public:
        // position: the first that will be asked for.
        Cursor(const StartDistribution& start, double position)
            : cumulative_(start.cumulative_),
              total_(start.total()),
              index_(std::size_t(
                  std::upper_bound(cumulative_.begin(), cumulative_.end(), position * total_) -
                  cumulative_.begin())) {}
        // The texel at a position in [0, 1), not below the last one, and its probability.
        [[nodiscard]] std::pair<TexelId, double> at(double position) {
            const double wanted = position * total_;
            while (index_ < cumulative_.size() && cumulative_[index_] <= wanted) ++index_;
            index_ = std::min(index_, cumulative_.size() - 1);
            const double before = index_ > 0 ? cumulative_[index_ - 1] : 0.0;
            return {TexelId(index_), (cumulative_[index_] - before) / total_};
        }

      private:
        const std::vector<double>& cumulative_;
        double total_;
        std::size_t index_;
    };

  private:
    std::vector<double> cumulative_;
};

class PhotonTracer {
  public:
    PhotonTracer(const Surface& surface,
                 const TexelAtlas& atlas,
                 const LampSet& lamps,
                 std::span<const Reflectance> guide,
                 const PhotonOptions& options,
                 std::uint32_t stream)
        : surface_(surface),
          atlas_(atlas),
          lamps_(lamps),
          options_(options),
          stream_(stream),
          start_(atlas, lamps, guide),
          scene_(surface, atlas, guide) {}

    [[nodiscard]] bool has_light() const { return start_.total() > 0; }

    // Photons from begin to end - 1, wave by wave. begin: a multiple of PhotonWave::kSize.
    [[nodiscard]] PhotonBlock trace(std::uint64_t begin, std::uint64_t end) const {
        PhotonBlock block;
        const std::array hashes = {element_hash(0), element_hash(1)};
        const auto wave = std::make_unique<PhotonWave>(scene_,
                                                       atlas_,
                                                       options_,
                                                       lamps_.turns_with_scanner,
                                                       hashes,
                                                       lamps_.turns_with_scanner ? 2u : 1u);
        std::array<StartDistribution::Cursor, 2> cursors = {cursor(0, begin), cursor(1, begin)};
        for (std::uint64_t first = begin; first < end; first += PhotonWave::kSize) {
            wave->clear(static_cast<std::uint32_t>(first / 2));
            const std::uint64_t last = std::min<std::uint64_t>(first + PhotonWave::kSize, end);
            for (std::uint64_t photon = first; photon < last; ++photon) {
                PhotonWave::Start start = emit(photon, hashes[photon % 2], cursors[photon % 2]);
                start.number = std::size_t(photon - first);
                if ((start.power > 0).any()) wave->add(start);
            }
            wave->follow(block);
        }
        return block;
    }

  private:
    // Photons alternate between the two halves; each half is a stratified set of its own.
    [[nodiscard]] std::uint64_t half_size(std::uint64_t half) const {
        return (options_.photons + 1 - half) / 2;
    }
    [[nodiscard]] std::uint32_t element_hash(std::uint64_t half) const {
        return sobol_element_hash(
            options_.seed, Pass::photons, (std::uint64_t{stream_} << 1) | half);
    }
    [[nodiscard]] StartDistribution::Cursor cursor(std::uint64_t half, std::uint64_t begin) const {
        return {start_, double(begin / 2) / double(half_size(half))};
    }

    // A pair of uniform numbers in [0, 1) of photon `index` of a half.
    [[nodiscard]] static std::array<double, 2> draw(std::uint32_t hash,
                                                    std::uint64_t index,
                                                    std::uint32_t pair) {
        constexpr double kTwoToMinus32 = 1.0 / 4294967296.0;
        const auto numbers = sobol_pair(hash, static_cast<std::uint32_t>(index), pair);
        return {numbers[0] * kTwoToMinus32, numbers[1] * kTwoToMinus32};
    }

    // Where the photon falls on the surface first. Without power where no lamp reaches it.
    [[nodiscard]] PhotonWave::Start emit(std::uint64_t photon,
                                         std::uint32_t hash,
                                         StartDistribution::Cursor& cursor) const {
        const std::uint64_t index = photon / 2;
        const auto [jitter, lamp_choice] = draw(hash, index, 1);
        const double position = (double(index) + jitter) / double(half_size(photon % 2));
        const auto [texel, probability] = cursor.at(position);
        PhotonWave::Start start;
        start.texel = texel;
        const Rgb irradiance = lamps_.turns_with_scanner
                                   ? turning_lamp(start, lamp_choice, draw(hash, index, 2))
                                   : fixed_lamp(start, lamp_choice);
        const double per_photon =
            atlas_.texels[texel].area / (probability * double(options_.photons));
        start.power = (irradiance * per_photon).cast<float>();
        return start;
    }

    // Irradiance by the chosen lamp over its probability, for lamps that stand still.
    [[nodiscard]] Rgb fixed_lamp(PhotonWave::Start& start, double choice) const {
        double total = 0;
        for (const auto* direct : lamps_.direct) {
            total += double((*direct)[start.texel].irradiance.mean());
        }
        double wanted = choice * total;
        for (const auto* direct : lamps_.direct) {
            const DirectLight& light = (*direct)[start.texel];
            const double share = double(light.irradiance.mean());
            if (share > 0 && wanted < share) {
                start.w_i = light.w_i;
                return light.irradiance.cast<double>() * (total / share);
            }
            wanted -= share;
        }
        return Rgb::Zero();
    }

    // The same for lamps that turn: the lamp's azimuth is drawn too, and its shadow is tested here.
    [[nodiscard]] Rgb turning_lamp(PhotonWave::Start& start,
                                   double choice,
                                   const std::array<double, 2>& u) const {
        const Texel& texel = atlas_.texels[start.texel];
        const AzimuthSample offset = sample_azimuth(u[0], u[1]);
        start.azimuth = texel.azimuth + offset.offset;
        const auto num_lights = double(lamps_.lights.size());
        const auto lamp = std::min(std::size_t(choice * num_lights), lamps_.lights.size() - 1);
        const LightSample light =
            sample_light(*lamps_.lights[lamp], texel.point.position, start.azimuth);
        if (!is_lit(surface_, texel.point, light)) return Rgb::Zero();
        start.w_i = light.w_i.cast<float>();
        return light.irradiance * texel.point.normal.dot(light.w_i) * num_lights / offset.density;
    }

    const Surface& surface_;
    const TexelAtlas& atlas_;
    const LampSet& lamps_;
    const PhotonOptions& options_;
    std::uint32_t stream_;
    StartDistribution start_;
    PhotonScene scene_;
};

std::size_t path_end(const PhotonPaths& paths, std::size_t path) {
    return path + 1 < paths.paths.size() ? paths.paths[path + 1].first_bounce
                                         : paths.bounces.size();
}

// Joins the blocks in their order and sorts the arrivals by texel: a counting sort whose counts are
// taken for a few runs of blocks apart, so that threads share the work and every arrival has its
// place beforehand.
class BlockJoiner {
  public:
    BlockJoiner(std::vector<PhotonBlock>& blocks, std::size_t num_texels)
        : blocks_(blocks),
          num_texels_(num_texels),
          blocks_per_run_(std::max<std::size_t>(1, (blocks.size() + kSortRuns - 1) / kSortRuns)),
          next_((blocks.size() + blocks_per_run_ - 1) / blocks_per_run_) {}

    [[nodiscard]] PhotonPaths join() {
        place_blocks();
        over_runs([this](std::size_t run, PhotonBlock& block) {
            next_[run].resize(num_texels_);
            for (const PhotonBounce& bounce : block.bounces) {
                next_[run][bounce.to] += bounce.window > 0;
            }
        });
        place_arrivals();
        allocate();
        over_runs([this](std::size_t run, PhotonBlock& block) {
            copy(block, std::size_t(&block - blocks_.data()), next_[run]);
        });
        return std::move(result_);
    }

  private:
    void over_runs(const auto& work) {
        parallel_blocks(blocks_.size(), blocks_per_run_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) work(begin / blocks_per_run_, blocks_[i]);
        });
    }

    void place_blocks() {
        for (const PhotonBlock& block : blocks_) {
            first_path_.push_back(num_paths_);
            first_bounce_.push_back(num_bounces_);
            num_paths_ += block.paths.size();
            num_bounces_ += block.bounces.size();
            result_.rays += block.rays;
            has_positions_ = has_positions_ || !block.positions.empty();
        }
        PATINA_CHECK_LT(num_bounces_, std::size_t{kNoArrival});
    }

    // Turns the runs' counts into their first arrivals.
    void place_arrivals() {
        result_.arrivals_begin.resize(num_texels_ + 1);
        std::uint32_t arrival = 0;
        for (std::size_t texel = 0; texel < num_texels_; ++texel) {
            result_.arrivals_begin[texel] = arrival;
            for (std::vector<std::uint32_t>& next : next_) {
                arrival += std::exchange(next[texel], arrival);
            }
        }
        result_.arrivals_begin[num_texels_] = arrival;
    }

    // Clearing fresh memory costs as much as filling it: the arrays are shared among the threads.
    void allocate() {
        const std::size_t num_arrivals = result_.arrivals_begin.back();
        const std::array<std::function<void()>, 6> tasks = {
            [&] { result_.bounces.resize(num_bounces_); },
            [&] { result_.arrival_direction.resize(num_arrivals); },
            [&] { result_.paths.resize(num_paths_); },
            [&] { result_.arrival_of_bounce.resize(num_bounces_); },
            [&] { result_.arrival_half.resize(num_arrivals); },
            [&] { result_.arrival_position.resize(has_positions_ ? num_arrivals : 0); }};
        parallel_for(
            tasks.size(), [&](std::size_t i) { tasks[i](); }, 1);
    }

    void copy(PhotonBlock& block, std::size_t index, std::vector<std::uint32_t>& next) {
        const std::size_t first = first_bounce_[index];
        for (std::size_t i = 0; i < block.paths.size(); ++i) {
            const std::size_t begin = block.paths[i].first_bounce;
            const std::size_t end =
                i + 1 < block.paths.size() ? block.paths[i + 1].first_bounce : block.bounces.size();
            PhotonPaths::Path& path = result_.paths[first_path_[index] + i];
            path = block.paths[i];
            path.first_bounce += std::uint32_t(first);
            for (std::size_t k = begin; k < end; ++k) {
                const PhotonBounce& bounce = result_.bounces[first + k] = block.bounces[k];
                if (bounce.window <= 0) {
                    result_.arrival_of_bounce[first + k] = kNoArrival;
                    continue;
                }
                const std::uint32_t arrival = next[bounce.to]++;
                result_.arrival_of_bounce[first + k] = arrival;
                result_.arrival_half[arrival] = path.half;
                result_.arrival_direction[arrival] = block.directions[k];
                if (has_positions_) result_.arrival_position[arrival] = block.positions[k];
            }
        }
        block = PhotonBlock();
    }

    std::vector<PhotonBlock>& blocks_;
    std::size_t num_texels_;
    std::size_t blocks_per_run_;
    std::vector<std::vector<std::uint32_t>> next_;        // per run, per texel
    std::vector<std::size_t> first_path_, first_bounce_;  // per block
    std::size_t num_paths_ = 0;
    std::size_t num_bounces_ = 0;
    bool has_positions_ = false;
    PhotonPaths result_;
};

}  // namespace

PhotonPaths trace_photons(const Surface& surface,
                          const TexelAtlas& atlas,
                          const LampSet& lamps,
                          std::span<const Reflectance> guide,
                          const PhotonOptions& options,
                          std::uint32_t stream,
                          Progress& progress) {
    PATINA_CHECK_EQ(guide.size(), atlas.texels.size());
    std::vector<PhotonBlock> blocks;
    const PhotonTracer tracer(surface, atlas, lamps, guide, options, stream);
    if (tracer.has_light()) {
        blocks.resize((options.photons + kPhotonsPerBlock - 1) / kPhotonsPerBlock);
        parallel_blocks(options.photons, kPhotonsPerBlock, [&](std::size_t begin, std::size_t end) {
            blocks[begin / kPhotonsPerBlock] = tracer.trace(begin, end);
            progress.advance(end - begin);
        });
    }
    return BlockJoiner(blocks, atlas.texels.size()).join();
}

PhotonPower photon_power(const PhotonPaths& paths, std::span<const Reflectance> maps) {
    PhotonPower result;
    result.arrivals.resize(paths.arrival_direction.size());
    const std::size_t num_blocks = (paths.paths.size() + kParallelBlock - 1) / kParallelBlock;
    std::vector<std::vector<double>> block_sums(num_blocks);
    parallel_blocks(paths.paths.size(), kParallelBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<double>& sums = block_sums[begin / kParallelBlock];
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t first = paths.paths[i].first_bounce;
            const std::size_t last = path_end(paths, i);
            if (sums.size() < last - first) sums.resize(last - first, 0.0);
            Rgb carried = paths.paths[i].power.cast<double>();
            for (std::size_t k = first; k < last; ++k) {
                const PhotonBounce& bounce = paths.bounces[k];
                const Reflectance& map = maps[bounce.from];
                const double lobe =
                    map.specular > 0
                        ? map.specular * double(bounce.lobe_cosines) *
                              lobe_gaussian(double(bounce.theta_r_squared), map.roughness)
                        : 0.0;
                carried *= (map.diffuse + lobe) * (double(bounce.geometry) / kPi);
                sums[k - first] += carried.sum();
                const std::uint32_t arrival = paths.arrival_of_bounce[k];
                if (arrival == kNoArrival) continue;
                result.arrivals[arrival] = carried.cast<float>() * bounce.window;
            }
        }
    });
    for (const std::vector<double>& sums : block_sums) {
        if (result.by_bounce.size() < sums.size()) result.by_bounce.resize(sums.size(), 0.0);
        for (std::size_t k = 0; k < sums.size(); ++k) result.by_bounce[k] += sums[k];
    }
    return result;
}

}  // namespace patina
