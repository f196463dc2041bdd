#include "patina/observe/camera_view.h"

#include "patina/base/parallel.h"
#include "patina/math/statistics.h"
#include "patina/observe/footprint.h"

#include <algorithm>

namespace patina {
namespace {

// Pixel corners of the bilinear footprint may lie this far from the texel on its own surface: three
// corners across are 1.5 pixels from the middle, 2.1 along the diagonal, and some curvature is
// allowed.
constexpr double kFootprintReach = 3.0;  // [pixels on the surface]
// Surfaces that turn by more than about 45 degrees within the footprint are another part.
constexpr double kFootprintNormal = 0.7;
// A grazing surface is this much longer per pixel at most; texels beyond are never clear.
constexpr double kMinFootprintCosine = 0.1;

// What the rays through the corners of all pixels hit.
struct CornerHit {
    bool hit = false;
    Vec3f position = Vec3f::Zero();
    Vec3f normal = Vec3f::UnitZ();
};

std::vector<CornerHit> trace_corners(const Mesh& mesh, const Tracer& tracer, const Camera& camera) {
    const auto columns = std::size_t(camera.width + 1);
    std::vector<CornerHit> corners(columns * std::size_t(camera.height + 1));
    parallel_for(corners.size(), [&](std::size_t i) {
        const Ray ray = camera.ray(Vec2(double(i % columns), double(i / columns)));
        const auto hit = tracer.intersect(ray.origin, ray.direction);
        if (!hit) return;
        const SurfacePoint point = surface_point(mesh, hit->triangle, hit->barycentric);
        corners[i] = {true, point.position.cast<float>(), point.normal.cast<float>()};
    });
    return corners;
}

// Width of a pixel on a plane that faces the camera at the texel's distance [length].
double pixel_width(const Camera& camera, double distance) {
    return camera.model == CameraModel::orthographic ? camera.pixel_size
                                                     : distance / std::min(camera.fx, camera.fy);
}

// Whether every corner of the pixels that the texel is read from belongs to its own surface.
bool footprint_is_clear(const Camera& camera,
                        const std::vector<CornerHit>& corners,
                        const Texel& texel,
                        const TexelView& view,
                        double distance) {
    const double reach = kFootprintReach * pixel_width(camera, distance) /
                         std::max(double(view.cos_v), kMinFootprintCosine);
    const FootprintAxis columns = footprint_axis(view.pixel.x(), camera.width);
    const FootprintAxis rows = footprint_axis(view.pixel.y(), camera.height);
    for (int y = rows.first; y <= rows.last + 1; ++y) {
        for (int x = columns.first; x <= columns.last + 1; ++x) {
            const CornerHit& corner =
                corners[std::size_t(y) * std::size_t(camera.width + 1) + std::size_t(x)];
            if (!corner.hit) return false;
            if ((corner.position.cast<double>() - texel.point.position).norm() > reach)
                return false;
            if (corner.normal.cast<double>().dot(texel.point.normal) < kFootprintNormal)
                return false;
        }
    }
    return true;
}

bool line_of_sight(const Tracer& tracer,
                   const Camera& camera,
                   const Texel& texel,
                   const Vec3& w_v) {
    const Vec3 origin = tracer.offset(texel.point, w_v);
    return !tracer.occluded(origin, w_v, camera.distance_from(origin, texel.azimuth));
}

}  // namespace

std::vector<TexelView> view_texels(const Mesh& mesh,
                                   const Tracer& tracer,
                                   const TexelAtlas& atlas,
                                   const Camera& camera) {
    const bool registered = camera.model == CameraModel::registered;
    const std::vector<CornerHit> corners =
        registered ? std::vector<CornerHit>() : trace_corners(mesh, tracer, camera);
    std::vector<TexelView> views(atlas.texels.size());
    parallel_for(atlas.texels.size(), [&](std::size_t i) {
        const Texel& texel = atlas.texels[i];
        const Vec3& p = texel.point.position;
        TexelView& view = views[i];
        const Vec3 w_v = camera.direction_from(p, texel.azimuth);
        view.w_v = w_v.cast<float>();
        view.cos_v = float(texel.point.normal.dot(w_v));
        if (view.cos_v <= 0 || texel.point.geometric_normal.dot(w_v) <= 0) return;
        if (registered) {
            view.pixel = Vec2f(float(texel.column) + 0.5f, float(texel.row) + 0.5f);
            if (line_of_sight(tracer, camera, texel, w_v)) view.state = ViewState::clear;
            return;
        }
        const auto pixel = camera.project(p);
        if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > camera.width ||
            pixel->y() > camera.height) {
            return;
        }
        view.pixel = pixel->cast<float>();
        if (!line_of_sight(tracer, camera, texel, w_v)) return;
        const double distance = camera.distance_from(p, texel.azimuth);
        view.state = footprint_is_clear(camera, corners, texel, view, distance) ? ViewState::clear
                                                                                : ViewState::edge;
    });
    return views;
}

double pixel_over_texel(const TexelAtlas& atlas,
                        const Camera& camera,
                        const std::vector<TexelView>& views) {
    if (camera.model == CameraModel::registered) return 1;
    std::vector<double> ratios;
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (views[i].state == ViewState::hidden || atlas.texels[i].area <= 0) continue;
        const double distance = camera.distance_from(atlas.texels[i].point.position, 0);
        ratios.push_back(pixel_width(camera, distance) / std::sqrt(atlas.texels[i].area));
    }
    return ratios.empty() ? 1 : median(std::move(ratios));
}

}  // namespace patina
