#include "patina/transport/photon_paths.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/base/pool.h"
#include "patina/transport/photon_columns.h"
#include "patina/transport/photon_join.h"
#include "patina/transport/photon_wave.h"

#include <algorithm>
#include <memory>
#include <optional>

namespace patina {
namespace {

// Photons handed to a thread at once.
constexpr std::size_t kPhotonsPerTask = 8 * kWaveSize;

// Sums whose ratio is the effective number of photons.
struct WeightSums {
    double first = 0;
    double second = 0;
    WeightSums& operator+=(const WeightSums& other) {
        first += other.first;
        second += other.second;
        return *this;
    }
};

std::size_t path_end(const PhotonPaths& paths, std::size_t path) {
    return path + 1 < paths.paths.size() ? paths.paths[path + 1].first_bounce
                                         : paths.bounces.size();
}

}  // namespace

PhotonPaths trace_photons(const PhotonScene& scene,
                          const LampSet& lamps,
                          const PhotonOptions& options,
                          std::uint32_t stream,
                          Progress& progress) {
    std::vector<PhotonBlock> blocks;  // per wave
    std::optional<PhotonColumns> columns;
    if (options.exact_columns) {
        PATINA_CHECK(lamps.turns_with_scanner && options.max_bounces == 1);
        PATINA_CHECK_EQ(lamps.lights.size(), 1u);
        columns.emplace(scene, *lamps.lights.front());
    }
    const PhotonNumbers numbers(options.seed, stream);
    const PhotonStart start(scene, lamps, options, numbers);
    Pool<PhotonWave> waves([&] {
        return std::make_unique<PhotonWave>(scene,
                                            start,
                                            numbers,
                                            options,
                                            lamps.turns_with_scanner,
                                            columns ? &*columns : nullptr);
    });
    if (start.has_light()) {
        blocks.resize((options.photons + kWaveSize - 1) / kWaveSize);
        parallel_blocks(options.photons, kPhotonsPerTask, [&](std::size_t begin, std::size_t end) {
            PhotonStart::Cursor cursor(start, begin);
            waves.lend([&](PhotonWave& wave) {
                for (std::size_t first = begin; first < end; first += kWaveSize) {
                    blocks[first / kWaveSize] =
                        wave.follow(first, std::min(kWaveSize, end - first), cursor);
                }
            });
            progress.advance(end - begin);
        });
    }
    return join_blocks(blocks, scene.num_texels());
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

double effective_number(std::span<const Rgbf> arrivals) {
    const auto sums = ordered_reduce(arrivals.size(), WeightSums(), [&](std::size_t i) {
        const double weight = double(arrivals[i].mean());
        return WeightSums{weight, weight * weight};
    });
    return sums.second > 0 ? square(sums.first) / sums.second : 0.0;
}

}  // namespace patina
