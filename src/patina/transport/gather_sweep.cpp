#include "patina/transport/gather_sweep.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/reflectance/lobe_lanes.h"

#include <algorithm>
#include <bit>

namespace patina {
namespace {

constexpr std::size_t kTexelsPerBlock = 256;
// Lobes with less albedo than this send no image of a lamp worth the sum.
constexpr double kNegligibleLobe = 1e-5;

float from_upper_half(std::uint16_t half) {
    return std::bit_cast<float>(std::uint32_t(half) << 16);
}

// The rows of the texels that are hit lie all over memory, so they are asked for this many hits
// ahead.
constexpr std::size_t kAhead = 4;

// Asks for the lines of a value that will be read soon.
template <typename Value>
void prefetch(const Value& value) {
    constexpr std::size_t kLine = 64;
    const char* const begin = reinterpret_cast<const char*>(&value);
    for (std::size_t offset = 0; offset < sizeof(Value); offset += kLine) {
        __builtin_prefetch(begin + offset);
    }
}

// Adds weight * from to to.
void add_scaled(float weight, const Lanes& from, Lanes& to) {
    for (std::size_t l = 0; l < kLampLanes; ++l) to[l] += weight * from[l];
}

// One channel of one texel; not below 0, as weights of the filter may be.
Lanes filtered(const SurfaceFilter& filter,
               const IndirectLanes& gathered,
               std::size_t texel,
               std::size_t channel) {
    Lanes sum{};
    for (std::size_t k = filter.begin[texel]; k < filter.begin[texel + 1]; ++k) {
        add_scaled(filter.weight[k], gathered[filter.texel[k]][channel], sum);
    }
    for (float& value : sum) value = std::max(value, 0.0f);
    return sum;
}

}  // namespace

RadiantTexels::RadiantTexels(const TexelAtlas& atlas,
                             std::span<const Reflectance> maps,
                             bool with_specular)
    : materials_(atlas.texels.size()) {
    PATINA_CHECK_EQ(maps.size(), atlas.texels.size());
    // A mean over directions weighted by their cosine is reached near cos_i = 2/3.
    constexpr double kMeanCosine = 2.0 / 3;
    parallel_for(materials_.size(), [&](std::size_t i) {
        const Reflectance& map = maps[i];
        Material& material = materials_[i];
        material.normal = atlas.texels[i].point.normal.cast<float>();
        material.diffuse = (map.diffuse / kPi).cast<float>();
        material.onward = material.diffuse;
        if (!with_specular) return;
        const double albedo = map.specular * lobe_albedo(kMeanCosine, map.roughness);
        material.onward += float(albedo / kPi);
        if (albedo < kNegligibleLobe) return;
        material.specular = float(map.specular / kPi);
        material.minus_half_precision = float(-0.5 / square(map.roughness));
    });
}

LampBlockLight::LampBlockLight(const Surface& surface,
                               const TexelAtlas& atlas,
                               const GatherGraph& graph,
                               LampBlock lamps,
                               bool turning,
                               bool keeps_hits)
    : surface_(surface),
      atlas_(atlas),
      lamps_(std::move(lamps)),
      turning_(turning),
      keeps_hits_(keeps_hits),
      indirect_(atlas.texels.size()),
      radiosity_(atlas.texels.size()) {
    if (!turning_) {
        lit_ = lit_texels(atlas, lamps_);
    } else if (keeps_hits_) {
        light_hits(graph);
    }
}

void LampBlockLight::light_hits(const GatherGraph& graph) {
    irradiance_lanes_ = hit_lanes(surface_, atlas_, lamps_, graph.irradiance);
    for (const GatherRows& rows : graph.lobes) {
        lobe_lanes_.push_back(hit_lanes(surface_, atlas_, lamps_, rows));
    }
    has_hits_ = true;
}

void LampBlockLight::end_sweep() {
    if (!turning_ || keeps_hits_) return;
    irradiance_lanes_ = {};
    lobe_lanes_ = {};
    has_hits_ = false;
}

void LampBlockLight::add_lobe_of_lamps(const RadiantTexels::Material& material,
                                       const GatherHit& hit,
                                       std::size_t hit_index,
                                       const std::vector<CompactLanes>& compact,
                                       Radiance& radiance) const {
    const Vec3f& n = material.normal;
    const float cos_o = -n.dot(hit.w);
    const float scale = material.specular / std::max(cos_o, float(kCosineFloor));
    Lanes lobe;
    if (turning_) {
        const CompactLanes& lit = compact[hit_index];
        for (std::size_t l = 0; l < kLampLanes; ++l) {
            const float exponent =
                material.minus_half_precision * squared_angle(from_upper_half(lit.versine[l]));
            lobe[l] = scale * from_upper_half(lit.over_cosine[l]) * exp_of_negative(exponent);
        }
    } else {
        const LitTexels::Mirror& lit = lit_.mirror[hit.to];
        // 1 - w . mirror(w_o) for the direction w to the lamp.
        const Vec3f turned = (2 * cos_o * n + hit.w) / LitTexels::kDirection;
        for (std::size_t l = 0; l < kLampLanes; ++l) {
            const float cosine = turned.x() * float(lit.x[l]) + turned.y() * float(lit.y[l]) +
                                 turned.z() * float(lit.z[l]);
            const float versine = std::max(0.0f, 1 - cosine);
            lobe[l] = scale * from_upper_half(lit.over_cosine[l]) *
                      exp_of_negative(material.minus_half_precision * squared_angle(versine));
        }
    }
    for (Lanes& channel : radiance) add_scaled(1, lobe, channel);
}

void LampBlockLight::expect(const RadiantTexels& texels,
                            const GatherRows& rows,
                            std::size_t hit_index) const {
    if (hit_index >= rows.hits.size()) return;
    const TexelId texel = rows.hits[hit_index].to;
    prefetch(texels[texel]);
    prefetch(radiosity_[texel]);
    if (!turning_) prefetch(lit_.mirror[texel]);
}

LampBlockLight::Radiance LampBlockLight::radiance_of(
    const RadiantTexels& texels,
    const GatherHit& hit,
    std::size_t hit_index,
    const std::vector<CompactLanes>& compact) const {
    const RadiantTexels::Material& material = texels[hit.to];
    Radiance radiance = radiosity_[hit.to];
    if (turning_) {
        Lanes direct;
        for (std::size_t l = 0; l < kLampLanes; ++l) {
            direct[l] = from_upper_half(compact[hit_index].irradiance[l]);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            add_scaled(material.diffuse[Eigen::Index(c)], direct, radiance[c]);
        }
    }
    if (material.specular > 0) {
        add_lobe_of_lamps(material, hit, hit_index, compact, radiance);
    }
    return radiance;
}

void LampBlockLight::sweep(const GatherGraph& graph,
                           const RadiantTexels& texels,
                           const SurfaceFilter& filter,
                           std::array<IndirectLanes, 2>& halves) {
    const std::size_t num_texels = indirect_.size();
    if (turning_ && !has_hits_) light_hits(graph);
    parallel_for(num_texels, [&](std::size_t i) {
        const RadiantTexels::Material& material = texels[TexelId(i)];
        for (std::size_t c = 0; c < 3; ++c) {
            const float onward = material.onward[Eigen::Index(c)];
            const float diffuse = material.diffuse[Eigen::Index(c)];
            for (std::size_t l = 0; l < kLampLanes; ++l) {
                radiosity_[i][c][l] = onward * indirect_[i][c][l];
            }
            if (!turning_) add_scaled(diffuse, lit_.irradiance[i], radiosity_[i][c]);
        }
    });
    std::array<IndirectLanes, 2> gathered;
    for (IndirectLanes& half : gathered) half.resize(num_texels);
    parallel_blocks(num_texels, kTexelsPerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::array<Radiance, 2> sums{};
            for (std::size_t k = graph.irradiance.begin[i]; k < graph.irradiance.begin[i + 1];
                 ++k) {
                const GatherHit& hit = graph.irradiance.hits[k];
                expect(texels, graph.irradiance, k + kAhead);
                const Radiance radiance = radiance_of(texels, hit, k, irradiance_lanes_);
                for (std::size_t c = 0; c < 3; ++c) {
                    // Half of the rays stands for the whole hemisphere.
                    add_scaled(2 * hit.weight, radiance[c], sums[hit.half][c]);
                }
            }
            gathered[0][i] = sums[0];
            gathered[1][i] = sums[1];
        }
    });
    for (IndirectLanes& half : halves) half.resize(num_texels);
    parallel_blocks(num_texels, kTexelsPerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                for (const std::size_t half : {0u, 1u}) {
                    halves[half][i][c] = filtered(filter, gathered[half], i, c);
                }
                for (std::size_t l = 0; l < kLampLanes; ++l) {
                    indirect_[i][c][l] = 0.5f * (halves[0][i][c][l] + halves[1][i][c][l]);
                }
            }
        }
    });
}

void LampBlockLight::restart() { indirect_.assign(indirect_.size(), {}); }

LampBlockLight::LobeLanes LampBlockLight::lobe(const GatherGraph& graph,
                                               std::size_t view,
                                               const RadiantTexels& texels,
                                               TexelId texel,
                                               const Vec3f& w_v,
                                               double roughness) const {
    LobeLanes sums;
    const Vec3f& normal = texels[texel].normal;
    const float cos_v = normal.dot(w_v);
    if (!(cos_v > 0)) return sums;
    const Vec3f mirror = 2 * cos_v * normal - w_v;
    const auto variance = float(square(roughness));
    const GatherRows& rows = graph.lobes[view];
    static const std::vector<CompactLanes> kNone;
    const std::vector<CompactLanes>& compact = turning_ ? lobe_lanes_[view] : kNone;
    for (std::size_t k = rows.begin[texel]; k < rows.begin[texel + 1]; ++k) {
        const GatherHit& hit = rows.hits[k];
        expect(texels, rows, k + kAhead);
        const float theta_squared = squared_angle(std::max(0.0f, 1 - mirror.dot(hit.w)));
        // The three Gaussians are powers of each other.
        const float twice = exp_of_negative(-0.125f * theta_squared / variance);
        if (twice < 0.01f) continue;
        const float same = (twice * twice) * (twice * twice);
        const float half = (same * same) * (same * same);
        const float weight = hit.weight / std::max(normal.dot(hit.w), float(kCosineFloor));
        const Radiance radiance = radiance_of(texels, hit, k, compact);
        for (std::size_t c = 0; c < 3; ++c) {
            add_scaled(weight * twice, radiance[c], sums.twice[c]);
            add_scaled(weight * same, radiance[c], sums.same[c]);
            add_scaled(weight * half, radiance[c], sums.half[c]);
        }
    }
    const float scale = 1 / (std::max(cos_v, float(kCosineFloor)) * variance);
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t l = 0; l < kLampLanes; ++l) {
            sums.half[c][l] *= 4 * scale;
            sums.same[c][l] *= scale;
            sums.twice[c][l] *= 0.25f * scale;
        }
    }
    return sums;
}

}  // namespace patina
