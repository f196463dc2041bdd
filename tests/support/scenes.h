// Meshes with known light transport: rectangles, a box and a sphere seen from inside, a sphere.
#pragma once

#include "patina/scene/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace patina {

// A rectangle of the uv domain.
struct UvRectangle {
    Vec2 low = Vec2::Zero();
    Vec2 high = Vec2::Ones();
};

inline void append(Mesh& mesh, const Mesh& other) {
    const auto offset = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
    mesh.uvs.insert(mesh.uvs.end(), other.uvs.begin(), other.uvs.end());
    for (const Triangle& t : other.triangles) {
        mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    }
}

// Two triangles that face edge_u x edge_v, flat normals, u along edge_u and v along edge_v.
[[nodiscard]] inline Mesh rectangle(const Vec3& corner,
                                    const Vec3& edge_u,
                                    const Vec3& edge_v,
                                    const UvRectangle& uv = {}) {
    Mesh mesh;
    for (const Vec3& p :
         {corner, Vec3(corner + edge_u), Vec3(corner + edge_u + edge_v), Vec3(corner + edge_v)}) {
        mesh.positions.push_back(p.cast<float>());
    }
    mesh.uvs = {uv.low.cast<float>(),
                Vec2(uv.high.x(), uv.low.y()).cast<float>(),
                uv.high.cast<float>(),
                Vec2(uv.low.x(), uv.high.y()).cast<float>()};
    mesh.normals.assign(4, Vec3f::Zero());
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

// Two unit squares that meet at a right angle along the y axis: z = 0 faces +z, x = 0 faces +x.
// Their charts are the lower and the upper half of the uv domain, a gap between them.
[[nodiscard]] inline Mesh perpendicular_unit_squares() {
    Mesh mesh = rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), {Vec2(0, 0), Vec2(1, 0.45)});
    append(mesh,
           rectangle(Vec3::Zero(), Vec3::UnitY(), Vec3::UnitZ(), {Vec2(0, 0.55), Vec2(1, 1)}));
    return mesh;
}

// The box [0, size], facing inwards, flat normals; six charts in a grid of 3 x 2, gaps between
// them.
[[nodiscard]] inline Mesh inward_box(const Vec3& size) {
    constexpr double kMargin = 0.02;
    Mesh mesh;
    const auto add_side = [&](int chart, const Vec3& corner, const Vec3& u, const Vec3& v) {
        const Vec2 low(double(chart % 3) / 3, double(chart / 3) / 2);
        append(mesh,
               rectangle(corner,
                         u,
                         v,
                         {low + Vec2::Constant(kMargin),
                          low + Vec2(1.0 / 3, 1.0 / 2) - Vec2::Constant(kMargin)}));
    };
    const Vec3 x(size.x(), 0, 0);
    const Vec3 y(0, size.y(), 0);
    const Vec3 z(0, 0, size.z());
    add_side(0, Vec3::Zero(), x, y);
    add_side(1, Vec3::Zero(), y, z);
    add_side(2, Vec3::Zero(), z, x);
    add_side(3, z, y, x);
    add_side(4, x, z, y);
    add_side(5, y, x, z);
    return mesh;
}

enum class SphereSide { outward, inward };

// A sphere about the origin of `columns` x `rows` quadrilaterals, vertices on the sphere and smooth
// normals on request; u runs with longitude, v from the south to the north pole (the y axis).
[[nodiscard]] inline Mesh sphere(
    double radius, int columns, int rows, SphereSide side, bool smooth = false) {
    Mesh mesh;
    for (int row = 0; row <= rows; ++row) {
        const double polar = kPi * row / rows;
        for (int column = 0; column <= columns; ++column) {
            const double longitude = 2 * kPi * (column % columns) / columns;
            const Vec3 w(std::sin(polar) * std::sin(longitude),
                         -std::cos(polar),
                         std::sin(polar) * std::cos(longitude));
            mesh.positions.push_back((radius * w).cast<float>());
            const Vec3 n = side == SphereSide::outward ? w : Vec3(-w);
            mesh.normals.push_back(smooth ? Vec3f(n.cast<float>()) : Vec3f(Vec3f::Zero()));
            mesh.uvs.push_back(Vec2(double(column) / columns, double(row) / rows).cast<float>());
        }
    }
    const auto vertex = [&](int row, int column) {
        return std::uint32_t(row * (columns + 1) + column);
    };
    const auto add = [&](Triangle t) {
        if (side == SphereSide::inward) std::swap(t[1], t[2]);
        mesh.triangles.push_back(t);
    };
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const std::uint32_t a = vertex(row, column);
            const std::uint32_t b = vertex(row, column + 1);
            const std::uint32_t c = vertex(row + 1, column + 1);
            const std::uint32_t d = vertex(row + 1, column);
            // At the poles one of the two triangles has no area.
            if (row > 0) add({a, b, c});
            if (row + 1 < rows) add({a, c, d});
        }
    }
    return mesh;
}

// Points spread uniformly over a mesh's area.
class AreaSampler {
  public:
    explicit AreaSampler(const Mesh& mesh) : mesh_(&mesh) {
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            area_ += triangle_area(mesh, std::uint32_t(i));
            cumulative_.push_back(area_);
        }
    }

    [[nodiscard]] double area() const { return area_; }

    // choice, u: uniform in [0, 1).
    [[nodiscard]] SurfacePoint sample(double choice, const std::array<double, 2>& u) const {
        const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), choice * area_);
        const auto index =
            std::min(std::size_t(found - cumulative_.begin()), cumulative_.size() - 1);
        const double root = std::sqrt(u[0]);
        return surface_point(
            *mesh_, std::uint32_t(index), Vec2(root * (1 - u[1]), root * u[1]).cast<float>());
    }

  private:
    const Mesh* mesh_;
    double area_ = 0;
    std::vector<double> cumulative_;
};

}  // namespace patina
