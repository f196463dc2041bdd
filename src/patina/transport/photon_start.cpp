#include "patina/transport/photon_start.h"

#include "patina/base/parallel.h"
#include "patina/math/lanes.h"
#include "patina/transport/photon_columns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

namespace patina {
namespace {

// Turning lamps: most photons take a lamp near the first texel's column, some a far one.
constexpr auto kNearAzimuth = float(radians(25.0));
constexpr auto kFarAzimuth = float(radians(110.0));
constexpr float kNearShare = 0.8f;
// Turning lamps: a texel that its own column's lamp leaves dark may be lit from another column.
constexpr double kUnlitImportance = 0.2;

constexpr float kInverseTurn = float(1 / (2 * kPi));

// Calls copy(begin, records) for the first `count` lanes, eight at a time; records: what record(i)
// points to for each of them. Lanes past count get what the last one has.
void for_records(std::size_t count, const auto& record, const auto& copy) {
    for (std::size_t begin = 0; begin < count; begin += kLanes) {
        std::array<const void*, kLanes> records;
        for (std::size_t k = 0; k < kLanes; ++k) {
            records[k] = record(std::min(begin + k, count - 1));
        }
        copy(begin, records);
    }
}

// Numbers first, first + 1 and first + 2 of the transposed records.
template <std::size_t kFirst>
void store_vector(const std::array<Lanes, kLanes>& fields, std::size_t i, Lane3& lane) {
    store_lanes(fields[kFirst], &lane.x[i]);
    store_lanes(fields[kFirst + 1], &lane.y[i]);
    store_lanes(fields[kFirst + 2], &lane.z[i]);
}

// Where the numbers lie that are read in eights.
constexpr bool lies_at(std::size_t offset, std::size_t number) {
    return offset == number * sizeof(float);
}
static_assert(lies_at(offsetof(PhotonTexel, origin), 0));
static_assert(lies_at(offsetof(PhotonTexel, geometric_normal), 3));
static_assert(lies_at(offsetof(PhotonTexel, normal), 6));
static_assert(lies_at(offsetof(PhotonTexel, diffuse), kLanes + 4));
static_assert(lies_at(offsetof(PhotonTexel, lobe), kLanes + 5));
static_assert(lies_at(offsetof(PhotonTexel, concentration), kLanes + 6));
static_assert(lies_at(offsetof(DirectLight, w_i), 3) && sizeof(DirectLight) == sizeof(Lanes));

// See LaneLightSample::strength.
const Rgb& emitted(const Light& light) {
    return light.type == LightType::point ? light.intensity : light.irradiance;
}

}  // namespace

PhotonStart::PhotonStart(const PhotonScene& scene,
                         const LampSet& lamps,
                         const PhotonOptions& options,
                         const PhotonNumbers& numbers)
    : scene_(scene), lamps_(lamps), options_(options), numbers_(numbers) {
    accumulate(importance());
    if (lamps.turns_with_scanner) {
        for (const Light* light : lamps.lights) turning_.push_back(lane_light(*light));
    } else if (lamps.direct.size() > 1) {
        share_lamps();
    }
}

std::vector<double> PhotonStart::importance() const {
    const std::size_t num_texels = scene_.num_texels();
    double unlit = 0;
    if (options_.exact_columns) {
        // A texel is lit from every azimuth at which a photon of it may arrive.
        unlit = emitted(*lamps_.lights.front()).maxCoeff() > 0 ? 1.0 : 0.0;
    } else if (lamps_.turns_with_scanner && num_texels > 0) {
        for (const auto* direct : lamps_.direct) {
            unlit += ordered_reduce(num_texels, 0.0, [&](std::size_t i) {
                return double((*direct)[i].irradiance.mean());
            });
        }
        unlit *= kUnlitImportance / double(num_texels);
    }
    std::vector<double> result(num_texels);
    parallel_for(num_texels, [&](std::size_t i) {
        double irradiance = unlit;
        if (!options_.exact_columns) {
            for (const auto* direct : lamps_.direct) {
                irradiance += double((*direct)[i].irradiance.mean());
            }
        }
        const PhotonTexel& texel = scene_.texel(TexelId(i));
        result[i] = irradiance * double(texel.area) *
                    double(std::max(texel.mean_albedo, options_.min_guide_albedo));
    });
    return result;
}

void PhotonStart::accumulate(std::vector<double> importance) {
    total_ = ordered_reduce(importance.size(), 0.0, [&](std::size_t i) { return importance[i]; });
    if (!has_light()) return;
    std::size_t last = importance.size() - 1;
    while (importance[last] <= 0) --last;
    area_per_photon_.resize(importance.size());
    parallel_for(importance.size(), [&](std::size_t i) {
        if (importance[i] <= 0) return;
        area_per_photon_[i] = float(double(scene_.texel(TexelId(i)).area) * total_ /
                                    (importance[i] * double(options_.photons)));
    });
    std::partial_sum(importance.begin(), importance.end(), importance.begin());
    // A walk that stops where the sum exceeds what is wanted ends at a lit texel, whatever rounds.
    std::fill(importance.begin() + std::ptrdiff_t(last),
              importance.end(),
              std::numeric_limits<double>::infinity());
    cumulative_ = std::move(importance);
}

void PhotonStart::share_lamps() {
    const std::size_t num_lamps = lamps_.direct.size();
    lamp_shares_.resize(num_lamps * scene_.num_texels());
    parallel_for(scene_.num_texels(), [&](std::size_t i) {
        double total = 0;
        for (const auto* direct : lamps_.direct) total += double((*direct)[i].irradiance.mean());
        double sum = 0;
        for (std::size_t lamp = 0; lamp < num_lamps && total > 0; ++lamp) {
            sum += double((*lamps_.direct[lamp])[i].irradiance.mean());
            lamp_shares_[i * num_lamps + lamp] = float(sum / total);
        }
    });
}

double PhotonStart::light_per_photon(std::uint64_t half) const {
    return total_ / double((options_.photons + 1 - half) / 2);
}

PhotonStart::Cursor::Cursor(const PhotonStart& start, std::uint64_t photon) {
    for (std::size_t half = 0; half < 2; ++half) {
        const double wanted = double(photon / 2) * start.light_per_photon(half);
        const std::vector<double>& cumulative = start.cumulative_;
        texel_[half] = std::size_t(std::upper_bound(cumulative.begin(), cumulative.end(), wanted) -
                                   cumulative.begin());
    }
}

void PhotonStart::fill(std::uint64_t first_photon,
                       std::size_t count,
                       Cursor& cursor,
                       PhotonLanes& lanes) const {
    lanes.size = count;
    for (std::size_t i = 0; i < count; ++i) lanes.photon[i] = std::uint32_t(i);
    const auto first_sample = std::uint32_t(first_photon / 2);
    numbers_.draw(1, first_sample, lanes.photon, count, lanes.u, lanes.choice);
    choose_texels(first_photon, cursor, lanes);
    for_records(
        count,
        [&](std::size_t i) { return &scene_.texel(lanes.texel[i]); },
        [&](std::size_t i, const auto& texels) {
            const auto near = load_transposed(texels, 0);
            const auto far = load_transposed(texels, sizeof(Lanes));
            store_vector<0>(near, i, lanes.origin);
            store_vector<3>(near, i, lanes.geometric_normal);
            store_lanes(near[6], &lanes.normal.x[i]);
            store_lanes(near[7], &lanes.normal.y[i]);
            store_lanes(far[0], &lanes.normal.z[i]);
            store_lanes(far[4], &lanes.diffuse[i]);
            store_lanes(far[5], &lanes.lobe[i]);
            store_lanes(far[6], &lanes.concentration[i]);
        });
    std::fill_n(lanes.survival.begin(), count, 1.0f);
    if (lamps_.turns_with_scanner) {
        numbers_.draw(2, first_sample, lanes.photon, count, lanes.u, lanes.v);
        if (options_.exact_columns) {
            choose_teeth(lanes);
        } else {
            sample_azimuths(lanes);
        }
        turning_lamps(lanes);
    } else {
        fixed_lamps(lanes);
    }
}

void PhotonStart::choose_texels(std::uint64_t first_photon,
                                Cursor& cursor,
                                PhotonLanes& lanes) const {
    for (std::size_t half = 0; half < 2; ++half) {
        const double step = light_per_photon(half);
        std::size_t texel = cursor.texel_[half];
        for (std::size_t i = half; i < lanes.size; i += 2) {
            const double wanted = (double((first_photon + i) / 2) + double(lanes.u[i])) * step;
            while (cumulative_[texel] <= wanted) ++texel;
            lanes.texel[i] = TexelId(texel);
        }
        cursor.texel_[half] = texel;
    }
}

// What remains of the number that chooses the lamp is uniform again, and chooses the lobe.
void PhotonStart::fixed_lamps(PhotonLanes& lanes) const {
    const std::size_t num_lamps = lamps_.direct.size();
    std::fill_n(lanes.active.begin(), lanes.size, -1);
    std::fill_n(lanes.lamp.begin(), lanes.size, 0);
    for (std::size_t i = 0; i < lanes.size; ++i) {
        lanes.weight[i] = area_per_photon_[lanes.texel[i]];
    }
    for (std::size_t i = 0; i < lanes.size && num_lamps > 1; ++i) {
        const float* shares = &lamp_shares_[lanes.texel[i] * num_lamps];
        std::size_t lamp = 0;
        while (lanes.choice[i] >= shares[lamp]) ++lamp;
        const float before = lamp > 0 ? shares[lamp - 1] : 0.0f;
        const float probability = shares[lamp] - before;
        lanes.choice[i] = (lanes.choice[i] - before) / probability;
        lanes.weight[i] /= probability;
        lanes.lamp[i] = std::int32_t(lamp);
    }
    for_records(
        lanes.size,
        [&](std::size_t i) {
            return &(*lamps_.direct[std::size_t(lanes.lamp[i])])[lanes.texel[i]];
        },
        [&](std::size_t i, const auto& direct) {
            store_vector<3>(load_transposed(direct, 0), i, lanes.w_i);
        });
}

Rgbf PhotonStart::power(const PhotonLanes& lanes, std::size_t lane) const {
    const auto lamp = std::size_t(lanes.lamp[lane]);
    if (!lamps_.turns_with_scanner) {
        return (*lamps_.direct[lamp])[lanes.texel[lane]].irradiance * lanes.weight[lane];
    }
    return emitted(*lamps_.lights[lamp]).cast<float>() * lanes.weight[lane];
}

// The azimuth's offset from the texel's own is a mixture of two uniform densities.
void PhotonStart::sample_azimuths(PhotonLanes& lanes) const {
    for (std::size_t i = 0; i < lanes.size; ++i) {
        lanes.azimuth[i] = scene_.texel(lanes.texel[i]).azimuth;
        lanes.weight[i] = area_per_photon_[lanes.texel[i]];
    }
    const auto num_lamps = std::int32_t(turning_.size());
    for (std::size_t i = 0; i < lanes.size; ++i) {
        const float half_width = lanes.u[i] < kNearShare ? kNearAzimuth : kFarAzimuth;
        const float offset = (2 * lanes.v[i] - 1) * half_width;
        const float density =
            (1 - kNearShare) / (2 * kFarAzimuth) +
            (std::abs(offset) <= kNearAzimuth ? kNearShare / (2 * kNearAzimuth) : 0.0f);
        lanes.azimuth[i] += offset;
        lanes.weight[i] *= float(num_lamps) / density;
        const float scaled = lanes.choice[i] * float(num_lamps);
        lanes.lamp[i] = std::min(std::int32_t(scaled), num_lamps - 1);
        lanes.choice[i] = scaled - float(lanes.lamp[i]);
    }
}

void PhotonStart::choose_teeth(PhotonLanes& lanes) const {
    std::fill_n(lanes.lamp.begin(), lanes.size, 0);
    for (std::size_t i = 0; i < lanes.size; ++i) {
        lanes.azimuth[i] =
            scene_.texel(lanes.texel[i]).azimuth + PhotonColumns::offset(lanes.u[i], lanes.v[i]);
        lanes.weight[i] = area_per_photon_[lanes.texel[i]];
    }
}

void PhotonStart::turn_lamp(PhotonLanes& lanes) const {
    for (std::size_t i = 0; i < lanes.size; ++i) {
        lanes.weight[i] = area_per_photon_[lanes.texel[i]];
    }
    turning_lamps(lanes);
}

// All photons for each lamp, as lanes cannot read a lamp of their own: few lamps shine together.
void PhotonStart::turning_lamps(PhotonLanes& lanes) const {
    const float offset_length = scene_.offset_length();
    for (std::size_t lamp = 0; lamp < turning_.size(); ++lamp) {
        const LaneLight light = turning_[lamp];
        for (std::size_t i = 0; i < lanes.size; ++i) {
            const float gx = lanes.geometric_normal.x[i];
            const float gy = lanes.geometric_normal.y[i];
            const float gz = lanes.geometric_normal.z[i];
            const float turns = lanes.azimuth[i] * kInverseTurn;
            const LaneLightSample sample = sample_lane_light(light,
                                                             lanes.origin.x[i] - offset_length * gx,
                                                             lanes.origin.y[i] - offset_length * gy,
                                                             lanes.origin.z[i] - offset_length * gz,
                                                             turns - std::floor(turns));
            const float cos_i = lanes.normal.x[i] * sample.x + lanes.normal.y[i] * sample.y +
                                lanes.normal.z[i] * sample.z;
            const float arriving = gx * sample.x + gy * sample.y + gz * sample.z;
            const std::uint32_t lights = std::uint32_t(cos_i > 0) & std::uint32_t(arriving > 0) &
                                         std::uint32_t(sample.strength > 0);
            const bool is_chosen = lanes.lamp[i] == std::int32_t(lamp);
            lanes.w_i.x[i] = is_chosen ? sample.x : lanes.w_i.x[i];
            lanes.w_i.y[i] = is_chosen ? sample.y : lanes.w_i.y[i];
            lanes.w_i.z[i] = is_chosen ? sample.z : lanes.w_i.z[i];
            lanes.weight[i] *= is_chosen ? sample.strength * cos_i : 1.0f;
            lanes.distance[i] = is_chosen ? sample.distance : lanes.distance[i];
            lanes.active[i] = is_chosen ? -std::int32_t(lights) : lanes.active[i];
        }
    }
}

}  // namespace patina
