// The photons of all threads as one.
#pragma once

#include "patina/transport/photon_paths.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patina {

// What one wave of photons did.
struct PhotonBlock {
    std::vector<PhotonPaths::Path> paths;  // first_bounce counts within the block
    std::vector<PhotonBounce> bounces;
    std::vector<Vec3f> directions;     // per bounce, from the arrival back along the photon's way
    std::vector<std::uint8_t> halves;  // per bounce, of its path
    std::vector<Vec3f> positions;      // per bounce, of the arrival; empty unless wanted
    std::uint64_t rays = 0;
};

// In the order of the blocks, which are emptied. The same for any number of threads.
[[nodiscard]] PhotonPaths join_blocks(std::vector<PhotonBlock>& blocks, std::size_t num_texels);

}  // namespace patina
