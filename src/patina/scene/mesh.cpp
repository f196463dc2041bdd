#include "patina/scene/mesh.h"

#include "patina/base/check.h"

namespace patina {
namespace {

struct Corners {
    Vec3 p0;
    Vec3 edge1;
    Vec3 edge2;
    [[nodiscard]] Vec3 area_normal() const { return edge1.cross(edge2); }
};

Corners corners_of(const Mesh& mesh, std::uint32_t triangle) {
    const Triangle& t = mesh.triangles[triangle];
    const Vec3 p0 = mesh.positions[t[0]].cast<double>();
    return {p0, mesh.positions[t[1]].cast<double>() - p0, mesh.positions[t[2]].cast<double>() - p0};
}

}  // namespace

SurfacePoint surface_point(const Mesh& mesh, std::uint32_t triangle, const Vec2f& barycentric) {
    const Corners corners = corners_of(mesh, triangle);
    const double u = double(barycentric.x());
    const double v = double(barycentric.y());
    SurfacePoint point;
    point.triangle = triangle;
    point.barycentric = barycentric;
    point.position = corners.p0 + u * corners.edge1 + v * corners.edge2;

    const Vec3 area_normal = corners.area_normal();
    const double doubled_area = area_normal.norm();
    if (doubled_area > 0) point.geometric_normal = area_normal / doubled_area;

    point.normal = point.geometric_normal;
    if (mesh.normals.empty()) return point;
    const Triangle& t = mesh.triangles[triangle];
    for (const std::uint32_t vertex : t) {
        if (mesh.normals[vertex].isZero(0)) return point;
    }
    const Vec3 smooth = (1 - u - v) * mesh.normals[t[0]].cast<double>() +
                        u * mesh.normals[t[1]].cast<double>() +
                        v * mesh.normals[t[2]].cast<double>();
    const double length = smooth.norm();
    // Opposite vertex normals may cancel; NaN compares false too.
    if (length > 0) point.normal = smooth / length;
    return point;
}

Vec2 surface_uv(const Mesh& mesh, std::uint32_t triangle, const Vec2f& barycentric) {
    PATINA_CHECK_EQ(mesh.uvs.size(), mesh.positions.size());
    const Triangle& t = mesh.triangles[triangle];
    const double u = double(barycentric.x());
    const double v = double(barycentric.y());
    return (1 - u - v) * mesh.uvs[t[0]].cast<double>() + u * mesh.uvs[t[1]].cast<double>() +
           v * mesh.uvs[t[2]].cast<double>();
}

Bounds bounds_of(const Mesh& mesh) {
    if (mesh.positions.empty()) return {};
    Eigen::AlignedBox3d box;
    for (const Vec3f& p : mesh.positions) box.extend(p.cast<double>());
    return {box.min(), box.max()};
}

double triangle_area(const Mesh& mesh, std::uint32_t triangle) {
    return 0.5 * corners_of(mesh, triangle).area_normal().norm();
}

}  // namespace patina
