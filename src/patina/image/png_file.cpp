#include "patina/image/png_file.h"

#include "patina/base/check.h"
#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/image/png_check.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

// libpng reports an error by a jump out of its call, back to setjmp. The jump runs no destructors:
// functions that call setjmp, and the callbacks below, hold plain values only.

namespace patina {
namespace {

// What libpng said last, cut to what fits.
using Message = std::array<char, 200>;

[[noreturn]] void note_error(png_structp png, png_const_charp text) {
    auto* message = static_cast<Message*>(png_get_error_ptr(png));
    std::snprintf(message->data(), message->size(), "%s", text);
    png_longjmp(png, 1);
}

void ignore_warning(png_structp /*png*/, png_const_charp /*text*/) {}

// Takes the next bytes from the std::string_view of what is left.
void take_bytes(png_structp png, png_bytep bytes, std::size_t size) {
    auto* rest = static_cast<std::string_view*>(png_get_io_ptr(png));
    if (size > rest->size()) png_error(png, "the file ends too early");
    std::memcpy(bytes, rest->data(), size);
    rest->remove_prefix(size);
}

// Appends to a std::string.
void append_bytes(png_structp png, png_bytep bytes, std::size_t size) {
    auto* contents = static_cast<std::string*>(png_get_io_ptr(png));
    bool stored = true;
    try {
        contents->append(bytes, bytes + size);
    } catch (const std::exception&) {
        stored = false;  // exceptions must not pass through libpng
    }
    if (!stored) png_error(png, "out of memory");
}

void no_flush(png_structp /*png*/) {}

struct Header {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    int channels = 0;  // with alpha
    int bits = 0;
    bool has_offset = false;
};

// A file that is read from memory.
class Reader {
  public:
    explicit Reader(std::string_view contents) : rest_(contents) {
        png_ =
            png_create_read_struct(PNG_LIBPNG_VER_STRING, &message_, &note_error, &ignore_warning);
        if (png_ != nullptr) info_ = png_create_info_struct(png_);
        if (info_ == nullptr) {
            png_destroy_read_struct(&png_, nullptr, nullptr);
            throw WorkFailed("cannot start libpng");
        }
        png_set_read_fn(png_, &rest_, &take_bytes);
    }
    ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    // False where libpng gave up; then message() says why.
    [[nodiscard]] bool read_header(Header& header) {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        png_read_info(png_, info_);
        // Gray below 8 bits, palettes and transparent colours become samples and alpha.
        png_set_expand(png_);
        if constexpr (std::endian::native == std::endian::little) png_set_swap(png_);
        png_set_interlace_handling(png_);
        png_read_update_info(png_, info_);
        header.width = png_get_image_width(png_, info_);
        header.height = png_get_image_height(png_, info_);
        header.channels = png_get_channels(png_, info_);
        header.bits = png_get_bit_depth(png_, info_);
        header.has_offset =
            png_get_x_offset_pixels(png_, info_) != 0 || png_get_y_offset_pixels(png_, info_) != 0;
        return true;
    }
    // Likewise. rows: where each row begins.
    [[nodiscard]] bool read_rows(png_bytepp rows) {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        png_read_image(png_, rows);
        png_read_end(png_, nullptr);
        return true;
    }
    [[nodiscard]] const char* message() const { return message_.data(); }

  private:
    std::string_view rest_;
    Message message_{};
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

// A file that is written to memory.
class Writer {
  public:
    Writer() {
        png_ =
            png_create_write_struct(PNG_LIBPNG_VER_STRING, &message_, &note_error, &ignore_warning);
        if (png_ != nullptr) info_ = png_create_info_struct(png_);
        if (info_ == nullptr) {
            png_destroy_write_struct(&png_, nullptr);
            throw WorkFailed("cannot start libpng");
        }
        png_set_write_fn(png_, &contents_, &append_bytes, &no_flush);
    }
    ~Writer() { png_destroy_write_struct(&png_, &info_); }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    // False where libpng gave up; then message() says why.
    [[nodiscard]] bool write(const Header& header, png_bytepp rows) {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        png_set_IHDR(png_,
                     info_,
                     header.width,
                     header.height,
                     header.bits,
                     header.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY,
                     PNG_INTERLACE_NONE,
                     PNG_COMPRESSION_TYPE_DEFAULT,
                     PNG_FILTER_TYPE_DEFAULT);
        // Quicker than what libpng takes by itself, Z_FILTERED, and hardly larger.
        constexpr int kDefaultStrategy = 0;  // Z_DEFAULT_STRATEGY of zlib
        png_set_compression_strategy(png_, kDefaultStrategy);
        png_write_info(png_, info_);
        if constexpr (std::endian::native == std::endian::little) png_set_swap(png_);
        png_write_image(png_, rows);
        png_write_end(png_, nullptr);
        return true;
    }
    [[nodiscard]] const char* message() const { return message_.data(); }
    [[nodiscard]] std::string take() { return std::move(contents_); }

  private:
    std::string contents_;
    Message message_{};
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

template <typename Sample>
constexpr float kWhite = std::numeric_limits<Sample>::max();

// Where each row of the samples begins.
template <typename Sample>
std::vector<png_bytep> row_starts(std::vector<Sample>& samples, std::size_t height) {
    std::vector<png_bytep> rows(height);
    const std::size_t row_samples = samples.size() / height;
    for (std::size_t y = 0; y < height; ++y) {
        rows[y] = reinterpret_cast<png_bytep>(samples.data() + y * row_samples);
    }
    return rows;
}

// Colours come before alpha.
int num_colors(const Header& header) { return header.channels >= 3 ? 3 : 1; }

Header read_header(Reader& reader, const Place& place) {
    Header header;
    if (!reader.read_header(header)) place.fail_to_open(reader.message());
    if (header.has_offset) place.fail_for_crop();
    check_size(header.width, header.height, std::size_t(header.channels), place);
    return header;
}

template <typename Sample>
Image read_samples(Reader& reader, const Header& header, const Place& place) {
    std::vector<Sample> samples(std::size_t{header.width} * header.height *
                                std::size_t(header.channels));
    std::vector<png_bytep> rows = row_starts(samples, header.height);
    if (!reader.read_rows(rows.data())) place.fail_as_damaged(reader.message());
    Image image(
        static_cast<int>(header.width), static_cast<int>(header.height), num_colors(header));
    std::array<int, 3> wanted{};
    std::iota(wanted.begin(), wanted.end(), 0);
    pick_samples<Sample>(samples,
                         header.channels,
                         std::span(wanted).first(std::size_t(image.channels)),
                         kWhite<Sample>,
                         image.data.data());
    return image;
}

// libpng takes a file for complete once it has all rows.
std::string read_whole(const Place& place) {
    std::string contents = read_file(place.path);
    if (!is_whole_png(contents)) {
        place.fail("is damaged or truncated", "a complete PNG image");
    }
    return contents;
}

template <typename Sample>
std::string encode(const Image& image) {
    std::vector<Sample> samples(image.data.size());
    std::transform(image.data.begin(), image.data.end(), samples.begin(), [](float value) {
        // NaN becomes black.
        const float clamped = value > 0 ? std::min(value, 1.0f) : 0.0f;
        return static_cast<Sample>(std::lround(clamped * kWhite<Sample>));
    });
    Header header;
    header.width = std::uint32_t(image.width);
    header.height = std::uint32_t(image.height);
    header.channels = image.channels;
    header.bits = std::numeric_limits<Sample>::digits;
    std::vector<png_bytep> rows = row_starts(samples, header.height);
    Writer writer;
    if (!writer.write(header, rows.data())) {
        throw WorkFailed(fmt::format("cannot encode an image as png: {}", writer.message()));
    }
    return writer.take();
}

}  // namespace

StoredImage read_png(const Place& place) {
    const std::string contents = read_whole(place);
    Reader reader(contents);
    const Header header = read_header(reader, place);
    if (header.bits == 16) {
        return {read_samples<std::uint16_t>(reader, header, place), SampleKind::unsigned16};
    }
    return {read_samples<std::uint8_t>(reader, header, place), SampleKind::unsigned8};
}

ImageSize read_png_size(const Place& place) {
    const std::string contents = read_whole(place);
    Reader reader(contents);
    const Header header = read_header(reader, place);
    return {static_cast<int>(header.width), static_cast<int>(header.height), num_colors(header)};
}

std::string encode_png(const Image& image, int bits) {
    PATINA_CHECK(!image.empty() && (image.channels == 1 || image.channels == 3));
    PATINA_CHECK(bits == 8 || bits == 16);
    return bits == 8 ? encode<std::uint8_t>(image) : encode<std::uint16_t>(image);
}

}  // namespace patina
