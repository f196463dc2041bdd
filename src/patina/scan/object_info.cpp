#include "patina/scan/object_info.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/scan/render.h"
#include "patina/transport/path_tracer.h"

#include <cmath>

namespace patina {
namespace {

// Highlights count up to this many sigma from the mirror direction.
constexpr double kHighlightWidth = 2.0;
// The underside: triangles that look down this steeply and lie this close to the ground [-, m].
constexpr double kUndersideSlope = -0.9;
constexpr double kUndersideHeight = 0.002;

// Sums of crease_light() over some texels.
struct CreaseSums {
    int num_seen = 0;
    int num_creases = 0;
    double direct = 0;
    double indirect = 0;

    CreaseSums& operator+=(const CreaseSums& other) {
        num_seen += other.num_seen;
        num_creases += other.num_creases;
        direct += other.direct;
        indirect += other.indirect;
        return *this;
    }
};

struct AreaSums {
    double total = 0;
    double chosen = 0;

    AreaSums& operator+=(const AreaSums& other) {
        total += other.total;
        chosen += other.chosen;
        return *this;
    }
};

// Share of the area but the underside whose triangles' middles are chosen [-].
template <typename Predicate>
double area_share(const Mesh& mesh, const Predicate& is_chosen) {
    const auto area = [&](std::size_t i) {
        const auto triangle = std::uint32_t(i);
        const SurfacePoint point = surface_point(mesh, triangle, Vec2f::Constant(1 / 3.0f));
        const bool is_underside =
            point.geometric_normal.y() < kUndersideSlope && point.position.y() < kUndersideHeight;
        AreaSums sums;
        if (is_underside) return sums;
        sums.total = triangle_area(mesh, triangle);
        sums.chosen = is_chosen(point) ? sums.total : 0;
        return sums;
    };
    const AreaSums sums = ordered_reduce(mesh.triangles.size(), AreaSums{}, area);
    return sums.chosen / sums.total;
}

bool shows_highlight(const SimulatedObject& object,
                     const SurfacePoint& point,
                     const Vec3& w_o,
                     std::span<const Light> lights) {
    const double sigma = object.field().at(point.triangle, point.barycentric).roughness;
    for (const Light& light : lights) {
        const LightSample sample = sample_light(light, point.position, 0);
        if (!is_lit(object.surface(), point, sample)) continue;
        const double theta_r_squared = mirror_angle_squared(point.normal, sample.w_i, w_o);
        if (theta_r_squared < square(kHighlightWidth * sigma)) return true;
    }
    return false;
}

// The panel whose part of the texture holds a row of texels.
std::size_t panel_of_row(const std::vector<Panel>& panels, int num_rows, int row) {
    const int part = row * total_parts(panels) / num_rows;
    int end = 0;
    for (std::size_t i = 0; i < panels.size(); ++i) {
        end += panels[i].parts;
        if (part < end) return i;
    }
    return panels.size() - 1;
}

OutgoingRadiance mean_radiance(const SimulatedObject& object,
                               const Light& light,
                               double azimuth,
                               const SurfacePoint& point,
                               const Vec3& w_o,
                               int num_samples,
                               std::uint64_t seed,
                               std::uint64_t element) {
    OutgoingRadiance mean;
    for (int sample = 0; sample < num_samples; ++sample) {
        SobolSampler sampler(seed, Pass::path_tracer, element, std::uint32_t(sample));
        const OutgoingRadiance radiance = trace_path(object.surface(),
                                                     object.field(),
                                                     std::span(&light, 1),
                                                     azimuth,
                                                     point,
                                                     w_o,
                                                     PathTracerOptions{},
                                                     sampler);
        mean.direct += radiance.direct / num_samples;
        mean.indirect += radiance.indirect / num_samples;
    }
    return mean;
}

}  // namespace

std::vector<double> highlight_coverage(const SimulatedObject& object,
                                       const Camera& camera,
                                       std::span<const Light> lights) {
    std::vector<double> shown(object.panels.size(), 0);
    std::vector<double> total(object.panels.size(), 0);
    for (int row = 0; row < camera.height; ++row) {
        const std::size_t panel = panel_of_row(object.panels, camera.height, row);
        for (int column = 0; column < camera.width; ++column) {
            const auto point =
                point_at_pixel(object, camera.width, camera.height, {column + 0.5, row + 0.5});
            PATINA_CHECK(point.has_value());
            total[panel] += 1;
            if (!is_seen(object, camera, *point, 0)) continue;
            const Vec3 w_o = camera.direction_from(point->position, 0);
            shown[panel] += shows_highlight(object, *point, w_o, lights) ? 1 : 0;
        }
    }
    for (std::size_t i = 0; i < shown.size(); ++i) shown[i] /= total[i];
    return shown;
}

double mean_curvature(const SignedDistance& distance, const Vec3& p, double step) {
    double divergence = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 offset = step * Vec3::Unit(axis);
        const Vec3 after = distance_gradient(distance, p + offset, step).normalized();
        const Vec3 before = distance_gradient(distance, p - offset, step).normalized();
        divergence += (after[axis] - before[axis]) / (2 * step);
    }
    return divergence / 2;
}

CreaseLight crease_light(const SimulatedObject& object,
                         const Camera& camera,
                         std::span<const Light> lights,
                         int samples_per_texel,
                         std::uint64_t seed) {
    const auto num_texels = std::size_t(camera.width) * std::size_t(camera.height);
    std::vector<CreaseSums> texels(num_texels);
    parallel_for(
        num_texels,
        [&](std::size_t i) {
            const int column = int(i) % camera.width;
            const int row = int(i) / camera.width;
            const double azimuth = scanner_azimuth(object, camera.width, column);
            const auto point =
                point_at_pixel(object, camera.width, camera.height, {column + 0.5, row + 0.5});
            if (!point || !is_seen(object, camera, *point, azimuth)) return;
            texels[i].num_seen = 1;
            if (mean_curvature(object.distance, point->position, kCurvatureStep) > kCreaseCurvature)
                return;
            texels[i].num_creases = 1;
            const Vec3 w_o = camera.direction_from(point->position, azimuth);
            for (std::size_t j = 0; j < lights.size(); ++j) {
                const OutgoingRadiance mean = mean_radiance(object,
                                                            lights[j],
                                                            azimuth,
                                                            *point,
                                                            w_o,
                                                            samples_per_texel,
                                                            seed,
                                                            j * num_texels + i);
                texels[i].direct += mean.direct.mean() / double(lights.size());
                texels[i].indirect += mean.indirect.mean() / double(lights.size());
            }
        },
        16);
    CreaseSums sums;
    for (const CreaseSums& texel : texels) sums += texel;
    CreaseLight result;
    if (sums.num_creases == 0) return result;
    result.num_texels = sums.num_creases;
    result.texel_share = double(sums.num_creases) / sums.num_seen;
    result.direct = sums.direct / sums.num_creases;
    result.indirect = sums.indirect / sums.num_creases;
    return result;
}

double hidden_area_share(const SimulatedObject& object) {
    return area_share(object.mesh, [&](const SurfacePoint& point) {
        const Vec3 outwards = Vec3(point.position.x(), 0, point.position.z()).normalized();
        return point.geometric_normal.dot(outwards) <= 0 ||
               object.tracer.occluded(object.tracer.offset(point, outwards), outwards);
    });
}

double missing_area_share(const SimulatedObject& object, const Mesh& scanned, double tolerance) {
    const Tracer tracer(scanned);
    return area_share(object.mesh, [&](const SurfacePoint& point) {
        const Vec3 origin = point.position + tolerance * point.normal;
        return !tracer.intersect(origin, -point.normal, 0, 2 * tolerance);
    });
}

}  // namespace patina
