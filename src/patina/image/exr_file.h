// OpenEXR images: scan lines or tiles of the first part, at full resolution.
#pragma once

#include "patina/image/image_file.h"

#include <string>

namespace patina {

// Only the wanted channels are read, straight into the image. Both fail where the file is deep,
// cropped, or has integers or sub-sampled samples in a wanted channel, and where what they read of
// it is damaged: the size is in the header.
[[nodiscard]] Image read_exr(const Place& place);
[[nodiscard]] ImageSize read_exr_size(const Place& place);

// The bytes of a file of 32-bit floats, in blocks of 16 rows shortened by ZIP. image: one channel,
// named Y, or three, named R, G and B. Throws WorkFailed.
[[nodiscard]] std::string encode_exr(const Image& image);

}  // namespace patina
