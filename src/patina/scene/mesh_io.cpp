#include "patina/scene/mesh_io.h"

#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/scene/polygon_soup.h"

#include <algorithm>

namespace patina {
namespace {

std::string lower_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return extension;
}

std::string read_contents(const MeshPlace& place) {
    if (!std::filesystem::exists(place.path)) place.fail("does not exist", "a mesh file");
    if (std::filesystem::is_directory(place.path)) place.fail("is a folder", "a mesh file");
    return read_file(place.path);
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& path, const std::string& field) {
    const MeshPlace place{path, field};
    const std::string extension = lower_extension(path);
    const auto parse = extension == ".obj"                           ? parse_obj
                       : extension == ".ply"                         ? parse_ply
                       : extension == ".gltf" || extension == ".glb" ? parse_gltf
                                                                     : nullptr;
    if (parse == nullptr) place.fail("is of a kind not understood", ".obj, .ply, .gltf or .glb");
    const std::string contents = read_contents(place);
    if (contents.empty()) place.fail("is empty", "a mesh file");
    return mesh_from_soup(parse(contents, place), place);
}

}  // namespace patina
