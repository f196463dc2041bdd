// Closed triangle mesh of a solid given by its signed distance.
//
// Based on: Gibson. Constrained Elastic Surface Nets. MICCAI 1998. The elastic relaxation is
// replaced by Newton steps along the gradient, so that every vertex lies on the surface.
#pragma once

#include "patina/scan/implicit.h"
#include "patina/scene/mesh.h"

namespace patina {

struct SurfaceNetsOptions {
    Bounds bounds;        // the solid lies inside, at least two cells away [length]
    double cell = 0.001;  // edge of the cubic cells [length], > 0
};

// What `distance` returns is at most this many times the Euclidean distance to the surface [-];
// smaller values are fine.
inline constexpr double kMaxDistanceRatio = 1.5;

// One vertex per cell that the surface crosses, two triangles per crossed grid edge; smooth normals
// from the gradient. Every edge belongs to exactly two triangles: where the samples leave that open
// (a face of a cell whose inside corners lie across from each other), the solid is thickened by one
// sample.
[[nodiscard]] Mesh surface_nets(const SignedDistance& distance, const SurfaceNetsOptions& options);

}  // namespace patina
