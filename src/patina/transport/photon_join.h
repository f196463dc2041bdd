// The photons of all threads as one.
#pragma once

#include "patina/transport/photon_paths.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace patina {

// A bounce, and how its photon came.
struct PhotonArrival {
    PhotonBounce bounce;
    Vec3f direction;    // unit, from the arrival back along the photon's way
    std::uint8_t half;  // of its path
};

// What one wave of photons did. Owns nothing.
struct PhotonBlock {
    std::span<const PhotonPaths::Path> paths;  // first_bounce counts within the block
    std::span<const PhotonArrival> arrivals;   // path by path
    std::span<const Vec3f> positions;          // per arrival; empty unless wanted
    std::uint64_t rays = 0;
};

// In the order of the blocks. The same for any number of threads.
[[nodiscard]] PhotonPaths join_blocks(std::span<const PhotonBlock> blocks, std::size_t num_texels);

}  // namespace patina
