// PNG images of 8 and 16 bits; fewer bits and palettes are read as 8.
#pragma once

#include "patina/image/image_file.h"

#include <string>

namespace patina {

// Samples as stored, no gamma applied; alpha is dropped. Both fail where the file is damaged.
[[nodiscard]] StoredImage read_png(const Place& place);
[[nodiscard]] ImageSize read_png_size(const Place& place);

// The bytes of a file of 8 or 16 bits; values are clamped to [0, 1] and rounded to nearest. image:
// one or three channels. Throws WorkFailed.
[[nodiscard]] std::string encode_png(const Image& image, int bits);

}  // namespace patina
