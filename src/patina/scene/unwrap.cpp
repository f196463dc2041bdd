#include "patina/scene/unwrap.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {
namespace {

// Between a chart and the texels it must not touch [texels]: far above the rounding of a float uv,
// and small enough for a square of kMinSquare texels to have a texel centre inside both of its
// charts.
constexpr double kMargin = 0.25;
constexpr int kMinSquare = 3;  // [texels]

std::size_t num_squares(int width, int height, int square_size) {
    return std::size_t(width / square_size) * std::size_t(height / square_size);
}

// Side of the largest squares of which enough fit; 0 when even the smallest are too few [texels].
int square_size_for(std::size_t count, int width, int height) {
    int size = std::min(width, height);
    while (size >= kMinSquare && num_squares(width, height, size) < count) --size;
    return size >= kMinSquare ? size : 0;
}

// The corner with the largest angle, which gets the right angle of the chart.
std::size_t widest_corner(const Mesh& mesh, const Triangle& t) {
    std::array<float, 3> opposite{};
    for (std::size_t k = 0; k < 3; ++k) {
        opposite[k] =
            (mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[(k + 2) % 3]]).squaredNorm();
    }
    return std::size_t(std::max_element(opposite.begin(), opposite.end()) - opposite.begin());
}

}  // namespace

std::optional<Mesh> unwrap(const Mesh& mesh, int width, int height) {
    const std::size_t count = (mesh.triangles.size() + 1) / 2;
    const int square_size = square_size_for(count, width, height);
    if (square_size == 0) return std::nullopt;
    const std::size_t num_columns = std::size_t(width / square_size);
    // The lower chart touches texels (i, j) with i + j <= size - 2, the upper one those with
    // i + j >= size: the diagonal between them stays free.
    const double leg = square_size - 1 - 3 * kMargin;
    Mesh result;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Triangle& t = mesh.triangles[i];
        const std::size_t square_index = i / 2;
        const Vec2 origin(double(square_index % num_columns) * square_size,
                          double(square_index / num_columns) * square_size);
        const bool upper = i % 2 == 1;
        const double sign = upper ? -1 : 1;
        const Vec2 corner = origin + Vec2::Constant(upper ? square_size - kMargin : kMargin);
        const std::array<Vec2, 3> places = {
            corner, corner + Vec2(sign * leg, 0), corner + Vec2(0, sign * leg)};
        const std::size_t first = widest_corner(mesh, t);
        const auto next = static_cast<std::uint32_t>(result.positions.size());
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = t[(first + k) % 3];
            result.positions.push_back(mesh.positions[vertex]);
            if (!mesh.normals.empty()) result.normals.push_back(mesh.normals[vertex]);
            result.uvs.push_back(Vec2(places[k].x() / width, places[k].y() / height).cast<float>());
        }
        result.triangles.push_back({next, next + 1, next + 2});
    }
    return result;
}

}  // namespace patina
