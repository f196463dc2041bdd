// TIFF images: strips or tiles, samples of a pixel together or in planes, gray, RGB or palette.
#pragma once

#include "patina/image/image_file.h"

namespace patina {

// Unsigned integers of up to 8 or 16 bits, and floats of 16, 32 and 64 bits; what lies beside gray
// or RGB is dropped. The first image of the file counts. Both fail where the file is of another
// colour space, and where what they read of it is damaged: the size is in the header.
[[nodiscard]] StoredImage read_tiff(const Place& place);
[[nodiscard]] ImageSize read_tiff_size(const Place& place);

}  // namespace patina
