// The gather graph in a file, so that the next estimate of the same geometry from the same cameras
// need not trace it.
//
// The file is a cache: it says what its graph was traced from, and one that does not fit, or that
// is not whole, is replaced.
#pragma once

#include "patina/base/hash.h"
#include "patina/base/parallel.h"
#include "patina/base/progress.h"
#include "patina/transport/gather_graph.h"

#include <filesystem>
#include <optional>

namespace patina {

// Of everything that trace_gather_graph() looks at, and of kGatherGraphVersion.
[[nodiscard]] Hash128 gather_graph_fingerprint(const Mesh& mesh,
                                               const TexelAtlas& atlas,
                                               std::span<const ViewDirections> views,
                                               const GatherOptions& options);

// Throws Error where the file could not be used: it holds something else than a graph, or is
// missing and cannot be written.
void check_gather_graph_file(const std::filesystem::path& path);

// Nothing where the file is missing, is not whole, or was traced from something else. Throws Error
// where it holds something else than a graph.
[[nodiscard]] std::optional<GatherGraph> read_gather_graph(const std::filesystem::path& path,
                                                           const Hash128& fingerprint);

// Throws WorkFailed when the disk refuses.
void write_gather_graph(const std::filesystem::path& path,
                        const Hash128& fingerprint,
                        const GatherGraph& graph);

// trace_gather_graph(), unless the file holds its result already; otherwise the file holds it in
// the end. The same graph in either case.
class KeptGatherGraph {
  public:
    // Reads or traces, and begins to write what was traced beside the caller's work: mesh, atlas
    // and views must outlive this. path: empty for a graph that no file keeps. Throws Error where
    // the file holds something else than a graph.
    KeptGatherGraph(std::filesystem::path path,
                    const Surface& surface,
                    const TexelAtlas& atlas,
                    std::span<const ViewDirections> views,
                    const GatherOptions& options,
                    Progress& progress);

    [[nodiscard]] const GatherGraph& graph() const { return graph_; }

    // Waits until the file is written, as the destructor does. Whatever keeps it from being written
    // is only warned about.
    void finish(Progress& progress);

  private:
    std::filesystem::path path_;
    GatherGraph graph_;
    std::optional<BesideWork> writing_;  // the last member: it reads the others
};

}  // namespace patina
