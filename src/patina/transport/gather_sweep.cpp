#include "patina/transport/gather_sweep.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/math/lanes.h"
#include "patina/reflectance/lobe_lanes.h"

#include <algorithm>

namespace patina {
namespace {

// Hits that count for less than this even in a lobe twice as wide are left out [-].
constexpr float kNegligibleWeight = 0.01f;

// The rows of the texels that are hit lie all over memory, so they are asked for this many hits
// ahead.
constexpr std::size_t kAhead = 32;

using Radiance = std::array<Lanes, 3>;

// The images of the lamps in the lobe of a place that is hit, seen by the gathering texel.
inline Lanes images(float minus_half_precision,
                    float scale,
                    const CompactLanes& image,
                    const CompactLanes& theta_squared) {
    return scale * from_compact(image) *
           exp_of_negative(minus_half_precision * from_compact(theta_squared));
}

// Radiance of the place that was hit towards the gathering texel [light_units()].
inline Radiance radiance_of(const StandingRow& row,
                            const StandingHit& hit,
                            float minus_half_precision) {
    Radiance radiance;
    for (std::size_t c = 0; c < 3; ++c) {
        radiance[c] = from_compact(row.radiance[c]);
    }
    if (minus_half_precision < 0) {
        const float scale = from_compact(hit.over_cosine);
        const Lanes image = images(minus_half_precision, scale, row.image, hit.theta_squared);
        for (Lanes& channel : radiance) channel += image;
    }
    return radiance;
}

inline Radiance radiance_of(const TurningRow& row,
                            const TurningHit& hit,
                            float minus_half_precision) {
    Radiance radiance;
    const Lanes direct = from_compact(hit.irradiance);
    for (std::size_t c = 0; c < 3; ++c) {
        radiance[c] = from_compact(row.radiance[c]) + row.diffuse[Eigen::Index(c)] * direct;
    }
    if (minus_half_precision < 0) {
        const Lanes image =
            images(minus_half_precision, row.specular, hit.over_cosine, hit.theta_squared);
        for (Lanes& channel : radiance) channel += image;
    }
    return radiance;
}

// Asks for what radiance_of() will read of a hit to come.
template <typename Row>
inline void expect(const LargeVector<Row>& texels,
                   const LargeVector<float>& precision,
                   const GatherRows& rows,
                   std::size_t hit_index) {
    if (hit_index >= rows.hits.size()) return;
    const TexelId texel = rows.hits[hit_index].to;
    __builtin_prefetch(&texels[texel]);
    __builtin_prefetch(&precision[texel]);
}

// The light that arrives over the hits of one texel.
template <typename Row, typename Hit>
LightHalves gathered(const GatherRows& rows,
                     const LightSources<Row, Hit>& sources,
                     const LargeVector<float>& precision,
                     const GlossySources& glossy,
                     std::size_t texel) {
    LightHalves halves{};
    std::size_t k = rows.begin[texel];
    const std::size_t end = rows.begin[texel + 1];
    const GatherHit* hits = rows.hits.data() + k;
    const GlossyHit* first_onward = rows.glossy.data() + rows.glossy_begin[texel];
    const GlossyHit* last_onward =
        glossy.onward.empty() ? first_onward : rows.glossy.data() + rows.glossy_begin[texel + 1];
    const GlossyHit* onward = first_onward;
    for (std::uint32_t half = 0; half < 2; ++half) {
        Radiance sum{};
        for (; k < end && rows.hits[k].half == half; ++k) {
            expect(sources.texels, precision, rows, k + kAhead);
            if (onward < last_onward) expect_glossy(glossy, hits, *onward++);
            const GatherHit& hit = rows.hits[k];
            const Radiance radiance =
                radiance_of(sources.texels[hit.to], sources.irradiance[k], precision[hit.to]);
            // Half of the rays stands for the whole hemisphere.
            for (std::size_t c = 0; c < 3; ++c) sum[c] += 2 * hit.weight * radiance[c];
        }
        halves[half] = sum;
    }
    const auto add = [&](std::size_t number, float gain, const Radiance& radiance) {
        Radiance& sum = halves[hits[number].half];
        const float weight = 2 * hits[number].weight * gain;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * radiance[c];
    };
    for (const GlossyHit* first = first_onward; first < last_onward; first += kLanes) {
        add_glossy(glossy, hits, first, std::min(first + kLanes, last_onward), add);
    }
    return halves;
}

// How much up to eight hits, side by side, count for lobes of sigma and of twice and half of it.
struct LobeWeights {
    Lanes twice;  // the Gaussian alone [-]
    Lanes twice_weight, same_weight, half_weight;
};

// variance: sigma^2 [rad^2].
inline LobeWeights lobe_weights(const GatherHit* hits,
                                std::size_t count,
                                const Vec3f& normal,
                                const Vec3f& mirror,
                                float variance) {
    Lanes along{}, cosine{}, weight{};
    for (std::size_t l = 0; l < count; ++l) {
        along[l] = mirror.dot(hits[l].w);
        cosine[l] = normal.dot(hits[l].w);
        weight[l] = hits[l].weight;
    }
    const Lanes versine = 1.0f - along;
    const Lanes theta_squared = squared_angle(versine < 0.0f ? Lanes{} : versine);
    // The three Gaussians are powers of each other.
    LobeWeights weights;
    weights.twice = exp_of_negative(-0.125f * theta_squared / variance);
    const Lanes same = (weights.twice * weights.twice) * (weights.twice * weights.twice);
    const Lanes half = (same * same) * (same * same);
    const Lanes lowest = Lanes{} + float(kCosineFloor);
    const Lanes over_cosine = weight / (cosine < lowest ? lowest : cosine);
    weights.twice_weight = over_cosine * weights.twice;
    weights.same_weight = over_cosine * same;
    weights.half_weight = over_cosine * half;
    return weights;
}

// Sums over the hits on one texel's lobe, without what the three widths have in common.
template <typename Row, typename Hit>
LampBlockLight::LobeLanes through_lobe(const GatherRows& rows,
                                       const LightSources<Row, Hit>& sources,
                                       const LargeVector<Hit>& hits,
                                       const RadiantTexels& texels,
                                       const GlossySources& glossy,
                                       TexelId texel,
                                       const Vec3f& mirror,
                                       float variance) {
    LampBlockLight::LobeLanes sums;
    const LargeVector<float>& precision = texels.minus_half_precision();
    const std::size_t begin = rows.begin[texel];
    const std::size_t end = rows.begin[texel + 1];
    const GlossyHit* onward = rows.glossy.data() + rows.glossy_begin[texel];
    const GlossyHit* last_onward =
        glossy.onward.empty() ? onward : rows.glossy.data() + rows.glossy_begin[texel + 1];
    for (std::size_t first = begin; first < end; first += kLanes) {
        const std::size_t count = std::min(kLanes, end - first);
        const LobeWeights weights =
            lobe_weights(&rows.hits[first], count, texels[texel].normal, mirror, variance);
        const auto add = [&](std::size_t l, float gain, const Radiance& radiance) {
            const float twice = gain * weights.twice_weight[l];
            const float same = gain * weights.same_weight[l];
            const float half = gain * weights.half_weight[l];
            for (std::size_t c = 0; c < 3; ++c) {
                sums.twice[c] += twice * radiance[c];
                sums.same[c] += same * radiance[c];
                sums.half[c] += half * radiance[c];
            }
        };
        for (const GlossyHit* next = onward;
             next < last_onward && begin + next->hit < first + count;
             ++next) {
            expect_glossy(glossy, &rows.hits[begin], *next);
        }
        for (std::size_t l = 0; l < count; ++l) {
            const std::size_t k = first + l;
            expect(sources.texels, precision, rows, k + kAhead);
            if (weights.twice[l] < kNegligibleWeight) continue;
            const GatherHit& hit = rows.hits[k];
            add(l, 1.0f, radiance_of(sources.texels[hit.to], hits[k], precision[hit.to]));
        }
        while (onward < last_onward && begin + onward->hit < first + count) {
            const GlossyHit* next = onward;
            while (next < last_onward && next < onward + kLanes &&
                   begin + next->hit < first + count) {
                ++next;
            }
            add_glossy(glossy,
                       &rows.hits[begin],
                       onward,
                       next,
                       [&](std::size_t number, float gain, const Radiance& radiance) {
                           const std::size_t l = begin + number - first;
                           if (weights.twice[l] >= kNegligibleWeight) add(l, gain, radiance);
                       });
            onward = next;
        }
    }
    return sums;
}

}  // namespace

LampBlockLight::LampBlockLight(const Surface& surface,
                               const TexelAtlas& atlas,
                               const GatherGraph& graph,
                               LampBlock lamps,
                               bool turning,
                               bool keeps_hits)
    : surface_(surface),
      atlas_(atlas),
      lamps_(std::move(lamps)),
      units_(light_units(atlas, lamps_)),
      turning_(turning),
      keeps_hits_(keeps_hits),
      indirect_(atlas.texels.size()) {
    if (turning_) {
        turning_sources_.texels.resize(atlas.texels.size());
    } else {
        standing_.texels.resize(atlas.texels.size());
        lit_ = lit_texels(atlas, lamps_, units_);
    }
    if (keeps_hits_) light_hits(graph);
}

void LampBlockLight::light_hits(const GatherGraph& graph) {
    if (turning_) {
        const auto hits = [&](const GatherRows& rows) {
            return turning_hits(surface_, atlas_, lamps_, units_, rows);
        };
        turning_sources_.irradiance = hits(graph.irradiance);
        for (const GatherRows& rows : graph.lobes) turning_sources_.lobes.push_back(hits(rows));
    } else {
        const auto hits = [&](const GatherRows& rows) {
            return standing_hits(atlas_, lamps_, rows);
        };
        standing_.irradiance = hits(graph.irradiance);
        for (const GatherRows& rows : graph.lobes) standing_.lobes.push_back(hits(rows));
    }
    has_hits_ = true;
}

void LampBlockLight::end_sweep() {
    if (keeps_hits_) return;
    standing_.irradiance = {};
    standing_.lobes = {};
    turning_sources_.irradiance = {};
    turning_sources_.lobes = {};
    has_hits_ = false;
}

void LampBlockLight::light_texels(const RadiantTexels& texels, LargeVector<OnwardRow>& onward) {
    // Before the first sweep there is no indirect light that lobes could send on.
    onward.resize(has_bounced_ ? indirect_.size() : 0);
    parallel_for(indirect_.size(), [&](std::size_t i) {
        const RadiantTexels::Material& material = texels[TexelId(i)];
        const LitTexel lit = turning_ ? lit_texel(lamps_, units_, i) : lit_[i];
        Radiance diffuse;
        for (std::size_t c = 0; c < 3; ++c) {
            const Lanes all = indirect_[i][c] + lit.irradiance;
            if (has_bounced_) {
                onward[i].radiance[c] = to_compact(material.onward[Eigen::Index(c)] * all);
            }
            diffuse[c] = material.diffuse[Eigen::Index(c)] * (turning_ ? indirect_[i][c] : all);
        }
        const auto fill = [&](auto& row) {
            for (std::size_t c = 0; c < 3; ++c) row.radiance[c] = to_compact(diffuse[c]);
        };
        if (turning_) {
            TurningRow& row = turning_sources_.texels[i];
            row.diffuse = material.diffuse;
            row.specular = material.specular;
            fill(row);
            return;
        }
        StandingRow& row = standing_.texels[i];
        fill(row);
        row.image = to_compact(material.specular * lit.over_cosine);
    });
}

void LampBlockLight::sweep(const GatherGraph& graph,
                           const RadiantTexels& texels,
                           const SurfaceFilter& filter,
                           SweptLight& swept,
                           float step) {
    const std::size_t num_texels = indirect_.size();
    if (!has_hits_) light_hits(graph);
    light_texels(texels, swept.onward);
    has_bounced_ = true;
    const GlossySources glossy{texels.lobes(), swept.onward};
    swept.unfiltered.resize(num_texels);
    for (IndirectLanes& half : swept.halves) half.resize(num_texels);
    const auto gather = [&](const auto& sources) {
        parallel_for(num_texels, [&](std::size_t i) {
            swept.unfiltered[i] =
                gathered(graph.irradiance, sources, texels.minus_half_precision(), glossy, i);
        });
    };
    turning_ ? gather(turning_sources_) : gather(standing_);
    if (filters_.empty()) filters_ = where_filter_gains(filter, swept.unfiltered);
    parallel_for(num_texels, [&](std::size_t i) {
        const LightHalves smooth = filtered_for(filters_[i], filter, swept.unfiltered, i);
        for (std::size_t c = 0; c < 3; ++c) {
            const Lanes mean = 0.5f * (smooth[0][c] + smooth[1][c]);
            // Both halves alike, so that their difference stays that of their rays; not below 0.
            const Lanes further = (step - 1) * (mean - indirect_[i][c]);
            const Lanes less = smooth[0][c] < smooth[1][c] ? smooth[0][c] : smooth[1][c];
            const Lanes added = further < -less ? -less : further;
            for (std::size_t half = 0; half < 2; ++half) {
                swept.halves[half][i][c] = units_ * (smooth[half][c] + added);
            }
            indirect_[i][c] = mean + added;
        }
    });
}

void LampBlockLight::add(std::span<const std::array<Lanes, 2>> irradiance, SweptLight& swept) {
    PATINA_CHECK_EQ(irradiance.size(), indirect_.size());
    parallel_for(indirect_.size(), [&](std::size_t i) {
        const std::array<Lanes, 2>& halves = irradiance[i];
        const Lanes mean = 0.5f * (halves[0] + halves[1]) / units_;
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t half = 0; half < 2; ++half) swept.halves[half][i][c] += halves[half];
            indirect_[i][c] += mean;
        }
    });
}

void LampBlockLight::restart() {
    indirect_.assign(indirect_.size(), {});
    has_bounced_ = false;
}

LampBlockLight::LobeLanes LampBlockLight::lobe(const GatherGraph& graph,
                                               std::size_t view,
                                               const RadiantTexels& texels,
                                               const SweptLight& swept,
                                               TexelId texel,
                                               const Vec3f& w_v,
                                               double roughness) const {
    const Vec3f& normal = texels[texel].normal;
    const float cos_v = normal.dot(w_v);
    if (!(cos_v > 0)) return {};
    const Vec3f mirror = 2 * cos_v * normal - w_v;
    const auto variance = float(square(roughness));
    const GlossySources glossy{texels.lobes(), swept.onward};
    const auto sums_over = [&](const auto& sources) {
        return through_lobe(graph.lobes[view],
                            sources,
                            sources.lobes[view],
                            texels,
                            glossy,
                            texel,
                            mirror,
                            variance);
    };
    LobeLanes sums = turning_ ? sums_over(turning_sources_) : sums_over(standing_);
    const float scale = 1 / (std::max(cos_v, float(kCosineFloor)) * variance);
    for (std::size_t c = 0; c < 3; ++c) {
        sums.half[c] *= 4 * scale * units_;
        sums.same[c] *= scale * units_;
        sums.twice[c] *= 0.25f * scale * units_;
    }
    return sums;
}

}  // namespace patina
