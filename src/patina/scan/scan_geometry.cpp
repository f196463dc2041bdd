// The geometry that the virtual scanner hands out, and the truth that belongs to it.
#include "patina/base/parallel.h"
#include "patina/base/random.h"
#include "patina/scan/calibration_error.h"
#include "patina/scan/scanner.h"

#include <cmath>

namespace patina {
namespace {

Vec2 pixel_center(int column, int row) { return {column + 0.5, row + 0.5}; }

// Noise of the range [m] from which central differences make normals that are off by `tilt` [rad]
// per axis, in the mean over both: over two pixels at distance h it is tilt h sqrt(2).
double range_noise(const RangeFrame& frame,
                   double radius,
                   double tilt,
                   const ScanOptions& options) {
    const double across = radius * (frame.azimuth_end - frame.azimuth_begin) / options.columns;
    const double along = (frame.height_end - frame.height_begin) / options.rows;
    const double spacing = std::sqrt(2.0 / (1.0 / square(across) + 1.0 / square(along)));
    return std::tan(tilt) * spacing * std::sqrt(2.0);
}

Image scan_range(const SimulatedObject& object, const ScanOptions& options) {
    Image range(options.columns, options.rows, 1);
    const double tilt = radians(options.normal_error_degrees);
    parallel_for(range.data.size(), [&](std::size_t i) {
        const int column = int(i) % options.columns;
        const int row = int(i) / options.columns;
        const auto measured =
            range_at_pixel(object, options.columns, options.rows, pixel_center(column, row));
        if (!measured) return;
        const double radius = *measured;
        Rng rng = calibration_rng(options.seed, CalibrationError::geometry, i);
        const double noise = range_noise(*object.range_frame, radius, tilt, options) * rng.normal();
        range.data[i] = float(std::max(0.0, radius + noise));
    });
    return range;
}

// Tilts each normal about two axes of the surface.
void tilt_normals(const ScanOptions& options, Mesh& mesh) {
    const double tilt = std::tan(radians(options.normal_error_degrees));
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        Rng rng = calibration_rng(options.seed, CalibrationError::geometry, i);
        const Vec3 normal = mesh.normals[i].cast<double>();
        const Vec3 tangent = normal.unitOrthogonal();
        const double along = tilt * rng.normal();
        const double across = tilt * rng.normal();
        const Vec3 tilted = normal + along * tangent + across * normal.cross(tangent);
        mesh.normals[i] = tilted.normalized().cast<float>();
    }
}

}  // namespace

ScannedGeometry scan_geometry(const SimulatedObject& object, const ScanOptions& options) {
    ScannedGeometry geometry;
    if (object.range_frame) {
        geometry.range = scan_range(object, options);
        geometry.mesh = mesh_from_range(*object.range_frame, geometry.range);
        return geometry;
    }
    geometry.mesh = object.mesh;
    if (options.normal_error_degrees > 0) tilt_normals(options, geometry.mesh);
    return geometry;
}

TruthMaps truth_maps(const SimulatedObject& object, const ScanOptions& options) {
    TruthMaps truth;
    truth.diffuse = Image(options.columns, options.rows, 3);
    truth.specular = Image(options.columns, options.rows, 1);
    truth.roughness = Image(options.columns, options.rows, 1);
    truth.mask = Image(options.columns, options.rows, 1);
    const ReflectanceField field = object.field();
    parallel_for(truth.mask.data.size(), [&](std::size_t i) {
        const int column = int(i) % options.columns;
        const int row = int(i) / options.columns;
        const auto point =
            point_at_pixel(object, options.columns, options.rows, pixel_center(column, row));
        if (!point) return;
        const Reflectance reflectance = field.at(point->triangle, point->barycentric);
        for (int channel = 0; channel < 3; ++channel) {
            truth.diffuse.at(column, row, channel) = float(reflectance.diffuse[channel]);
        }
        truth.specular.data[i] = float(reflectance.specular);
        truth.roughness.data[i] = float(reflectance.roughness);
        truth.mask.data[i] = 1;
    });
    return truth;
}

}  // namespace patina
