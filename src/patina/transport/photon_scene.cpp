#include "patina/transport/photon_scene.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// Survival is kept within these bounds, so that dark guides still let photons on and weights stay
// small.
constexpr float kMinSurvival = 0.1f;
constexpr float kMaxSurvival = 0.95f;
// Nodes of the survival table. Survival may be any probability, for the photon's weight divides by
// it; near the albedo it keeps the weights even, and a part in ten of it does not matter.
constexpr std::size_t kNumRoughnesses = 64;
constexpr std::size_t kNumCosines = 65;

double log_roughness_step() {
    return std::log(kMaxRoughness / kMinRoughness) / double(kNumRoughnesses - 1);
}

std::uint32_t roughness_row(double roughness) {
    const double inside = std::clamp(roughness, kMinRoughness, kMaxRoughness);
    return std::uint32_t(std::lround(std::log(inside / kMinRoughness) / log_roughness_step()));
}

std::vector<float> tabulate_albedo() {
    std::vector<float> table(kNumRoughnesses * kNumCosines);
    for (std::size_t row = 0; row < kNumRoughnesses; ++row) {
        const double roughness = kMinRoughness * std::exp(double(row) * log_roughness_step());
        for (std::size_t i = 0; i < kNumCosines; ++i) {
            const double cos_i = double(i) / double(kNumCosines - 1);
            table[row * kNumCosines + i] =
                float(lobe_albedo(cos_i, roughness) / (2 * square(roughness)));
        }
    }
    return table;
}

}  // namespace

PhotonScene::PhotonScene(const Surface& surface,
                         const TexelAtlas& atlas,
                         std::span<const Reflectance> guide)
    : surface_(surface),
      atlas_(atlas),
      triangles_(surface.mesh->triangles.size()),
      texels_(guide.size()),
      receivers_(guide.size()),
      albedo_(tabulate_albedo()) {
    fill_triangles();
    fill_texels(guide);
}

float PhotonScene::survival(const PhotonReceiver& receiver, float cos_i) const {
    const float position = std::min(cos_i, 1.0f) * float(kNumCosines - 1);
    const std::size_t column = std::min(std::size_t(position), kNumCosines - 2);
    const float* values = &albedo_[receiver.roughness_row * kNumCosines + column];
    const float share = position - float(column);
    const float albedo =
        receiver.diffuse + receiver.lobe * (values[0] + share * (values[1] - values[0]));
    return std::clamp(albedo, kMinSurvival, kMaxSurvival);
}

void PhotonScene::fill_triangles() {
    const Mesh& mesh = *surface_.mesh;
    const Vec2 cells(atlas_.width, atlas_.height);
    parallel_for(triangles_.size(), [&](std::size_t i) {
        PhotonTriangle& triangle = triangles_[i];
        const auto index = std::uint32_t(i);
        const Triangle& t = mesh.triangles[i];
        triangle.position = mesh.positions[t[0]];
        triangle.position_edge1 = mesh.positions[t[1]] - mesh.positions[t[0]];
        triangle.position_edge2 = mesh.positions[t[2]] - mesh.positions[t[0]];
        const auto cell_of = [&](float u, float v) {
            const Vec2 uv = surface_uv(mesh, index, Vec2f(u, v));
            return Vec2(Vec2(uv.x(), 1 - uv.y()).cwiseProduct(cells));
        };
        const Vec2 corner = cell_of(0, 0);
        triangle.cell = corner.cast<float>();
        triangle.cell_edge1 = (cell_of(1, 0) - corner).cast<float>();
        triangle.cell_edge2 = (cell_of(0, 1) - corner).cast<float>();

        triangle.geometric_normal =
            surface_point(mesh, index, Vec2f::Zero()).geometric_normal.cast<float>();
        const bool smooth =
            !mesh.normals.empty() && std::none_of(t.begin(), t.end(), [&](std::uint32_t vertex) {
                return mesh.normals[vertex].isZero(0);
            });
        triangle.normal = smooth ? mesh.normals[t[0]] : triangle.geometric_normal;
        triangle.normal_edge1 = triangle.normal_edge2 = Vec3f::Zero();
        if (!smooth) return;
        triangle.normal_edge1 = mesh.normals[t[1]] - mesh.normals[t[0]];
        triangle.normal_edge2 = mesh.normals[t[2]] - mesh.normals[t[0]];
    });
}

void PhotonScene::fill_texels(std::span<const Reflectance> guide) {
    PATINA_CHECK_EQ(guide.size(), atlas_.texels.size());
    parallel_for(texels_.size(), [&](std::size_t i) {
        const Texel& from = atlas_.texels[i];
        const Reflectance& map = guide[i];
        PhotonTexel& to = texels_[i];
        to.geometric_normal = from.point.geometric_normal.cast<float>();
        to.origin = (from.point.position + tracer().offset_length() * from.point.geometric_normal)
                        .cast<float>();
        to.normal = from.point.normal.cast<float>();
        to.area = float(from.area);
        to.azimuth = float(from.azimuth);
        to.mean_albedo = float(map.diffuse.mean() + map.specular * max_lobe_albedo(map.roughness));
        to.diffuse = float(map.diffuse.maxCoeff());
        const double variance = square(map.roughness);
        to.lobe = float(2 * variance * map.specular);
        to.concentration = float(1 / variance);
        receivers_[i] = {to.diffuse, to.lobe, to.concentration, roughness_row(map.roughness)};
    });
}

}  // namespace patina
