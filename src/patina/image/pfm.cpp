#include "patina/image/pfm.h"

#include "patina/base/check.h"
#include "patina/base/error.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>

namespace patina {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// The next word of the header, with what stands after it; exactly one white character ends a word.
std::string_view take_word(std::string_view contents, std::size_t& offset) {
    while (offset < contents.size() && is_space(contents[offset])) ++offset;
    const std::size_t begin = offset;
    while (offset < contents.size() && !is_space(contents[offset])) ++offset;
    const std::string_view word = contents.substr(begin, offset - begin);
    if (offset < contents.size()) ++offset;
    return word;
}

template <typename Number>
bool parse_number(std::string_view word, Number& number) {
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
    return code == std::errc() && end == word.data() + word.size();
}

std::uint32_t load_u32(const char* bytes, bool big_endian) {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) {
        const int shift = 8 * (big_endian ? 3 - i : i);
        value |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << shift;
    }
    return value;
}

}  // namespace

PfmHeader parse_pfm_header(std::string_view contents,
                           const std::filesystem::path& path,
                           const std::string& field) {
    PfmHeader header;
    std::size_t offset = 0;
    const std::string_view magic = take_word(contents, offset);
    const std::string_view width = take_word(contents, offset);
    const std::string_view height = take_word(contents, offset);
    const std::string_view scale = take_word(contents, offset);
    header.size.channels = magic == "PF" ? 3 : 1;
    double scale_value = 0;
    const bool valid = (magic == "PF" || magic == "Pf") && parse_number(width, header.size.width) &&
                       header.size.width > 0 && parse_number(height, header.size.height) &&
                       header.size.height > 0 && parse_number(scale, scale_value) &&
                       scale_value != 0;
    if (!valid) {
        throw Error(path.string(),
                    field,
                    "has no valid PFM header",
                    "PF or Pf, width, height and a scale other than 0");
    }
    header.big_endian = scale_value > 0;
    header.data_offset = offset;
    return header;
}

Image decode_pfm(std::string_view contents,
                 const std::filesystem::path& path,
                 const std::string& field) {
    const PfmHeader header = parse_pfm_header(contents, path, field);
    const auto [width, height, channels] = header.size;
    const std::size_t row_samples = std::size_t(width) * std::size_t(channels);
    const std::size_t available = contents.size() - header.data_offset;
    if (available / sizeof(float) / row_samples < std::size_t(height)) {
        throw Error(path.string(),
                    field,
                    "is truncated",
                    fmt::format("{} x {} x {} samples of 4 bytes", width, height, channels));
    }
    Image image(width, height, channels);
    const char* bytes = contents.data() + header.data_offset;
    for (int y = height - 1; y >= 0; --y) {
        float* row = &image.data[image.index(0, y)];
        for (std::size_t i = 0; i < row_samples; ++i, bytes += sizeof(float)) {
            row[i] = std::bit_cast<float>(load_u32(bytes, header.big_endian));
        }
    }
    return image;
}

std::string encode_pfm(const Image& image) {
    PATINA_CHECK(image.channels == 1 || image.channels == 3);
    std::string contents = fmt::format(
        "{}\n{} {}\n-1.0\n", image.channels == 3 ? "PF" : "Pf", image.width, image.height);
    const std::size_t row_samples = std::size_t(image.width) * std::size_t(image.channels);
    contents.reserve(contents.size() + image.data.size() * sizeof(float));
    for (int y = image.height - 1; y >= 0; --y) {
        const float* row = &image.data[image.index(0, y)];
        for (std::size_t i = 0; i < row_samples; ++i) {
            const auto bits = std::bit_cast<std::uint32_t>(row[i]);
            for (int shift = 0; shift < 32; shift += 8) {
                contents.push_back(static_cast<char>((bits >> shift) & 0xffu));
            }
        }
    }
    return contents;
}

}  // namespace patina
