#include "patina/image/tiff_file.h"

#include "patina/image/packed_samples.h"

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <utility>

namespace patina {
namespace {

// The largest piece of memory that libtiff may ask for: 64 bits for each sample of the largest
// image [bytes].
constexpr tmsize_t kMaxMemory = tmsize_t{1} << 32;

// The first error of libtiff, cut to what fits. Plain memory, for no exception may pass through
// libtiff.
using Message = std::array<char, 200>;

int note_error(
    TIFF* /*tiff*/, void* data, const char* /*module*/, const char* format, va_list list) {
    auto* message = static_cast<Message*>(data);
    if (message->front() == '\0') std::vsnprintf(message->data(), message->size(), format, list);
    return 1;  // not to be printed as well
}

int ignore_warning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

struct FreeOptions {
    void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
};
struct Close {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using Handle = std::unique_ptr<TIFF, Close>;

// message: filled by later calls too, so it must outlive the handle.
Handle open_tiff(Message& message, const Place& place) {
    const std::unique_ptr<TIFFOpenOptions, FreeOptions> options(TIFFOpenOptionsAlloc());
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), kMaxMemory);
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), &note_error, &message);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), &ignore_warning, nullptr);
    // "m": a file that shrinks while it is mapped to memory would end the process.
    Handle tiff(TIFFOpenExt(place.path.c_str(), "rm", options.get()));
    if (!tiff) place.fail_to_open(message.data());
    message.fill('\0');
    return tiff;
}

template <typename Value>
Value field(const Handle& tiff, std::uint32_t tag) {
    Value value{};
    TIFFGetFieldDefaulted(tiff.get(), tag, &value);
    return value;
}

// What the file says of itself.
struct Header {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    // Strips are blocks too, as wide as the image; the last is shorter.
    bool is_tiled = false;
    std::uint32_t block_width = 0;
    std::uint32_t block_height = 0;
    std::uint16_t num_samples = 0;  // of a pixel
    SampleType type;
    bool is_separate = false;  // one plane for each sample of a pixel
    bool is_inverted = false;  // 0 is white
    bool has_palette = false;
    std::array<const std::uint16_t*, 3> palette{};  // memory of libtiff
    std::vector<int> wanted;  // samples of a pixel, or 0, 1 and 2 of the palette

    [[nodiscard]] SampleKind kind() const {
        if (type.is_floating) return SampleKind::floating;
        return type.bits <= 8 || has_palette ? SampleKind::unsigned8 : SampleKind::unsigned16;
    }
};

void check_depth_and_crop(const Handle& tiff, const Header& header, const Place& place) {
    if (field<std::uint32_t>(tiff, TIFFTAG_IMAGEDEPTH) > 1) place.fail_for_depth();
    std::uint32_t full_width = 0;
    std::uint32_t full_height = 0;
    if (TIFFGetField(tiff.get(), TIFFTAG_PIXAR_IMAGEFULLWIDTH, &full_width) != 1 ||
        TIFFGetField(tiff.get(), TIFFTAG_PIXAR_IMAGEFULLLENGTH, &full_height) != 1) {
        return;  // a position alone, such as that on a page, says nothing of a crop
    }
    if (full_width != header.width || full_height != header.height ||
        field<float>(tiff, TIFFTAG_XPOSITION) != 0 || field<float>(tiff, TIFFTAG_YPOSITION) != 0) {
        place.fail_for_crop();
    }
}

void read_sample_type(const Handle& tiff, Header& header, const Place& place) {
    constexpr std::array kFloatBits = {16, 32, 64};
    constexpr std::array kUnsignedBits = {1, 2, 4, 6, 8, 10, 12, 14, 16};
    const auto is_among = [&](const auto& bits) {
        return std::find(bits.begin(), bits.end(), header.type.bits) != bits.end();
    };
    header.type.bits = field<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE);
    std::string name;
    switch (field<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT)) {
        case SAMPLEFORMAT_UINT:
        case SAMPLEFORMAT_VOID:
            if (is_among(kUnsignedBits)) return;
            name = "uint";
            break;
        case SAMPLEFORMAT_INT:
            name = "int";
            break;
        case SAMPLEFORMAT_IEEEFP:
            header.type.is_floating = true;
            if (is_among(kFloatBits)) return;
            name = "float";
            break;
        default:
            name = "complex";
    }
    place.fail_for_type(header.type.bits == 32 ? name
                                               : fmt::format("{}{}", name, header.type.bits));
}

// The samples of a pixel by name. Three or more begin with R, G and B whatever the colour space
// says: programs that store a stack of three do not agree on one.
std::vector<std::string> sample_names(const Handle& tiff, const Header& header, bool is_gray) {
    if (header.num_samples == 1) return {"Y"};
    std::vector<std::string> names = {"R", "G", "B"};
    names.resize(header.num_samples);
    for (std::size_t c = 3; c < names.size(); ++c) names[c] = fmt::format("channel{}", c);
    std::uint16_t num_extra = 0;
    const std::uint16_t* extra = nullptr;
    TIFFGetField(tiff.get(), TIFFTAG_EXTRASAMPLES, &num_extra, &extra);
    const std::size_t first = is_gray ? 1 : 3;
    for (std::size_t i = 0; i < num_extra && first + i < names.size(); ++i) {
        if (extra[i] != EXTRASAMPLE_UNSPECIFIED) names[first + i] = "A";
    }
    if (names.size() == 2 && names[1] == "A") names[0] = "Y";
    return names;
}

void read_palette(const Handle& tiff, Header& header, const Place& place) {
    std::array<std::uint16_t*, 3> palette{};
    const bool is_valid =
        header.num_samples == 1 && !header.type.is_floating &&
        std::has_single_bit(header.type.bits) &&
        TIFFGetField(tiff.get(), TIFFTAG_COLORMAP, &palette[0], &palette[1], &palette[2]) == 1;
    if (!is_valid) place.fail("has no valid palette", "one of at most 16 bits, without alpha");
    header.has_palette = true;
    header.palette = {palette[0], palette[1], palette[2]};
    header.wanted = {0, 1, 2};
}

void read_colours(const Handle& tiff, Header& header, const Place& place) {
    std::uint16_t photometric = header.num_samples == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB;
    TIFFGetField(tiff.get(), TIFFTAG_PHOTOMETRIC, &photometric);
    const auto compression = field<std::uint16_t>(tiff, TIFFTAG_COMPRESSION);
    if (TIFFIsCODECConfigured(compression) == 0) {
        place.fail_to_open(fmt::format("compression {} is not known", compression));
    }
    switch (photometric) {
        case PHOTOMETRIC_PALETTE:
            read_palette(tiff, header, place);
            return;
        case PHOTOMETRIC_MINISWHITE:
            header.is_inverted = !header.type.is_floating;
            break;
        case PHOTOMETRIC_MINISBLACK:
        case PHOTOMETRIC_RGB:
            break;
        case PHOTOMETRIC_YCBCR:
            // The usual colours of JPEG, which its decoder turns into RGB.
            if (compression == COMPRESSION_JPEG && header.num_samples == 3 && !header.is_separate &&
                TIFFSetField(tiff.get(), TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB) == 1) {
                break;
            }
            [[fallthrough]];
        default:
            place.fail(fmt::format("has colours of kind {}", photometric),
                       "a TIFF image of gray, RGB or a palette");
    }
    const bool is_gray =
        photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_MINISWHITE;
    header.wanted = wanted_channels(sample_names(tiff, header, is_gray), place);
}

void read_blocks(const Handle& tiff, Header& header, const Place& place) {
    header.is_tiled = TIFFIsTiled(tiff.get()) != 0;
    if (!header.is_tiled) {
        header.block_width = header.width;
        header.block_height =
            std::clamp(field<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP), 1u, header.height);
        return;
    }
    if (field<std::uint32_t>(tiff, TIFFTAG_TILEDEPTH) > 1) place.fail_for_depth();
    header.block_width = field<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH);
    header.block_height = field<std::uint32_t>(tiff, TIFFTAG_TILELENGTH);
    check_size(header.block_width, header.block_height, header.num_samples, place);
}

Header read_header(const Handle& tiff, const Place& place) {
    Header header;
    header.width = field<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH);
    header.height = field<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH);
    header.num_samples = field<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL);
    header.is_separate = header.num_samples > 1 &&
                         field<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG) == PLANARCONFIG_SEPARATE;
    check_depth_and_crop(tiff, header, place);
    check_size(header.width, header.height, header.num_samples, place);
    read_sample_type(tiff, header, place);
    read_colours(tiff, header, place);
    read_blocks(tiff, header, place);
    return header;
}

void look_up(const Header& header, std::span<const float> indices, float* out) {
    // 16 bits to 8.
    constexpr int kStep = 257;
    for (const float index : indices) {
        for (const std::uint16_t* colours : header.palette) {
            *out++ = static_cast<float>(colours[static_cast<std::size_t>(index)] / kStep) / 255.0f;
        }
    }
}

// Writes the samples of one row of a block into the image. plane: of the image, where the planes
// are separate. out: the first pixel.
void store_row(const Header& header, std::span<float> row, std::size_t plane, float* out) {
    if (header.has_palette) {
        look_up(header, row, out);
        return;
    }
    if (!header.type.is_floating) {
        const float white = header.type.white();
        for (float& value : row) value = (header.is_inverted ? white - value : value) / white;
    }
    if (!header.is_separate) {
        pick_samples<float>(row, header.num_samples, header.wanted, 1.0f, out);
        return;
    }
    for (std::size_t i = 0; i < row.size(); ++i) out[i * header.wanted.size() + plane] = row[i];
}

// Where a block lies.
struct Block {
    std::uint32_t index = 0;  // of the file
    std::uint32_t x = 0;
    std::uint32_t y = 0;
    std::size_t plane = 0;  // of the image
};

// Blocks that hold wanted samples, row after row of them; plane after plane where those are
// separate.
class BlockGrid {
  public:
    explicit BlockGrid(const Header& header)
        : header_(header),
          across_((header.width - 1) / header.block_width + 1),
          down_((header.height - 1) / header.block_height + 1) {}

    [[nodiscard]] std::size_t size() const {
        return per_plane() * (header_.is_separate ? header_.wanted.size() : 1);
    }
    [[nodiscard]] Block operator[](std::size_t k) const {
        const std::size_t plane = k / per_plane();
        const std::size_t place = k % per_plane();
        const std::size_t skipped =
            header_.is_separate ? std::size_t(header_.wanted[plane]) * per_plane() : 0;
        return {static_cast<std::uint32_t>(skipped + place),
                static_cast<std::uint32_t>(place % across_ * header_.block_width),
                static_cast<std::uint32_t>(place / across_ * header_.block_height),
                plane};
    }

  private:
    [[nodiscard]] std::size_t per_plane() const { return across_ * down_; }

    const Header& header_;
    std::size_t across_;
    std::size_t down_;
};

// Fills bytes, which are all of one strip or tile.
void read_block(const Handle& tiff,
                const Header& header,
                std::uint32_t index,
                std::span<std::uint8_t> bytes,
                const Message& message,
                const Place& place) {
    // Without compression libtiff reads on where the block is shorter than it should be.
    if (field<std::uint16_t>(tiff, TIFFTAG_COMPRESSION) == COMPRESSION_NONE &&
        TIFFGetStrileByteCount(tiff.get(), index) < bytes.size()) {
        place.fail_as_damaged(fmt::format("block {} is too short", index));
    }
    const auto size = static_cast<tmsize_t>(bytes.size());
    const tmsize_t num_read = header.is_tiled
                                  ? TIFFReadEncodedTile(tiff.get(), index, bytes.data(), size)
                                  : TIFFReadEncodedStrip(tiff.get(), index, bytes.data(), size);
    if (num_read != size || message.front() != '\0') place.fail_as_damaged(message.data());
}

}  // namespace

StoredImage read_tiff(const Place& place) {
    Message message{};
    const Handle tiff = open_tiff(message, place);
    const Header header = read_header(tiff, place);
    Image image(static_cast<int>(header.width),
                static_cast<int>(header.height),
                static_cast<int>(header.wanted.size()));
    const auto row_bytes = static_cast<std::size_t>(header.is_tiled ? TIFFTileRowSize(tiff.get())
                                                                    : TIFFScanlineSize(tiff.get()));
    const std::size_t samples_together = header.is_separate ? 1 : header.num_samples;
    std::vector<std::uint8_t> bytes(row_bytes * header.block_height);
    std::vector<float> row(header.block_width * samples_together);
    const BlockGrid blocks(header);
    for (std::size_t k = 0; k < blocks.size(); ++k) {
        const Block block = blocks[k];
        const std::size_t num_rows = std::min(header.block_height, header.height - block.y);
        const std::size_t num_columns = std::min(header.block_width, header.width - block.x);
        const std::size_t size = row_bytes * (header.is_tiled ? header.block_height : num_rows);
        read_block(tiff, header, block.index, std::span(bytes).first(size), message, place);
        for (std::size_t y = 0; y < num_rows; ++y) {
            const auto samples = std::span(row).first(num_columns * samples_together);
            const std::uint8_t* packed = bytes.data() + y * row_bytes;
            if (header.has_palette) {
                unpack_indices(packed, header.type.bits, samples);
            } else {
                unpack_samples(packed, header.type, samples);
            }
            store_row(
                header,
                samples,
                block.plane,
                &image.data[image.index(static_cast<int>(block.x), static_cast<int>(block.y + y))]);
        }
    }
    return {std::move(image), header.kind()};
}

ImageSize read_tiff_size(const Place& place) {
    Message message{};
    const Header header = read_header(open_tiff(message, place), place);
    return {static_cast<int>(header.width),
            static_cast<int>(header.height),
            static_cast<int>(header.wanted.size())};
}

}  // namespace patina
