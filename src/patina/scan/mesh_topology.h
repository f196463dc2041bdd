// Counts that tell whether a mesh is a closed surface; for tests.
#pragma once

#include "patina/scene/mesh.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

namespace patina {

struct MeshTopology {
    std::size_t num_edges = 0;
    std::size_t num_open_edges = 0;  // not run through exactly once in each direction
    // Vertices - edges + triangles: 2 per closed piece without holes, 0 for a torus.
    long euler_characteristic = 0;
};

[[nodiscard]] inline MeshTopology mesh_topology(const Mesh& mesh) {
    // Per edge: how often it is run through upwards and downwards in vertex numbers.
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> edges;
    for (const Triangle& triangle : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = triangle[i];
            const std::uint32_t b = triangle[(i + 1) % 3];
            auto& [up, down] = edges[{std::min(a, b), std::max(a, b)}];
            (a < b ? up : down) += 1;
        }
    }
    MeshTopology topology;
    topology.num_edges = edges.size();
    for (const auto& [edge, count] : edges) {
        if (count != std::pair(1, 1)) ++topology.num_open_edges;
    }
    topology.euler_characteristic =
        long(mesh.positions.size()) - long(edges.size()) + long(mesh.triangles.size());
    return topology;
}

}  // namespace patina
