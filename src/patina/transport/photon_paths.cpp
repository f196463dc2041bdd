#include "patina/transport/photon_paths.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/base/random.h"

#include <algorithm>
#include <numeric>

namespace patina {
namespace {

// Photons handed to a thread at once; fixes the order in which paths are stored.
constexpr std::size_t kPhotonsPerBlock = 8192;
// Survival is kept within these bounds, so that dark guides still let photons on and weights stay
// small.
constexpr double kMinSurvival = 0.1;
constexpr double kMaxSurvival = 0.95;
// Arrivals nearly along the surface weigh at most this much: smooth over geometric cosine.
constexpr double kMaxShadingRatio = 4.0;
// Guides never give one of the two lobes up altogether.
constexpr double kMinGuideDiffuse = 0.02;
// Turning lamps: most photons take a lamp near the first texel's column, some a far one.
constexpr double kNearAzimuth = radians(25.0);
constexpr double kFarAzimuth = radians(110.0);
constexpr double kNearShare = 0.8;
// Turning lamps: a texel that its own column's lamp leaves dark may be lit from another column.
constexpr double kUnlitImportance = 0.2;

double mean(const Rgb& value) { return value.mean(); }

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

// Epanechnikov kernel of unit integral [1/rad].
double azimuth_kernel(double difference, double half_width) {
    const double t = std::remainder(difference, 2 * kPi) / half_width;
    return std::abs(t) < 1 ? 0.75 / half_width * (1 - t * t) : 0.0;
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
        for (std::size_t i = 0; i < importance.size(); ++i) {
            double irradiance = lamps.turns_with_scanner ? kUnlitImportance * mean_irradiance : 0.0;
            for (const auto* direct : lamps.direct)
                irradiance += double((*direct)[i].irradiance.mean());
            const double albedo =
                mean(guide[i].diffuse) + guide[i].specular * max_lobe_albedo(guide[i].roughness);
            importance[i] = irradiance * atlas.texels[i].area * std::max(albedo, kMinGuideDiffuse);
        }
        cumulative_.resize(importance.size());
        std::partial_sum(importance.begin(), importance.end(), cumulative_.begin());
    }

    [[nodiscard]] double total() const { return cumulative_.empty() ? 0 : cumulative_.back(); }
    // The texel at a position in [0, 1), and its probability.
    [[nodiscard]] std::pair<TexelId, double> at(double position) const {
        const double wanted = position * total();
        const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), wanted);
        const auto index =
            std::min(std::size_t(found - cumulative_.begin()), cumulative_.size() - 1);
        const double importance = cumulative_[index] - (index > 0 ? cumulative_[index - 1] : 0.0);
        return {TexelId(index), importance / total()};
    }

  private:
    std::vector<double> cumulative_;
};

// What one thread collects for one block of photons.
struct PhotonBlock {
    std::vector<PhotonPaths::Path> paths;
    std::vector<PhotonBounce> bounces;
    std::vector<Vec3f> directions;  // per bounce, from the arrival back along the photon's way
    std::vector<Vec3f> positions;   // per bounce, of the arrival; empty unless wanted
    std::uint64_t rays = 0;
};

// A photon at a surface, about to be reflected.
struct PhotonState {
    SurfacePoint point;
    TexelId texel = kNoTexel;
    Vec3 w_i = Vec3::UnitZ();
    double survival = 1;  // probability with which it was let live here
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
          guide_(guide),
          options_(options),
          stream_(stream),
          start_(atlas, lamps, guide) {}

    [[nodiscard]] bool has_light() const { return start_.total() > 0; }

    // Photons alternate between the two halves; each half is a stratified set of its own.
    void trace(std::uint64_t photon, PhotonBlock& block) const {
        const auto half = static_cast<std::uint8_t>(photon % 2);
        const std::uint64_t index = photon / 2;
        const std::uint64_t half_size = (options_.photons + 1 - half) / 2;
        SobolSampler sampler(options_.seed,
                             Pass::photons,
                             (std::uint64_t{stream_} << 1) | half,
                             static_cast<std::uint32_t>(index));
        const auto [jitter, lamp_choice] = sampler.next_pair();
        const double position = (double(index) + jitter) / double(half_size);
        const auto [texel, probability] = start_.at(position);
        PhotonState state;
        state.texel = texel;
        state.point = atlas_.texels[texel].point;
        const double per_photon =
            atlas_.texels[texel].area / (probability * double(options_.photons));
        double azimuth = 0;
        const Rgb irradiance = lamps_.turns_with_scanner
                                   ? turning_lamp(state, lamp_choice, sampler, azimuth)
                                   : fixed_lamp(state, lamp_choice);
        if ((irradiance == 0).all()) return;
        PhotonPaths::Path path;
        path.power = (irradiance * per_photon).cast<float>();
        path.first_bounce = static_cast<std::uint32_t>(block.bounces.size());
        path.half = half;
        follow(state, azimuth, sampler, block);
        if (block.bounces.size() > path.first_bounce) block.paths.push_back(path);
    }

  private:
    // Irradiance by the chosen lamp over its probability, for lamps that stand still.
    [[nodiscard]] Rgb fixed_lamp(PhotonState& state, double choice) const {
        double total = 0;
        for (const auto* direct : lamps_.direct) {
            total += double((*direct)[state.texel].irradiance.mean());
        }
        double wanted = choice * total;
        for (const auto* direct : lamps_.direct) {
            const DirectLight& light = (*direct)[state.texel];
            const double share = double(light.irradiance.mean());
            if (share > 0 && wanted < share) {
                state.w_i = light.w_i.cast<double>();
                return light.irradiance.cast<double>() * (total / share);
            }
            wanted -= share;
        }
        return Rgb::Zero();
    }

    // The same for lamps that turn: the lamp's azimuth is drawn too, and its shadow is tested here.
    [[nodiscard]] Rgb turning_lamp(PhotonState& state,
                                   double choice,
                                   SobolSampler& sampler,
                                   double& azimuth) const {
        const auto [branch, u] = sampler.next_pair();
        const AzimuthSample offset = sample_azimuth(branch, u);
        azimuth = atlas_.texels[state.texel].azimuth + offset.offset;
        const auto num_lights = double(lamps_.lights.size());
        const auto lamp = std::min(std::size_t(choice * num_lights), lamps_.lights.size() - 1);
        const LightSample light = sample_light(*lamps_.lights[lamp], state.point.position, azimuth);
        if (!is_lit(surface_, state.point, light)) return Rgb::Zero();
        state.w_i = light.w_i;
        return light.irradiance * state.point.normal.dot(light.w_i) * num_lights / offset.density;
    }

    void follow(PhotonState state,
                double azimuth,
                SobolSampler& sampler,
                PhotonBlock& block) const {
        for (int bounce = 0; bounce < options_.max_bounces; ++bounce) {
            const auto [choice, roulette] = sampler.next_pair();
            if (bounce > 0) {
                state.survival = survival(state);
                if (roulette >= state.survival) return;
            }
            const Reflectance& guide = guide_[state.texel];
            const LobeSample sample =
                sample_lobe(guide, state.point.normal, state.w_i, choice, sampler.next_pair());
            const double departing = state.point.geometric_normal.dot(sample.w_o);
            if (sample.pdf <= 0 || departing <= 0 || state.point.normal.dot(sample.w_o) <= 0)
                return;
            ++block.rays;
            const auto hit = surface_.tracer->intersect(
                surface_.tracer->offset(state.point, sample.w_o), sample.w_o);
            if (!hit) return;
            const SurfacePoint arrival =
                surface_point(*surface_.mesh, hit->triangle, hit->barycentric);
            const Vec3 w_back = -sample.w_o;
            const double arriving = arrival.geometric_normal.dot(w_back);
            const double shading = arrival.normal.dot(w_back);
            if (arriving <= 0 || shading <= 0) return;
            const TexelId texel = atlas_.lookup(*surface_.mesh, hit->triangle, hit->barycentric);
            if (texel == kNoTexel) return;
            PhotonBounce& record = block.bounces.emplace_back();
            record.from = state.texel;
            record.to = texel;
            record.theta_r_squared =
                float(mirror_angle_squared(state.point.normal, state.w_i, sample.w_o));
            record.lobe_cosines = float(lobe_cosines(state.point.normal.dot(state.w_i),
                                                     state.point.normal.dot(sample.w_o)));
            record.geometry = float(departing / (sample.pdf * state.survival) *
                                    std::min(shading / arriving, kMaxShadingRatio));
            if (lamps_.turns_with_scanner) {
                record.window = float(azimuth_kernel(azimuth - atlas_.texels[texel].azimuth,
                                                     options_.azimuth_window));
            }
            block.directions.push_back(w_back.cast<float>());
            if (options_.keep_positions) {
                block.positions.push_back(arrival.position.cast<float>());
            }
            state = {arrival, texel, w_back, 1};
        }
    }

    [[nodiscard]] double survival(const PhotonState& state) const {
        const Reflectance& guide = guide_[state.texel];
        const double albedo =
            guide.diffuse.maxCoeff() +
            guide.specular * lobe_albedo(state.point.normal.dot(state.w_i), guide.roughness);
        return std::clamp(albedo, kMinSurvival, kMaxSurvival);
    }

    const Surface& surface_;
    const TexelAtlas& atlas_;
    const LampSet& lamps_;
    std::span<const Reflectance> guide_;
    const PhotonOptions& options_;
    std::uint32_t stream_;
    StartDistribution start_;
};

// Where and from where the photon arrived, per bounce. positions: empty unless wanted.
struct Arrivals {
    std::vector<Vec3f> directions;
    std::vector<Vec3f> positions;
};

// Joins the blocks in order. Returns the arrivals of all bounces.
Arrivals join_blocks(std::vector<PhotonBlock>& blocks, PhotonPaths& result) {
    std::size_t num_paths = 0;
    std::size_t num_bounces = 0;
    for (const PhotonBlock& block : blocks) {
        num_paths += block.paths.size();
        num_bounces += block.bounces.size();
    }
    PATINA_CHECK_LT(num_bounces, std::size_t{kNoArrival});
    result.paths.reserve(num_paths);
    result.bounces.reserve(num_bounces);
    Arrivals arrivals;
    arrivals.directions.reserve(num_bounces);
    for (PhotonBlock& block : blocks) {
        const auto offset = static_cast<std::uint32_t>(result.bounces.size());
        for (PhotonPaths::Path path : block.paths) {
            path.first_bounce += offset;
            result.paths.push_back(path);
        }
        result.bounces.insert(result.bounces.end(), block.bounces.begin(), block.bounces.end());
        arrivals.directions.insert(
            arrivals.directions.end(), block.directions.begin(), block.directions.end());
        arrivals.positions.insert(
            arrivals.positions.end(), block.positions.begin(), block.positions.end());
        result.rays += block.rays;
        block = PhotonBlock();
    }
    return arrivals;
}

std::size_t path_end(const PhotonPaths& paths, std::size_t path) {
    return path + 1 < paths.paths.size() ? paths.paths[path + 1].first_bounce
                                         : paths.bounces.size();
}

// Counting sort of the bounces by texel of arrival; bounces that count for no column are left out.
void sort_arrivals(std::size_t num_texels, const Arrivals& arrivals, PhotonPaths& result) {
    result.arrivals_begin.assign(num_texels + 1, 0);
    for (const PhotonBounce& bounce : result.bounces) {
        if (bounce.window > 0) ++result.arrivals_begin[bounce.to + 1];
    }
    std::partial_sum(
        result.arrivals_begin.begin(), result.arrivals_begin.end(), result.arrivals_begin.begin());
    result.arrival_of_bounce.assign(result.bounces.size(), kNoArrival);
    result.arrival_half.resize(result.arrivals_begin.back());
    result.arrival_direction.resize(result.arrivals_begin.back());
    if (!arrivals.positions.empty()) result.arrival_position.resize(result.arrivals_begin.back());
    std::vector<std::uint32_t> next(result.arrivals_begin.begin(), result.arrivals_begin.end() - 1);
    for (std::size_t path = 0; path < result.paths.size(); ++path) {
        for (std::size_t i = result.paths[path].first_bounce; i < path_end(result, path); ++i) {
            if (result.bounces[i].window <= 0) continue;
            const std::uint32_t arrival = next[result.bounces[i].to]++;
            result.arrival_of_bounce[i] = arrival;
            result.arrival_half[arrival] = result.paths[path].half;
            result.arrival_direction[arrival] = arrivals.directions[i];
            if (!arrivals.positions.empty()) {
                result.arrival_position[arrival] = arrivals.positions[i];
            }
        }
    }
}

}  // namespace

PhotonPaths trace_photons(const Surface& surface,
                          const TexelAtlas& atlas,
                          const LampSet& lamps,
                          std::span<const Reflectance> guide,
                          const PhotonOptions& options,
                          std::uint32_t stream,
                          Progress& progress) {
    PATINA_CHECK_EQ(guide.size(), atlas.texels.size());
    PhotonPaths result;
    Arrivals arrivals;
    const PhotonTracer tracer(surface, atlas, lamps, guide, options, stream);
    if (tracer.has_light()) {
        const std::size_t num_blocks = (options.photons + kPhotonsPerBlock - 1) / kPhotonsPerBlock;
        std::vector<PhotonBlock> blocks(num_blocks);
        parallel_for(
            num_blocks,
            [&](std::size_t block) {
                const std::uint64_t begin = block * kPhotonsPerBlock;
                const std::uint64_t end =
                    std::min<std::uint64_t>(options.photons, begin + kPhotonsPerBlock);
                for (std::uint64_t photon = begin; photon < end; ++photon) {
                    tracer.trace(photon, blocks[block]);
                }
                progress.advance(end - begin);
            },
            1);
        arrivals = join_blocks(blocks, result);
    }
    sort_arrivals(atlas.texels.size(), arrivals, result);
    return result;
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
