#include "patina/base/check.h"
#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/image/image.h"
#include "patina/image/pfm.h"
#include "patina/image/png_check.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <string_view>

namespace patina {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKindsUnderstood = "an OpenEXR, PNG, TIFF or PFM image";
// A damaged header must not ask for more memory than any image needs: 178 megapixels of three
// channels [samples].
constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 29;

// What goes into an error: the file, and where the caller found its name.
struct Place {
    const fs::path& path;
    const std::string& field;

    [[noreturn]] void fail(const std::string& problem, const std::string& expected) const {
        throw Error(path.string(), field, problem, expected);
    }
};

// Some builds print remarks for their developers to standard output; errors do not come that way.
void silence_debug_remarks() { OIIO::attribute("debug", 0); }

enum class FileKind { exr, png, tiff, pfm };

std::string read_head(const Place& place, std::size_t num_bytes) {
    if (!fs::exists(place.path)) place.fail("does not exist", kKindsUnderstood);
    if (fs::is_directory(place.path)) place.fail("is a folder", kKindsUnderstood);
    std::ifstream stream(place.path, std::ios::binary);
    if (!stream) place.fail("cannot be read", "a readable file");
    std::string head(num_bytes, '\0');
    stream.read(head.data(), static_cast<std::streamsize>(num_bytes));
    head.resize(static_cast<std::size_t>(stream.gcount()));
    return head;
}

// By the first bytes, so that a wrong extension neither helps nor harms.
FileKind kind_of(std::string_view head, const Place& place) {
    using namespace std::string_view_literals;
    if (head.starts_with("\x76\x2f\x31\x01"sv)) return FileKind::exr;
    if (head.starts_with("\x89PNG\r\n\x1a\n"sv)) return FileKind::png;
    if (head.starts_with("II*\0"sv) || head.starts_with("MM\0*"sv)) return FileKind::tiff;
    if (head.starts_with("PF"sv) || head.starts_with("Pf"sv)) return FileKind::pfm;
    place.fail(head.empty() ? "is empty" : "is of a kind not understood", kKindsUnderstood);
}

const char* reader_name(FileKind kind) {
    switch (kind) {
        case FileKind::exr:
            return "exr";
        case FileKind::png:
            return "png";
        default:
            return "tiff";
    }
}

// OpenImageIO's messages end in line breaks; an error is one line.
std::string one_line(std::string message) {
    std::replace(message.begin(), message.end(), '\n', ' ');
    while (!message.empty() && message.back() == ' ') message.pop_back();
    return message;
}

// An open image of OpenImageIO with the channels that are wanted of it.
struct OpenedImage {
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;
    std::vector<int> channels;  // of the file, in the order R, G, B or one
    SampleKind kind = SampleKind::floating;
};

bool same_word(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) {
        return lower(x) == lower(y);
    });
}

// Channels of the first layer that has all of R, G and B; else the luminance; else the only one.
std::vector<int> wanted_channels(const OIIO::ImageSpec& spec, const Place& place) {
    const std::vector<std::string>& names = spec.channelnames;
    const auto find = [&](const std::string& name) {
        const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& other) {
            return same_word(name, other);
        });
        return found == names.end() ? -1 : static_cast<int>(found - names.begin());
    };
    std::vector<std::string> layers = {""};
    for (const std::string& name : names) {
        const std::size_t dot = name.rfind('.');
        if (dot != std::string::npos) layers.push_back(name.substr(0, dot + 1));
    }
    for (const std::string& layer : layers) {
        const std::vector<int> rgb = {find(layer + "R"), find(layer + "G"), find(layer + "B")};
        if (rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0) return rgb;
    }
    const bool has_chroma = find("RY") >= 0 || find("BY") >= 0;
    if (const int luminance = find("Y"); luminance >= 0 && !has_chroma) return {luminance};
    const bool has_alpha = spec.alpha_channel >= 0;
    if (spec.nchannels == 1) return {0};
    if (spec.nchannels == 2 && has_alpha) return {1 - spec.alpha_channel};
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    place.fail("has the channels " + all, "R, G and B, or Y, or a single channel");
}

SampleKind sample_kind(const OIIO::ImageSpec& spec, const Place& place) {
    switch (spec.format.basetype) {
        case OIIO::TypeDesc::UINT8:
            return SampleKind::unsigned8;
        case OIIO::TypeDesc::UINT16:
            return SampleKind::unsigned16;
        case OIIO::TypeDesc::HALF:
        case OIIO::TypeDesc::FLOAT:
        case OIIO::TypeDesc::DOUBLE:
            return SampleKind::floating;
        default:
            place.fail(fmt::format("has samples of type {}", spec.format.c_str()),
                       "unsigned integers of 8 or 16 bits, or floats");
    }
}

OpenedImage open_image(FileKind kind, const Place& place) {
    silence_debug_remarks();
    // libpng takes a file for complete once it has all rows, and prints what it finds wrong.
    if (kind == FileKind::png && !is_whole_png(read_file(place.path))) {
        place.fail("is damaged or truncated", "a complete PNG image");
    }
    OpenedImage opened;
    opened.input = OIIO::ImageInput::create(reader_name(kind));
    if (!opened.input) {
        place.fail("cannot be read: " + one_line(OIIO::geterror()), kKindsUnderstood);
    }
    OIIO::ImageSpec wishes;
    wishes["oiio:UnassociatedAlpha"] = 1;  // colours as stored, not multiplied by alpha
    if (!opened.input->open(place.path.string(), opened.spec, wishes)) {
        place.fail("cannot be read: " + one_line(opened.input->geterror()), kKindsUnderstood);
    }
    const OIIO::ImageSpec& spec = opened.spec;
    if (spec.deep || spec.depth > 1) place.fail("is a deep or volume image", "a flat image");
    if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
        spec.height != spec.full_height) {
        place.fail("has a data window that is not its display window", "an image without crop");
    }
    const std::uint64_t num_pixels =
        std::uint64_t(std::max(spec.width, 0)) * std::uint64_t(std::max(spec.height, 0));
    if (num_pixels == 0 || spec.nchannels < 1 ||
        num_pixels > kMaxSamples / std::uint64_t(spec.nchannels)) {
        place.fail(fmt::format("has a size of {} x {}", spec.width, spec.height),
                   fmt::format("at most {} samples", kMaxSamples));
    }
    opened.kind = sample_kind(spec, place);
    opened.channels = wanted_channels(spec, place);
    return opened;
}

// Reads all samples in their own type and picks the wanted channels. scale: sample of value 1.
template <typename Sample>
Image read_samples(const OpenedImage& opened,
                   OIIO::TypeDesc type,
                   float scale,
                   const Place& place) {
    const OIIO::ImageSpec& spec = opened.spec;
    const std::size_t num_channels = std::size_t(spec.nchannels);
    std::vector<Sample> samples(std::size_t(spec.width) * std::size_t(spec.height) * num_channels);
    const bool complete = opened.input->read_image(0, 0, 0, spec.nchannels, type, samples.data());
    const std::string message = one_line(opened.input->geterror());
    if (!complete || !message.empty()) {
        place.fail("is damaged or truncated: " + message, "a complete image");
    }
    Image image(spec.width, spec.height, static_cast<int>(opened.channels.size()));
    std::size_t out = 0;
    for (std::size_t pixel = 0; pixel < samples.size(); pixel += num_channels) {
        for (const int channel : opened.channels) {
            image.data[out++] = float(samples[pixel + std::size_t(channel)]) / scale;
        }
    }
    return image;
}

StoredImage read_with_oiio(FileKind kind, const Place& place) {
    const OpenedImage opened = open_image(kind, place);
    switch (opened.kind) {
        case SampleKind::unsigned8:
            return {read_samples<std::uint8_t>(opened, OIIO::TypeDesc::UINT8, 255.0f, place),
                    opened.kind};
        case SampleKind::unsigned16:
            return {read_samples<std::uint16_t>(opened, OIIO::TypeDesc::UINT16, 65535.0f, place),
                    opened.kind};
        case SampleKind::floating:
            break;
    }
    return {read_samples<float>(opened, OIIO::TypeDesc::FLOAT, 1.0f, place), opened.kind};
}

// The bytes of a file of this format ("exr", "png").
std::string encode(const std::string& format, const OIIO::ImageSpec& spec, const void* samples) {
    silence_debug_remarks();
    OIIO::Filesystem::IOVecOutput bytes;
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format);
    PATINA_CHECK(output && output->set_ioproxy(&bytes));
    const bool written = output->open("memory." + format, spec) &&
                         output->write_image(spec.format, samples) && output->close();
    if (!written) {
        throw WorkFailed("cannot encode an image as " + format + ": " +
                         one_line(output->geterror()));
    }
    return std::string(bytes.buffer().begin(), bytes.buffer().end());
}

OIIO::ImageSpec make_spec(const Image& image, OIIO::TypeDesc type) {
    PATINA_CHECK(image.channels == 1 || image.channels == 3);
    OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
    spec.channelnames = image.channels == 3 ? std::vector<std::string>{"R", "G", "B"}
                                            : std::vector<std::string>{"Y"};
    return spec;
}

template <typename Sample>
std::string encode_png_as(const Image& image, OIIO::TypeDesc type) {
    constexpr float kWhite = std::numeric_limits<Sample>::max();
    std::vector<Sample> samples(image.data.size());
    std::transform(image.data.begin(), image.data.end(), samples.begin(), [](float value) {
        // NaN becomes black.
        const float clamped = value > 0 ? std::min(value, 1.0f) : 0.0f;
        return static_cast<Sample>(std::lround(clamped * kWhite));
    });
    return encode("png", make_spec(image, type), samples.data());
}

}  // namespace

StoredImage read_image(const fs::path& path, const std::string& field) {
    const Place place{path, field};
    const FileKind kind = kind_of(read_head(place, kPfmHeaderBytes), place);
    if (kind == FileKind::pfm) {
        return {decode_pfm(read_file(path), path, field), SampleKind::floating};
    }
    return read_with_oiio(kind, place);
}

ImageSize read_image_size(const fs::path& path, const std::string& field) {
    const Place place{path, field};
    const std::string head = read_head(place, kPfmHeaderBytes);
    const FileKind kind = kind_of(head, place);
    if (kind == FileKind::pfm) return parse_pfm_header(head, path, field).size;
    const OpenedImage opened = open_image(kind, place);
    return {opened.spec.width, opened.spec.height, static_cast<int>(opened.channels.size())};
}

void write_exr(const fs::path& path, const Image& image) {
    OIIO::ImageSpec spec = make_spec(image, OIIO::TypeDesc::FLOAT);
    spec["compression"] = "zip";
    // OpenImageIO adds today's date where there is none; a date that is no text is left out.
    spec["DateTime"] = 0;
    write_file(path, encode("exr", spec, image.data.data()));
}

void write_png(const fs::path& path, const Image& image, int bits) {
    PATINA_CHECK(bits == 8 || bits == 16);
    write_file(path,
               bits == 8 ? encode_png_as<std::uint8_t>(image, OIIO::TypeDesc::UINT8)
                         : encode_png_as<std::uint16_t>(image, OIIO::TypeDesc::UINT16));
}

void write_pfm(const fs::path& path, const Image& image) { write_file(path, encode_pfm(image)); }

std::string encode_png(const Image& image) {
    return encode_png_as<std::uint8_t>(image, OIIO::TypeDesc::UINT8);
}

}  // namespace patina
