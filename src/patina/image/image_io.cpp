#include "patina/base/output_file.h"
#include "patina/image/exr_file.h"
#include "patina/image/image.h"
#include "patina/image/image_file.h"
#include "patina/image/pfm.h"
#include "patina/image/png_file.h"
#include "patina/image/tiff_file.h"

#include <fstream>
#include <string_view>

namespace patina {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

StoredImage read_image(const fs::path& path, const std::string& field) {
    const Place place{path, field};
    switch (kind_of(read_head(place, kPfmHeaderBytes), place)) {
        case FileKind::exr:
            return {read_exr(place), SampleKind::floating};
        case FileKind::png:
            return read_png(place);
        case FileKind::tiff:
            return read_tiff(place);
        case FileKind::pfm:
            break;
    }
    return {decode_pfm(read_file(path), path, field), SampleKind::floating};
}

ImageSize read_image_size(const fs::path& path, const std::string& field) {
    const Place place{path, field};
    const std::string head = read_head(place, kPfmHeaderBytes);
    switch (kind_of(head, place)) {
        case FileKind::exr:
            return read_exr_size(place);
        case FileKind::png:
            return read_png_size(place);
        case FileKind::tiff:
            return read_tiff_size(place);
        case FileKind::pfm:
            break;
    }
    return parse_pfm_header(head, path, field).size;
}

void write_exr(const fs::path& path, const Image& image) { write_file(path, encode_exr(image)); }

void write_png(const fs::path& path, const Image& image, int bits) {
    write_file(path, encode_png(image, bits));
}

void write_pfm(const fs::path& path, const Image& image) { write_file(path, encode_pfm(image)); }

std::string encode_png(const Image& image) { return encode_png(image, 8); }

}  // namespace patina
