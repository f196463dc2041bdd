#include "patina/scan/panels.h"

#include <algorithm>
#include <numeric>

namespace patina {
namespace {

constexpr int kVerticesPerSide = kPanelCells + 1;

void add_panel(const Panel& panel, double v_top, double v_bottom, Mesh& mesh) {
    const auto first = std::uint32_t(mesh.positions.size());
    const Vec3f normal = panel.right.cross(-panel.down).normalized().cast<float>();
    for (int j = 0; j < kVerticesPerSide; ++j) {
        for (int i = 0; i < kVerticesPerSide; ++i) {
            const double s = double(i) / kPanelCells;
            const double t = double(j) / kPanelCells;
            const Vec3 position = panel.corner + s * panel.right + t * panel.down;
            mesh.positions.push_back(position.cast<float>());
            mesh.normals.push_back(normal);
            mesh.uvs.emplace_back(float(s), float(v_top + t * (v_bottom - v_top)));
        }
    }
    for (int j = 0; j < kPanelCells; ++j) {
        for (int i = 0; i < kPanelCells; ++i) {
            const auto a = first + std::uint32_t(j * kVerticesPerSide + i);
            const auto c = a + kVerticesPerSide;
            mesh.triangles.push_back({a, c, a + 1});
            mesh.triangles.push_back({c + 1, a + 1, c});
        }
    }
}

}  // namespace

int total_parts(const std::vector<Panel>& panels) {
    return std::accumulate(panels.begin(), panels.end(), 0, [](int sum, const Panel& panel) {
        return sum + panel.parts;
    });
}

Mesh mesh_of_panels(const std::vector<Panel>& panels) {
    Mesh mesh;
    const double total = total_parts(panels);
    int above = 0;
    for (const Panel& panel : panels) {
        add_panel(panel, 1 - above / total, 1 - (above + panel.parts) / total, mesh);
        above += panel.parts;
    }
    return mesh;
}

SurfacePoint point_on_panels(const Mesh& mesh,
                             const std::vector<Panel>& panels,
                             const Vec2& texture) {
    double t = texture.y() * total_parts(panels);
    std::size_t index = 0;
    while (index + 1 < panels.size() && t >= panels[index].parts) {
        t -= panels[index].parts;
        ++index;
    }
    const Vec2 cell = kPanelCells * Vec2(texture.x(), t / panels[index].parts);
    const int i = std::clamp(int(cell.x()), 0, kPanelCells - 1);
    const int j = std::clamp(int(cell.y()), 0, kPanelCells - 1);
    const double s = cell.x() - i;
    const double r = cell.y() - j;
    const bool lower = s + r > 1;
    const std::size_t num_before =
        index * kPanelCells * kPanelCells + std::size_t(j * kPanelCells + i);
    // Barycentric coordinates follow the order of corners in add_panel().
    const Vec2f barycentric = lower ? Vec2f(float(1 - r), float(1 - s)) : Vec2f(float(r), float(s));
    return surface_point(mesh, std::uint32_t(2 * num_before + (lower ? 1 : 0)), barycentric);
}

}  // namespace patina
