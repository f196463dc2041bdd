// What the readers of image files share: where an error points to, the limits on sizes, and which
// channels of a file are wanted.
#pragma once

#include "patina/image/image.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace patina {

inline constexpr const char* kKindsUnderstood = "an OpenEXR, PNG, TIFF or PFM image";

// What goes into an error: the file, and where the caller found its name.
struct Place {
    const std::filesystem::path& path;
    const std::string& field;

    [[noreturn]] void fail(const std::string& problem, const std::string& expected) const;
    // message: what the library said; it may be of many lines, or empty.
    [[noreturn]] void fail_to_open(const std::string& message) const;
    [[noreturn]] void fail_as_damaged(const std::string& message) const;
    [[noreturn]] void fail_for_type(const std::string& type) const;
    [[noreturn]] void fail_for_depth() const;
    [[noreturn]] void fail_for_crop() const;
};

// Fails unless there are pixels, and no more samples than any image needs.
void check_size(std::int64_t width, std::int64_t height, std::size_t channels, const Place& place);

// Channels of the first layer that has all of R, G and B; else the luminance; else the only one but
// for alpha. names: of all channels, "layer.R" or "R". Returns indices into names, in the order R,
// G, B or one. Fails where there is no such choice.
[[nodiscard]] std::vector<int> wanted_channels(const std::vector<std::string>& names,
                                               const Place& place);

// Picks the wanted channels from pixels that interleave num_channels samples. white: the sample
// that becomes 1. out: wanted channels of one pixel after the other.
template <typename Sample>
void pick_samples(std::span<const Sample> samples,
                  int num_channels,
                  std::span<const int> wanted,
                  float white,
                  float* out) {
    for (std::size_t pixel = 0; pixel < samples.size(); pixel += std::size_t(num_channels)) {
        for (const int channel : wanted) {
            *out++ = static_cast<float>(samples[pixel + std::size_t(channel)]) / white;
        }
    }
}

}  // namespace patina
