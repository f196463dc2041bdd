#include "patina/transport/gather_graph.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/transport/gather_rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>

namespace patina {
namespace {

constexpr std::size_t kTexelsPerBlock = 1024;
// How many rings of neighbours share what GatherRays::kProbeRays found: about 25 texels, so that a
// solid angle of 1 % of the hemisphere (cosine-weighted) is missed once in fifty times.
constexpr int kProbeRings = 2;
// Texels that the number of hits is judged by. Where one texel's share of rays that hit differs
// from another's by all or nothing, the standard error of the mean share is 0.5 / sqrt(4096), below
// 1 %.
constexpr std::size_t kJudgedTexels = 4096;
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

// Joins what blocks of texels hold, in order, by all threads; the blocks are empty afterwards.
template <typename Hit>
LargeVector<Hit> joined(std::vector<std::vector<Hit>>& blocks,
                        const std::vector<std::size_t>& begin) {
    LargeVector<Hit> hits(begin.back());
    parallel_for(
        blocks.size(),
        [&](std::size_t block) {
            std::copy(blocks[block].begin(),
                      blocks[block].end(),
                      hits.begin() + std::ptrdiff_t(begin[block * kTexelsPerBlock]));
            blocks[block] = {};
        },
        1);
    return hits;
}

// What traces the rays of an atlas.
struct GraphTracer {
    const Surface& surface;
    const TexelAtlas& atlas;
    const GatherOptions& options;

    // Calls work(rays, i) for every i in [0, count), side by side.
    template <typename Work>
    void run(std::size_t count, const Work& work) const {
        run_blocks(count, [&](GatherRays& rays, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) work(rays, i);
        });
    }
    // Calls work(rays, begin, end) for blocks of kTexelsPerBlock, side by side.
    template <typename Work>
    void run_blocks(std::size_t count, const Work& work) const {
        parallel_blocks(count, kTexelsPerBlock, [&](std::size_t begin, std::size_t end) {
            work(*std::make_unique<GatherRays>(surface, atlas, options), begin, end);
        });
    }
};

// Rows whose texels are traced by trace_texel(rays, texel, row).
template <typename TraceTexel>
GatherRows make_rows(const GraphTracer& tracer, Progress& progress, const TraceTexel& trace_texel) {
    const std::size_t num_texels = tracer.atlas.texels.size();
    GatherRows rows;
    rows.begin.assign(num_texels + 1, 0);
    rows.glossy_begin.assign(num_texels + 1, 0);
    const std::size_t num_blocks = (num_texels + kTexelsPerBlock - 1) / kTexelsPerBlock;
    std::vector<std::vector<GatherHit>> hits(num_blocks);
    std::vector<std::vector<GlossyHit>> glossy(num_blocks);
    tracer.run_blocks(num_texels, [&](GatherRays& rays, std::size_t begin, std::size_t end) {
        const std::size_t block = begin / kTexelsPerBlock;
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t before = hits[block].size();
            const std::size_t glossy_before = glossy[block].size();
            trace_texel(rays, i, TracedRow{hits[block], glossy[block], before});
            rows.begin[i + 1] = hits[block].size() - before;
            rows.glossy_begin[i + 1] = glossy[block].size() - glossy_before;
        }
        progress.advance(end - begin);
    });
    for (std::vector<std::size_t>* begin : {&rows.begin, &rows.glossy_begin}) {
        std::partial_sum(begin->begin(), begin->end(), begin->begin());
    }
    rows.hits = joined(hits, rows.begin);
    rows.glossy = joined(glossy, rows.glossy_begin);
    return rows;
}

}  // namespace

GatherGraph trace_gather_graph(const Surface& surface,
                               const TexelAtlas& atlas,
                               std::span<const ViewDirections> views,
                               const GatherOptions& options,
                               Progress& progress) {
    PATINA_CHECK(options.rays >= 4 && options.rays % 4 == 0);
    PATINA_CHECK(options.lobe_rays >= 8 && options.lobe_rays % 8 == 0 && options.lobe_spread > 0);
    PATINA_CHECK(std::max(options.rays, options.lobe_rays) <= kMaxGatherRays);
    const std::size_t num_texels = atlas.texels.size();
    progress.begin_stage("gather graph", num_texels * (1 + views.size()), "texels");
    const GraphTracer tracer{surface, atlas, options};
    std::vector<std::uint8_t> sees_surface(num_texels);
    tracer.run(num_texels,
               [&](GatherRays& rays, std::size_t i) { sees_surface[i] = rays.probe_hits(i); });
    sees_surface = grow(atlas, std::move(sees_surface));

    GatherGraph graph;
    graph.backs_over_fronts.assign(num_texels, 0.0f);
    graph.irradiance =
        make_rows(tracer, progress, [&](GatherRays& rays, std::size_t i, const TracedRow& row) {
            if (sees_surface[i] == 0) return;
            const int num_backs = rays.trace_irradiance(i, row);
            graph.backs_over_fronts[i] =
                float(num_backs) / float(std::max<std::size_t>(1, row.hits.size() - row.first));
        });
    const auto num_concave =
        std::accumulate(sees_surface.begin(), sees_surface.end(), std::uint64_t(0));
    graph.num_rays =
        num_texels * GatherRays::kProbeRays + num_concave * std::uint64_t(options.rays);
    for (std::size_t view = 0; view < views.size(); ++view) {
        const auto wanted = [&](std::size_t i) {
            return sees_surface[i] != 0 && views[view][i].squaredNorm() > 0;
        };
        graph.lobes.push_back(
            make_rows(tracer, progress, [&](GatherRays& rays, std::size_t i, const TracedRow& row) {
                if (wanted(i)) rays.trace_lobe(i, view, views[view][i], row);
            }));
        for (std::size_t i = 0; i < num_texels; ++i) {
            graph.num_rays += wanted(i) ? std::uint64_t(options.lobe_rays) : 0;
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
    const GraphTracer tracer{surface, atlas, options};
    const std::size_t num_texels = atlas.texels.size();
    const std::size_t step = std::max<std::size_t>(1, num_texels / kJudgedTexels);
    const std::size_t num_judged = (num_texels + step - 1) / step;
    const auto expected = [&](const auto& trace_texel) {
        std::vector<std::size_t> hits(num_judged);
        std::vector<std::size_t> glossy(num_judged);
        tracer.run(num_judged, [&](GatherRays& rays, std::size_t k) {
            std::vector<GatherHit> hits_of_texel;
            std::vector<GlossyHit> glossy_of_texel;
            trace_texel(rays, k * step, TracedRow{hits_of_texel, glossy_of_texel, 0});
            hits[k] = hits_of_texel.size();
            glossy[k] = glossy_of_texel.size();
        });
        const auto of_all = [&](const std::vector<std::size_t>& counts) {
            return double(std::accumulate(counts.begin(), counts.end(), std::size_t(0))) *
                   double(num_texels) / double(num_judged);
        };
        return GatherHitCount::Rows{of_all(hits), of_all(glossy)};
    };
    GatherHitCount count;
    count.irradiance = expected([](GatherRays& rays, std::size_t i, const TracedRow& row) {
        static_cast<void>(rays.trace_irradiance(i, row));
    });
    for (const ViewDirections& towards : views) {
        const auto view = std::size_t(&towards - views.data());
        count.lobes.push_back(expected([&](GatherRays& rays, std::size_t i, const TracedRow& row) {
            if (towards[i].squaredNorm() > 0) rays.trace_lobe(i, view, towards[i], row);
        }));
    }
    return count;
}

}  // namespace patina
