#include "patina/scan/sensor.h"

#include "patina/base/parallel.h"
#include "patina/base/random.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// Radiance that an integer image stores as its largest value: white lies at half of it, highlights
// above.
constexpr double kIntegerWhite = 2.0;

}  // namespace

void add_noise(const SensorNoise& noise,
               const Image& seen,
               std::uint64_t seed,
               std::uint64_t stream,
               Image& image) {
    const std::size_t num_pixels = seen.data.size();
    const auto channels = std::size_t(image.channels);
    parallel_for(num_pixels, [&](std::size_t pixel) {
        if (seen.data[pixel] == 0) return;
        Rng rng(seed, Pass::sensor_noise, stream * num_pixels + pixel);
        for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
            const double value = double(image.data[i]);
            const double variance = noise.read * noise.read + noise.gain * std::max(value, 0.0);
            image.data[i] = float(value + std::sqrt(variance) * rng.normal());
        }
    });
}

double sensor_exposure(int bits) { return bits == 0 ? 1.0 : 1.0 / kIntegerWhite; }

double rounding_stddev(int bits) {
    if (bits == 0) return 0;
    const double step = 1.0 / (std::ldexp(1.0, bits) - 1.0);
    return step / std::sqrt(12.0);
}

}  // namespace patina
