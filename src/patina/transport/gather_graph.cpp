#include "patina/transport/gather_graph.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/base/random.h"
#include "patina/math/warp.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace patina {
namespace {

constexpr std::size_t kTexelsPerBlock = 1024;
// Rays of the first look, and how many rings of neighbours share what it found: about 25 texels, so
// that a solid angle of 1 % of the hemisphere (cosine-weighted) is missed once in fifty times.
constexpr int kProbeRays = 16;
constexpr int kProbeRings = 2;
// Texels that the number of hits is judged by. Where one texel's share of rays that hit differs
// from another's by all or nothing, the standard error of the mean share is 0.5 / sqrt(4096), below
// 1 %.
constexpr std::size_t kJudgedTexels = 4096;
// One lobe ray in so many is drawn over the whole hemisphere, so that no weight is unbounded where
// a lobe is wider than the one that the rays are drawn from.
constexpr int kDefensiveShare = 4;

// Streams of random numbers for each texel.
enum class Stream : std::uint64_t { probe = 0, irradiance = 1, first_view = 2 };

class GraphTracer {
  public:
    GraphTracer(const Surface& surface, const TexelAtlas& atlas, const GatherOptions& options)
        : surface_(surface), atlas_(atlas), options_(options) {}

    [[nodiscard]] bool probe_hits(std::size_t texel) const {
        const SurfacePoint& point = atlas_.texels[texel].point;
        const Frame frame(point.normal);
        const PairSequence pairs(*this, texel, std::uint64_t(Stream::probe));
        for (int k = 0; k < kProbeRays; ++k) {
            const Vec3 w = frame.to_world(square_to_cosine_hemisphere(pairs.at(k)));
            if (point.geometric_normal.dot(w) <= 0) continue;
            if (surface_.tracer->occluded(surface_.tracer->offset(point, w), w)) return true;
        }
        return false;
    }

    // Returns how many rays hit a back.
    int trace_irradiance(std::size_t texel, std::vector<GatherHit>& hits) const {
        const Frame frame(atlas_.texels[texel].point.normal);
        const float weight = float(kPi / options_.rays);
        int num_backs = 0;
        const PairSequence pairs(*this, texel, std::uint64_t(Stream::irradiance));
        for (int k = 0; k < options_.rays; ++k) {
            const Vec3 w = frame.to_world(square_to_cosine_hemisphere(pairs.at(k)));
            num_backs += trace(texel, w, weight, half_of(k, options_.rays), hits) == Met::back;
        }
        return num_backs;
    }

    void trace_lobe(std::size_t texel,
                    std::size_t view,
                    const Vec3& w_v,
                    std::vector<GatherHit>& hits) const {
        const Vec3& normal = atlas_.texels[texel].point.normal;
        const double cos_v = normal.dot(w_v);
        if (!(cos_v > 0)) return;
        const Vec3 mirror = 2 * cos_v * normal - w_v;
        const Frame about_normal(normal);
        const Frame about_mirror(mirror);
        const double kappa = 1 / square(options_.lobe_spread);
        const PairSequence pairs(*this, texel, std::uint64_t(Stream::first_view) + view);
        for (int k = 0; k < options_.lobe_rays; ++k) {
            const bool is_defensive = k % kDefensiveShare == 0;
            const auto u = pairs.at(k);
            const Vec3 w = is_defensive
                               ? about_normal.to_world(square_to_cosine_hemisphere(u))
                               : about_mirror.to_world(square_to_von_mises_fisher(u, kappa));
            const double cosine = normal.dot(w);
            if (!(cosine > 0)) continue;
            const double density = (cosine / kPi + (kDefensiveShare - 1) *
                                                       von_mises_fisher_pdf(mirror.dot(w), kappa)) /
                                   kDefensiveShare;
            const double weight = cosine / (density * options_.lobe_rays);
            trace(texel, w, float(weight), half_of(k, options_.lobe_rays), hits);
        }
    }

  private:
    enum class Met { nothing, front, back };

    // Consecutive points of the sequence are stratified among themselves, so each half is.
    static std::uint32_t half_of(int ray, int rays) { return ray < rays / 2 ? 0u : 1u; }

    // The first pairs of the SobolSamplers of one texel's rays, which have their scrambling in
    // common.
    class PairSequence {
      public:
        PairSequence(const GraphTracer& tracer, std::size_t texel, std::uint64_t stream)
            : scramble_(
                  sobol_scramble(sobol_element_hash(tracer.options_.seed,
                                                    Pass::gather,
                                                    stream * tracer.atlas_.texels.size() + texel),
                                 1)) {}
        [[nodiscard]] std::array<double, 2> at(int ray) const {
            return sobol_point(scramble_, std::uint32_t(ray));
        }

      private:
        SobolScramble scramble_;
    };

    Met trace(std::size_t texel,
              const Vec3& w,
              float weight,
              std::uint32_t half,
              std::vector<GatherHit>& hits) const {
        const SurfacePoint& point = atlas_.texels[texel].point;
        if (!faces(point, w)) return Met::nothing;
        const auto hit = surface_.tracer->intersect(surface_.tracer->offset(point, w), w);
        if (!hit) return Met::nothing;
        const SurfacePoint other = surface_point(*surface_.mesh, hit->triangle, hit->barycentric);
        if (other.geometric_normal.dot(w) >= 0) return Met::back;
        if (!faces(other, -w)) return Met::nothing;
        const TexelId to = atlas_.lookup(*surface_.mesh, hit->triangle, hit->barycentric);
        if (to != kNoTexel) hits.push_back({to, w.cast<float>(), weight, half});
        return Met::front;
    }

    const Surface& surface_;
    const TexelAtlas& atlas_;
    const GatherOptions& options_;
};

// Texels within so many rings of one that is marked.
std::vector<std::uint8_t> grow(const TexelAtlas& atlas, std::vector<std::uint8_t> marked) {
    for (int ring = 0; ring < kProbeRings; ++ring) {
        std::vector<std::uint8_t> grown = marked;
        parallel_for(grown.size(), [&](std::size_t i) {
            for (std::uint32_t k = atlas.neighbor_begin[i]; k < atlas.neighbor_begin[i + 1]; ++k) {
                if (marked[atlas.neighbors[k]] != 0) grown[i] = 1;
            }
        });
        marked = std::move(grown);
    }
    return marked;
}

// Rows whose texels are traced by trace_texel(texel, hits), side by side.
template <typename TraceTexel>
GatherRows make_rows(std::size_t num_texels, Progress& progress, const TraceTexel& trace_texel) {
    GatherRows rows;
    rows.begin.assign(num_texels + 1, 0);
    std::vector<std::vector<GatherHit>> blocks((num_texels + kTexelsPerBlock - 1) /
                                               kTexelsPerBlock);
    parallel_for(
        blocks.size(),
        [&](std::size_t block) {
            const std::size_t end = std::min(num_texels, (block + 1) * kTexelsPerBlock);
            for (std::size_t i = block * kTexelsPerBlock; i < end; ++i) {
                const std::size_t before = blocks[block].size();
                trace_texel(i, blocks[block]);
                rows.begin[i + 1] = blocks[block].size() - before;
            }
            progress.advance(end - block * kTexelsPerBlock);
        },
        1);
    std::partial_sum(rows.begin.begin(), rows.begin.end(), rows.begin.begin());
    rows.hits.resize(rows.begin.back());
    parallel_for(
        blocks.size(),
        [&](std::size_t block) {
            std::copy(blocks[block].begin(),
                      blocks[block].end(),
                      rows.hits.begin() + std::ptrdiff_t(rows.begin[block * kTexelsPerBlock]));
            blocks[block] = {};
        },
        1);
    return rows;
}

}  // namespace

GatherGraph trace_gather_graph(const Surface& surface,
                               const TexelAtlas& atlas,
                               std::span<const ViewDirections> views,
                               const GatherOptions& options,
                               Progress& progress) {
    PATINA_CHECK(options.rays >= 4 && options.lobe_rays >= 4 && options.lobe_spread > 0);
    const std::size_t num_texels = atlas.texels.size();
    progress.begin_stage("gather graph", num_texels * (1 + views.size()), "texels");
    const GraphTracer tracer(surface, atlas, options);
    std::vector<std::uint8_t> sees_surface(num_texels);
    parallel_for(num_texels, [&](std::size_t i) { sees_surface[i] = tracer.probe_hits(i); });
    sees_surface = grow(atlas, std::move(sees_surface));

    GatherGraph graph;
    graph.backs_over_fronts.assign(num_texels, 0.0f);
    graph.irradiance =
        make_rows(num_texels, progress, [&](std::size_t i, std::vector<GatherHit>& hits) {
            if (sees_surface[i] == 0) return;
            const std::size_t before = hits.size();
            const int num_backs = tracer.trace_irradiance(i, hits);
            graph.backs_over_fronts[i] =
                float(num_backs) / float(std::max<std::size_t>(1, hits.size() - before));
        });
    const auto num_concave =
        std::accumulate(sees_surface.begin(), sees_surface.end(), std::uint64_t(0));
    graph.num_rays = num_texels * kProbeRays + num_concave * std::uint64_t(options.rays);
    for (std::size_t view = 0; view < views.size(); ++view) {
        const auto wanted = [&](std::size_t i) {
            return sees_surface[i] != 0 && views[view][i].squaredNorm() > 0;
        };
        graph.lobes.push_back(
            make_rows(num_texels, progress, [&](std::size_t i, std::vector<GatherHit>& hits) {
                if (wanted(i)) {
                    tracer.trace_lobe(i, view, views[view][i].cast<double>().normalized(), hits);
                }
            }));
        for (std::size_t i = 0; i < num_texels; ++i) {
            if (wanted(i)) graph.num_rays += std::uint64_t(options.lobe_rays);
        }
    }
    progress.end_stage(
        fmt::format("{:.1f} M rays, {:.1f} M hits for the irradiance, {:.0f} % of "
                    "the texels convex",
                    double(graph.num_rays) / 1e6,
                    double(graph.irradiance.hits.size()) / 1e6,
                    100.0 * (1 - double(num_concave) / double(num_texels))));
    return graph;
}

GatherHitCount expect_gather_hits(const Surface& surface,
                                  const TexelAtlas& atlas,
                                  std::span<const ViewDirections> views,
                                  const GatherOptions& options) {
    const GraphTracer tracer(surface, atlas, options);
    const std::size_t num_texels = atlas.texels.size();
    const std::size_t step = std::max<std::size_t>(1, num_texels / kJudgedTexels);
    const std::size_t num_judged = (num_texels + step - 1) / step;
    const auto expected = [&](const auto& trace_texel) {
        const auto hits_of = [&](std::size_t k) {
            std::vector<GatherHit> hits;
            trace_texel(k * step, hits);
            return double(hits.size());
        };
        return ordered_reduce(num_judged, 0.0, hits_of) * double(num_texels) / double(num_judged);
    };
    GatherHitCount count;
    count.irradiance = expected([&](std::size_t i, std::vector<GatherHit>& hits) {
        static_cast<void>(tracer.trace_irradiance(i, hits));
    });
    for (std::size_t view = 0; view < views.size(); ++view) {
        count.lobes.push_back(expected([&](std::size_t i, std::vector<GatherHit>& hits) {
            const Vec3f& w_v = views[view][i];
            if (w_v.squaredNorm() > 0) {
                tracer.trace_lobe(i, view, w_v.cast<double>().normalized(), hits);
            }
        }));
    }
    return count;
}

}  // namespace patina
