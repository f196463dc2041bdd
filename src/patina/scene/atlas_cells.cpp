#include "patina/scene/atlas_cells.h"

#include "patina/base/parallel.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double doubled_signed_area(const CellTriangle& t) { return cross(t[1] - t[0], t[2] - t[0]); }

// A convex polygon of at most 3 + 4 corners: a triangle cut by the sides of a square.
struct SmallPolygon {
    std::array<Vec2, 8> corners;
    int size = 0;
};

// Keeps the part where sign * (coordinate - limit) <= 0 (Sutherland and Hodgman, 1974).
SmallPolygon clip(const SmallPolygon& polygon, int axis, double limit, double sign) {
    SmallPolygon result;
    for (int i = 0; i < polygon.size; ++i) {
        const Vec2& a = polygon.corners[std::size_t(i)];
        const Vec2& b = polygon.corners[std::size_t((i + 1) % polygon.size)];
        const double da = sign * (a[axis] - limit);
        const double db = sign * (b[axis] - limit);
        if (da <= 0) result.corners[std::size_t(result.size++)] = a;
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
            result.corners[std::size_t(result.size++)] = a + (b - a) * (da / (da - db));
        }
    }
    return result;
}

// Area of the part of a triangle inside the unit cell whose low corner is (column, row).
double overlap_area(const CellTriangle& t, int column, int row) {
    SmallPolygon polygon;
    polygon.size = 3;
    std::copy(t.begin(), t.end(), polygon.corners.begin());
    polygon = clip(polygon, 0, column, -1);
    polygon = clip(polygon, 0, column + 1, 1);
    polygon = clip(polygon, 1, row, -1);
    polygon = clip(polygon, 1, row + 1, 1);
    double doubled = 0;
    for (int i = 2; i < polygon.size; ++i) {
        doubled += cross(polygon.corners[std::size_t(i - 1)] - polygon.corners[0],
                         polygon.corners[std::size_t(i)] - polygon.corners[0]);
    }
    return 0.5 * std::abs(doubled);
}

// Rows or columns of cells [first, last].
struct CellRange {
    int first = 0;
    int last = -1;
};

// Where the numbers between low and high lie among `count` cells side by side.
CellRange cell_range(double low, double high, int count) {
    const int first = std::clamp(int(std::floor(low)), 0, count - 1);
    return {first, std::clamp(int(std::ceil(high)) - 1, first, count - 1)};
}

CellRange rows_of(const Mesh& mesh, std::uint32_t triangle, int width, int height) {
    const CellTriangle t = cell_triangle(mesh, triangle, width, height);
    if (doubled_signed_area(t) == 0) return {};
    const auto [low, high] = std::minmax({t[0].y(), t[1].y(), t[2].y()});
    return cell_range(low, high, height);
}

// What a triangle adds to the cells of these rows.
void rasterize_triangle(const Mesh& mesh,
                        std::uint32_t triangle,
                        CellRange rows,
                        int width,
                        int height,
                        LargeVector<Cell>& cells) {
    const CellTriangle t = cell_triangle(mesh, triangle, width, height);
    const double doubled = doubled_signed_area(t);
    const double surface_per_cell = 2 * triangle_area(mesh, triangle) / std::abs(doubled);
    const auto [low_x, high_x] = std::minmax({t[0].x(), t[1].x(), t[2].x()});
    const CellRange columns = cell_range(low_x, high_x, width);
    for (int row = rows.first; row <= rows.last; ++row) {
        for (int column = columns.first; column <= columns.last; ++column) {
            Cell& cell = cells[std::size_t(row) * std::size_t(width) + std::size_t(column)];
            const double overlap = overlap_area(t, column, row);
            cell.area += overlap * surface_per_cell;
            if (overlap > cell.largest_overlap) {
                cell.largest_overlap = overlap;
                cell.largest_triangle = triangle;
            }
            const Vec2 center(column + 0.5, row + 0.5);
            const double u = cross(center - t[0], t[2] - t[0]) / doubled;
            const double v = cross(t[1] - t[0], center - t[0]) / doubled;
            if (!cell.has_center && u >= 0 && v >= 0 && u + v <= 1) {
                cell.has_center = true;
                cell.center_triangle = triangle;
                cell.center_barycentric = Vec2(u, v).cast<float>();
            }
        }
    }
}

}  // namespace

CellTriangle cell_triangle(const Mesh& mesh, std::uint32_t triangle, int width, int height) {
    CellTriangle corners;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2f& uv = mesh.uvs[mesh.triangles[triangle][i]];
        corners[i] = {double(uv.x()) * width, (1.0 - double(uv.y())) * height};
    }
    return corners;
}

// Bands of rows are filled side by side; every cell meets its triangles in order.
LargeVector<Cell> rasterize_cells(const Mesh& mesh, int width, int height) {
    constexpr int kBandRows = 32;
    std::vector<CellRange> rows(mesh.triangles.size());
    parallel_for(rows.size(),
                 [&](std::size_t i) { rows[i] = rows_of(mesh, std::uint32_t(i), width, height); });
    LargeVector<Cell> cells(std::size_t(width) * std::size_t(height));
    const auto fill_band = [&](std::size_t band) {
        const int first = int(band) * kBandRows;
        const int last = std::min(first + kBandRows, height) - 1;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const CellRange both{std::max(rows[i].first, first), std::min(rows[i].last, last)};
            if (both.first > both.last) continue;
            rasterize_triangle(mesh, std::uint32_t(i), both, width, height, cells);
        }
    };
    parallel_for(std::size_t((height + kBandRows - 1) / kBandRows), fill_band, 1);
    return cells;
}

}  // namespace patina
