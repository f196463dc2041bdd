// PFM images, as Paul Debevec's HDR Shop wrote them: a text header, then rows of floats, bottom
// first.
#pragma once

#include "patina/image/image.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace patina {

// What the header says, and where the samples begin.
struct PfmHeader {
    ImageSize size;
    bool big_endian = false;
    std::size_t data_offset = 0;  // [bytes]
};

// contents: the file, or at least its first kPfmHeaderBytes. Throws Error(path, field, ...).
inline constexpr std::size_t kPfmHeaderBytes = 128;
[[nodiscard]] PfmHeader parse_pfm_header(std::string_view contents,
                                         const std::filesystem::path& path,
                                         const std::string& field);

// contents: the whole file. Throws Error(path, field, ...) where it is truncated or no PFM.
[[nodiscard]] Image decode_pfm(std::string_view contents,
                               const std::filesystem::path& path,
                               const std::string& field);

// Little endian, scale 1. image: one or three channels.
[[nodiscard]] std::string encode_pfm(const Image& image);

}  // namespace patina
