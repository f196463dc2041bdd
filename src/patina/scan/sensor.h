// The virtual sensor: noise, and the numbers that a file stores.
#pragma once

#include "patina/image/image.h"

#include <cstdint>
#include <filesystem>

namespace patina {

// Variance of a stored value p: read^2 + gain max(p, 0).
struct SensorNoise {
    double read = 0;  // standard deviation in darkness; >= 0
    double gain = 0;  // variance per p; >= 0
};

// Adds noise to every sample that `seen` (one channel) does not exclude. stream: images of
// different streams have independent noise.
void add_noise(const SensorNoise& noise,
               const Image& seen,
               std::uint64_t seed,
               std::uint64_t stream,
               Image& image);

// Stored value per radiance of images of so many bits; 1 for float images (bits 0).
[[nodiscard]] double sensor_exposure(int bits);

// Standard deviation that rounding to so many bits adds; 0 for float images.
[[nodiscard]] double rounding_stddev(int bits);

}  // namespace patina
