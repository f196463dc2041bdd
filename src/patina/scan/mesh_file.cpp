#include "patina/scan/mesh_file.h"

#include "patina/base/check.h"
#include "patina/base/output_file.h"

#include <iterator>

namespace patina {

void write_obj(const Mesh& mesh, const std::filesystem::path& path) {
    PATINA_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
    PATINA_CHECK_EQ(mesh.uvs.size(), mesh.positions.size());
    std::string text;
    auto out = std::back_inserter(text);
    for (const Vec3f& p : mesh.positions) {
        fmt::format_to(out, "v {:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z());
    }
    for (const Vec2f& uv : mesh.uvs) fmt::format_to(out, "vt {:.9g} {:.9g}\n", uv.x(), uv.y());
    for (const Vec3f& n : mesh.normals) {
        fmt::format_to(out, "vn {:.9g} {:.9g} {:.9g}\n", n.x(), n.y(), n.z());
    }
    for (const Triangle& triangle : mesh.triangles) {
        text += 'f';
        for (const std::uint32_t vertex : triangle) {
            fmt::format_to(out, " {0}/{0}/{0}", vertex + 1);
        }
        text += '\n';
    }
    write_file(path, text);
}

}  // namespace patina
