#include "patina/transport/gather_graph_file.h"

#include "patina/base/check.h"
#include "patina/base/error.h"
#include "patina/base/output_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <functional>
#include <numeric>
#include <string>
#include <string_view>
#include <system_error>

namespace patina {
namespace {

namespace fs = std::filesystem;

// Numbers lie in the file as in memory; in another order of bytes the version fits no more.
constexpr std::string_view kMagic = "patina graph\n";
constexpr std::size_t kPieceBytes = std::size_t(1) << 24;
static_assert(sizeof(GatherHit) == 6 * sizeof(float), "hits have no bytes between their fields");
static_assert(sizeof(GlossyHit) == 3 * sizeof(float), "hits have no bytes between their fields");

// What stands behind the magic. Behind it, in turn: hits and glossy hits of the irradiance and of
// every view [64 bits each]; for the irradiance and every view the hits of every texel [32 bits
// each] and the hits, and the same of the glossy hits; the hash of all this.
struct Header {
    std::uint64_t version = kGatherGraphVersion;
    Hash128 fingerprint{};
    std::uint64_t num_texels = 0;
    std::uint64_t num_views = 0;
    std::uint64_t num_rays = 0;
};
static_assert(sizeof(Header) == 6 * sizeof(std::uint64_t));

struct RowCounts {
    std::uint64_t hits = 0;
    std::uint64_t glossy = 0;
};

template <typename Values>
std::span<std::byte> bytes_of(Values& values) {
    return std::as_writable_bytes(std::span(values));
}

// Splits bytes into pieces.
template <typename Byte, typename Work>
void for_each_piece(std::span<Byte> bytes, const Work& work) {
    for (std::size_t begin = 0; begin < bytes.size(); begin += kPieceBytes) {
        work(bytes.subspan(begin, std::min(kPieceBytes, bytes.size() - begin)));
    }
}

class GraphReader {
  public:
    explicit GraphReader(const fs::path& path)
        : stream_(path, std::ios::binary), size_(fs::file_size(path)) {}

    // Nothing where the file is not one whole graph with this fingerprint.
    [[nodiscard]] std::optional<GatherGraph> read(const Hash128& fingerprint) {
        std::string magic(kMagic.size(), '\0');
        Header header;
        if (!read_bytes(std::as_writable_bytes(std::span(magic))) || magic != kMagic ||
            !read_bytes(std::as_writable_bytes(std::span(&header, 1))) ||
            header.version != kGatherGraphVersion || header.fingerprint != fingerprint) {
            return std::nullopt;
        }
        // Sizes are compared with that of the file before memory is taken for them.
        if (header.num_views >= size_ / sizeof(RowCounts)) return std::nullopt;
        const std::uint64_t bytes_of_texel =
            sizeof(float) + 2 * sizeof(std::uint32_t) * (header.num_views + 1);
        if (header.num_texels > size_ / bytes_of_texel) return std::nullopt;
        std::vector<RowCounts> counts(header.num_views + 1);
        if (!read_bytes(bytes_of(counts))) return std::nullopt;
        for (const RowCounts& count : counts) {
            if (count.hits > size_ / sizeof(GatherHit)) return std::nullopt;
            if (count.glossy > size_ / sizeof(GlossyHit)) return std::nullopt;
        }
        GatherGraph graph;
        graph.num_rays = header.num_rays;
        graph.backs_over_fronts.resize(header.num_texels);
        if (!read_bytes(bytes_of(graph.backs_over_fronts))) return std::nullopt;
        if (!read_rows(header.num_texels, counts[0], graph.irradiance)) return std::nullopt;
        for (std::size_t view = 0; view < header.num_views; ++view) {
            GatherRows& rows = graph.lobes.emplace_back();
            if (!read_rows(header.num_texels, counts[view + 1], rows)) return std::nullopt;
        }
        const Hash128 hash = hasher_.hash();
        Hash128 stored{};
        if (!read_bytes(std::as_writable_bytes(std::span(stored))) || stored != hash ||
            stream_.peek() != std::ifstream::traits_type::eof()) {
            return std::nullopt;
        }
        return graph;
    }

  private:
    [[nodiscard]] bool read_bytes(std::span<std::byte> bytes) {
        for_each_piece(bytes, [&](std::span<std::byte> piece) {
            throw_if_interrupted();
            stream_.read(reinterpret_cast<char*>(piece.data()), std::streamsize(piece.size()));
            hasher_.add(piece);
        });
        return bool(stream_);
    }

    [[nodiscard]] bool read_rows(std::size_t num_texels, const RowCounts& count, GatherRows& rows) {
        return read_lists(num_texels, count.hits, rows.begin, rows.hits) &&
               read_lists(num_texels, count.glossy, rows.glossy_begin, rows.glossy);
    }

    template <typename Hit>
    [[nodiscard]] bool read_lists(std::size_t num_texels,
                                  std::uint64_t num_hits,
                                  std::vector<std::size_t>& begin,
                                  LargeVector<Hit>& hits) {
        std::vector<std::uint32_t> counts(num_texels);
        if (!read_bytes(bytes_of(counts))) return false;
        begin.assign(num_texels + 1, 0);
        std::inclusive_scan(
            counts.begin(), counts.end(), begin.begin() + 1, std::plus<>(), std::size_t(0));
        if (begin.back() != num_hits) return false;
        hits.resize(num_hits);
        return read_bytes(bytes_of(hits));
    }

    std::ifstream stream_;
    std::uint64_t size_;
    Hasher hasher_;
};

class GraphWriter {
  public:
    explicit GraphWriter(const fs::path& path) : file_(path) {}

    void write(const Hash128& fingerprint, const GatherGraph& graph) {
        PATINA_CHECK(!graph.irradiance.begin.empty());
        write_bytes(std::as_bytes(std::span(kMagic)));
        const Header header{kGatherGraphVersion,
                            fingerprint,
                            graph.irradiance.begin.size() - 1,
                            graph.lobes.size(),
                            graph.num_rays};
        write_bytes(std::as_bytes(std::span(&header, 1)));
        const auto count = [](const GatherRows& rows) {
            return RowCounts{rows.hits.size(), rows.glossy.size()};
        };
        std::vector<RowCounts> counts = {count(graph.irradiance)};
        for (const GatherRows& rows : graph.lobes) counts.push_back(count(rows));
        write_bytes(bytes_of(counts));
        write_bytes(std::as_bytes(std::span(graph.backs_over_fronts)));
        write_rows(graph.irradiance);
        for (const GatherRows& rows : graph.lobes) write_rows(rows);
        const Hash128 hash = hasher_.hash();
        write_bytes(std::as_bytes(std::span(hash)));
        file_.commit();
    }

  private:
    // Whoever stops the program waits for the rest, so that the graph is not lost.
    void write_bytes(std::span<const std::byte> bytes) {
        for_each_piece(bytes, [&](std::span<const std::byte> piece) {
            hasher_.add(piece);
            file_.write(piece);
        });
    }

    void write_rows(const GatherRows& rows) {
        write_lists(rows.begin, rows.hits);
        write_lists(rows.glossy_begin, rows.glossy);
    }

    template <typename Hit>
    void write_lists(const std::vector<std::size_t>& begin, const LargeVector<Hit>& hits) {
        std::vector<std::uint32_t> counts(begin.size() - 1);
        for (std::size_t i = 0; i < counts.size(); ++i) {
            counts[i] = std::uint32_t(begin[i + 1] - begin[i]);
        }
        write_bytes(bytes_of(counts));
        write_bytes(std::as_bytes(std::span(hits)));
    }

    OutputFile file_;
    Hasher hasher_;
};

// Files that are no graph are the user's. The beginning of one is what a full disk left of it.
void refuse_other_files(const fs::path& path) {
    const std::string expected =
        "a graph that 'patina estimate' wrote, or --graph with another name";
    if (!fs::exists(path)) return;
    if (!fs::is_regular_file(path)) throw Error(path.string(), "", "is not a file", expected);
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw Error(path.string(), "", "cannot be read", expected);
    std::string begin(kMagic.size(), '\0');
    stream.read(begin.data(), std::streamsize(begin.size()));
    begin.resize(std::size_t(stream.gcount()));
    if (!kMagic.starts_with(begin)) throw Error(path.string(), "", "is no gather graph", expected);
}

// Adds the number of elements too, so that neighbouring lists cannot trade elements.
template <typename Value>
void add_list(const std::vector<Value>& values, Hasher& hasher) {
    hasher.add(std::uint64_t(values.size()));
    hasher.add(std::as_bytes(std::span(values)));
}

void add_atlas(const TexelAtlas& atlas, Hasher& hasher) {
    hasher.add(atlas.width);
    hasher.add(atlas.height);
    hasher.add(std::uint64_t(atlas.texels.size()));
    for (const Texel& texel : atlas.texels) {
        const SurfacePoint& point = texel.point;
        for (const Vec3* vector : {&point.position, &point.geometric_normal, &point.normal}) {
            hasher.add(std::as_bytes(std::span(vector, 1)));
        }
    }
    add_list(atlas.cell_owner, hasher);
    add_list(atlas.neighbor_begin, hasher);
    add_list(atlas.neighbors, hasher);
}

}  // namespace

Hash128 gather_graph_fingerprint(const Mesh& mesh,
                                 const TexelAtlas& atlas,
                                 std::span<const ViewDirections> views,
                                 const GatherOptions& options) {
    Hasher hasher;
    hasher.add(kGatherGraphVersion);
    add_list(mesh.positions, hasher);
    add_list(mesh.normals, hasher);
    add_list(mesh.uvs, hasher);
    add_list(mesh.triangles, hasher);
    add_atlas(atlas, hasher);
    hasher.add(std::uint64_t(views.size()));
    for (const ViewDirections& view : views) add_list(view, hasher);
    hasher.add(options.rays);
    hasher.add(options.lobe_rays);
    hasher.add(options.lobe_spread);
    hasher.add(options.seed);
    return hasher.hash();
}

void check_gather_graph_file(const fs::path& path) {
    refuse_other_files(path);
    if (fs::exists(path)) return;
    try {
        const OutputFile probe(path);
    } catch (const WorkFailed&) {
        throw Error(path.string(), "", "cannot be written", "a writable place");
    }
}

std::optional<GatherGraph> read_gather_graph(const fs::path& path, const Hash128& fingerprint) {
    refuse_other_files(path);
    if (!fs::exists(path)) return std::nullopt;
    return GraphReader(path).read(fingerprint);
}

void write_gather_graph(const fs::path& path,
                        const Hash128& fingerprint,
                        const GatherGraph& graph) {
    GraphWriter(path).write(fingerprint, graph);
}

KeptGatherGraph::KeptGatherGraph(fs::path path,
                                 const Surface& surface,
                                 const TexelAtlas& atlas,
                                 std::span<const ViewDirections> views,
                                 const GatherOptions& options,
                                 Progress& progress)
    : path_(std::move(path)) {
    std::optional<Hash128> fingerprint;
    if (!path_.empty() && fs::exists(path_)) {
        progress.begin_stage("gather graph");
        fingerprint = gather_graph_fingerprint(*surface.mesh, atlas, views, options);
        if (std::optional<GatherGraph> graph = read_gather_graph(path_, *fingerprint)) {
            progress.end_stage("read from " + path_.string());
            graph_ = std::move(*graph);
            return;
        }
        progress.end_stage("another in " + path_.string());
    }
    graph_ = trace_gather_graph(surface, atlas, views, options, progress);
    if (path_.empty()) return;
    progress.begin_stage("gather graph");
    writing_.emplace([this, fingerprint, mesh = surface.mesh, &atlas, views, options] {
        write_gather_graph(
            path_,
            fingerprint ? *fingerprint : gather_graph_fingerprint(*mesh, atlas, views, options),
            graph_);
    });
    progress.end_stage("to be kept in " + path_.string());
}

void KeptGatherGraph::finish(Progress& progress) {
    if (!writing_) return;
    progress.begin_stage("gather graph");
    try {
        writing_->wait();
        // It may have been deleted since.
        std::error_code failure;
        const auto size = fs::file_size(path_, failure);
        progress.end_stage(failure ? ""
                                   : fmt::format("written, {:.1f} MiB", double(size) / (1 << 20)));
    } catch (const std::exception& failure) {
        progress.end_stage();
        progress.note(
            fmt::format("warning: {}; the next estimate traces it again", failure.what()));
    }
    writing_.reset();
}

}  // namespace patina
