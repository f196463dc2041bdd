// A float image, and the reading and writing of image files.
//
// Each kind of file has a reader of its own, exr_file.h and so on; image_io.cpp chooses among them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace patina {

// Interleaved, row-major, row 0 at the top.
struct Image {
    Image() = default;
    Image(int image_width, int image_height, int image_channels, float value = 0)
        : width(image_width),
          height(image_height),
          channels(image_channels),
          data(std::size_t(image_width) * std::size_t(image_height) * std::size_t(image_channels),
               value) {}

    [[nodiscard]] std::size_t index(int x, int y, int channel = 0) const {
        return (std::size_t(y) * std::size_t(width) + std::size_t(x)) * std::size_t(channels) +
               std::size_t(channel);
    }
    [[nodiscard]] float at(int x, int y, int channel = 0) const {
        return data[index(x, y, channel)];
    }
    [[nodiscard]] float& at(int x, int y, int channel = 0) { return data[index(x, y, channel)]; }
    [[nodiscard]] bool empty() const { return data.empty(); }

    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> data;
};

// How the values of a file were stored.
enum class SampleKind { unsigned8, unsigned16, floating };

struct StoredImage {
    Image image;  // integer samples divided by 2^bits - 1, float samples as they are
    SampleKind kind = SampleKind::floating;
};

// Reads EXR, PNG, TIFF or PFM. Channels come in the order R, G, B (by name where the file names
// them; a single channel stays one); alpha is dropped.
// Throws Error(path, field, ...) when the file is missing, truncated or of a kind not understood.
// field: where the caller found the name of the file, for the message.
[[nodiscard]] StoredImage read_image(const std::filesystem::path& path,
                                     const std::string& field = "");

// Width, height and channels (alpha not counted) from the header alone. The same errors.
struct ImageSize {
    int width = 0;
    int height = 0;
    int channels = 0;
};
[[nodiscard]] ImageSize read_image_size(const std::filesystem::path& path,
                                        const std::string& field = "");

// 32-bit float OpenEXR, channels named R, G, B (three) or Y (one); no dates inside, so equal images
// give equal bytes. Written to a temporary name and renamed. Throws WorkFailed.
void write_exr(const std::filesystem::path& path, const Image& image);
// PNG of 8 or 16 bits; values are clamped to [0, 1] and rounded to nearest.
void write_png(const std::filesystem::path& path, const Image& image, int bits = 8);
// 32-bit float PFM, little endian.
void write_pfm(const std::filesystem::path& path, const Image& image);
// The bytes of an 8-bit PNG, for pages that carry their pictures inside.
[[nodiscard]] std::string encode_png(const Image& image);

}  // namespace patina
