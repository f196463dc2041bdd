#include "patina/image/png_check.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace patina {
namespace {

constexpr std::size_t kSignatureBytes = 8;
constexpr std::size_t kLengthBytes = 4;
constexpr std::size_t kTypeBytes = 4;
constexpr std::size_t kSumBytes = 4;

constexpr std::array<std::uint32_t, 256> make_table() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
        std::uint32_t c = n;
        for (int bit = 0; bit < 8; ++bit) c = (c & 1u) != 0 ? 0xedb88320u ^ (c >> 1) : c >> 1;
        table[n] = c;
    }
    return table;
}

std::uint32_t check_sum(std::string_view bytes) {
    static constexpr std::array<std::uint32_t, 256> kTable = make_table();
    std::uint32_t c = 0xffffffffu;
    for (const char byte : bytes) {
        c = kTable[(c ^ static_cast<unsigned char>(byte)) & 0xffu] ^ (c >> 8);
    }
    return ~c;
}

std::uint32_t load_u32(std::string_view bytes) {
    std::uint32_t value = 0;
    for (const char byte : bytes.substr(0, 4))
        value = value << 8 | static_cast<unsigned char>(byte);
    return value;
}

}  // namespace

bool is_whole_png(std::string_view contents) {
    if (contents.size() < kSignatureBytes) return false;
    contents.remove_prefix(kSignatureBytes);
    while (contents.size() >= kLengthBytes + kTypeBytes + kSumBytes) {
        const std::size_t length = load_u32(contents);
        contents.remove_prefix(kLengthBytes);
        if (length > contents.size() - kTypeBytes - kSumBytes) return false;
        const std::string_view summed = contents.substr(0, kTypeBytes + length);
        contents.remove_prefix(summed.size());
        if (load_u32(contents) != check_sum(summed)) return false;
        contents.remove_prefix(kSumBytes);
        if (summed.starts_with("IEND")) return true;
    }
    return false;
}

}  // namespace patina
