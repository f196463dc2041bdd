#include "patina/pipeline/uv_locator.h"

#include <algorithm>

namespace patina {
namespace {

// Barycentric coordinates may be this far outside [0, 1] [-]: the rounding of single-precision uvs,
// so that no position falls between two triangles.
constexpr double kTolerance = 1e-5;

struct UvTriangle {
    Vec2 a, b, c;
};

UvTriangle uv_triangle(const Mesh& mesh, std::size_t triangle) {
    const Triangle& corners = mesh.triangles[triangle];
    return {mesh.uvs[corners[0]].cast<double>(),
            mesh.uvs[corners[1]].cast<double>(),
            mesh.uvs[corners[2]].cast<double>()};
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

// Barycentric coordinates of a uv in a triangle that has area; nothing outside.
std::optional<Vec2f> barycentric_at(const UvTriangle& triangle, const Vec2& uv) {
    const Vec2 ab = triangle.b - triangle.a;
    const Vec2 ac = triangle.c - triangle.a;
    const double area = cross(ab, ac);
    if (area == 0) return std::nullopt;
    const double u = cross(uv - triangle.a, ac) / area;
    const double v = cross(ab, uv - triangle.a) / area;
    if (u < -kTolerance || v < -kTolerance || u + v > 1 + kTolerance) return std::nullopt;
    return Vec2(u, v).cast<float>();
}

}  // namespace

UvLocator::UvLocator(const Mesh& mesh, int columns, int rows)
    : mesh_(mesh),
      columns_(columns),
      rows_(rows),
      begin_(std::size_t(columns) * std::size_t(rows) + 1, 0) {
    const auto visit_cells = [&](std::size_t triangle, const auto& visit) {
        const UvTriangle uv = uv_triangle(mesh_, triangle);
        const Vec2 low = uv.a.cwiseMin(uv.b).cwiseMin(uv.c);
        const Vec2 high = uv.a.cwiseMax(uv.b).cwiseMax(uv.c);
        for (int row = row_of(low.y()); row <= row_of(high.y()); ++row) {
            for (int column = column_of(low.x()); column <= column_of(high.x()); ++column) {
                visit(std::size_t(row) * std::size_t(columns_) + std::size_t(column));
            }
        }
    };
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        visit_cells(t, [&](std::size_t cell) { ++begin_[cell + 1]; });
    }
    for (std::size_t cell = 1; cell < begin_.size(); ++cell) begin_[cell] += begin_[cell - 1];
    triangles_.resize(begin_.back());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        visit_cells(t, [&](std::size_t cell) { triangles_[next[cell]++] = std::uint32_t(t); });
    }
}

std::optional<SurfacePoint> UvLocator::find(const Vec2& uv) const {
    const std::size_t cell =
        std::size_t(row_of(uv.y())) * std::size_t(columns_) + std::size_t(column_of(uv.x()));
    for (std::uint32_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
        const auto barycentric = barycentric_at(uv_triangle(mesh_, triangles_[i]), uv);
        if (barycentric) return surface_point(mesh_, triangles_[i], *barycentric);
    }
    return std::nullopt;
}

int UvLocator::column_of(double u) const {
    return std::clamp(int(std::floor(u * columns_)), 0, columns_ - 1);
}

int UvLocator::row_of(double v) const {
    return std::clamp(int(std::floor(v * rows_)), 0, rows_ - 1);
}

}  // namespace patina
