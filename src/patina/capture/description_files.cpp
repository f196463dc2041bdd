#include "patina/capture/description_parts.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {
namespace {

namespace fs = std::filesystem;

// Whether `path` lies in `folder`; both canonical.
bool lies_in(const fs::path& path, const fs::path& folder) {
    const auto [folder_end, path_end] =
        std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
    return folder_end == folder.end();
}

}  // namespace

std::string read_file_field(const JsonField& field, const fs::path& folder) {
    const std::string expected = "a path inside the capture's folder, with '/'";
    const std::string name = field.text(expected);
    const fs::path relative(name);
    const bool drive = name.size() >= 2 && name[1] == ':';
    if (name.empty() || relative.is_absolute() || drive ||
        name.find_first_of(std::string("\\\0", 2)) != std::string::npos) {
        field.fail("is " + quote(name), expected);
    }
    const fs::path normal = relative.lexically_normal();
    if (*normal.begin() == "..") field.fail(quote(name) + " leaves the folder", expected);
    const fs::path path = folder / relative;
    std::error_code code;
    const fs::path canonical = fs::canonical(path, code);
    if (code) field.fail(quote(name) + " does not exist", "a file");
    if (!lies_in(canonical, fs::canonical(folder, code))) {
        field.fail(quote(name) + " leads out of the folder", expected);
    }
    if (!fs::is_regular_file(canonical, code)) field.fail(quote(name) + " is no file", "a file");
    return name;
}

void check_image_field(const JsonField& field,
                       const fs::path& folder,
                       int width,
                       int height,
                       const std::string& owner) {
    const std::string name = read_file_field(field, folder);
    const ImageSize size = read_image_size(folder / name, field.path());
    if (size.width != width || size.height != height) {
        field.fail(fmt::format("{} has {} x {} pixels", quote(name), size.width, size.height),
                   fmt::format("{} x {}, the size of {}", width, height, owner));
    }
    if (size.channels != 1 && size.channels != 3) {
        field.fail(fmt::format("{} has {} channels", quote(name), size.channels),
                   "1 or 3 channels");
    }
}

std::size_t read_id_field(const JsonField& field,
                          const std::vector<std::string>& ids,
                          const std::string& what) {
    const std::string expected = "the id of a " + what;
    const std::string id = field.text(expected);
    const auto found = std::find(ids.begin(), ids.end(), id);
    if (found == ids.end()) field.fail("is " + quote(id) + ", which no " + what + " has", expected);
    return std::size_t(found - ids.begin());
}

}  // namespace patina
