#include "patina/scan/object.h"

#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/scan/material.h"
#include "patina/scan/surface_nets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace patina {
namespace {

// Neighbouring range samples further apart are not joined [m]: the step from the tail to the body
// behind it, whose upper side the range finder hardly sees, is one surface; the gap between an ear
// and the head is not.
constexpr double kLargestStep = 0.012;
// Coarse scans take at least so many times the distance of neighbouring samples.
constexpr double kStepOverSpacing = 4.0;

// Object A [m]: the plates' depth, and their width along the edge that they share.
constexpr double kPlateDepth = 0.15;
constexpr double kPlateWidth = 0.2;
// Coarsest cells of a figurine's mesh [m]: ears and nostrils keep their shape, more than 50 000
// triangles.
constexpr double kCoarsestCell = 0.0012;
// Typical distance of a figurine's surface from its axis [m].
constexpr double kTypicalRadius = 0.05;
// Rays towards the axis start this far from it [m], outside of every figurine.
constexpr double kOutside = 0.5;
// Secants from a facet to the solid behind it, along the range finder's ray: at most so many, the
// first over this step, until this close [m].
constexpr int kRangeSteps = 6;
constexpr double kRangeGradientStep = 1e-5;
constexpr double kOnSolid = 1e-9;
// The range image begins this far above the base, whose rounded edge turns away below it, and ends
// this far below the top [m].
constexpr double kBaseMargin = 0.0015;
constexpr double kTopMargin = 0.0005;

Finish plate_finish() { return {Rgb(0.74, 0.5, 0.34), 0.03, 0.2}; }

std::vector<Panel> plates() {
    const Vec3 right(kPlateWidth, 0, 0);
    const Vec3 corner(-kPlateWidth / 2, 0, 0);
    return {{corner + Vec3(0, kPlateDepth, 0), right, Vec3(0, -kPlateDepth, 0), 1},
            {corner, right, Vec3(0, 0, kPlateDepth), 1}};
}

std::vector<Panel> groove() {
    const Vec3 right(kGrooveLength, 0, 0);
    const Vec3 corner(-kGrooveLength / 2, 0, 0);
    const double lean = radians(45.0 / 2);
    const Vec3 rear = kGrooveSide * Vec3(0, std::cos(lean), -std::sin(lean));
    const Vec3 front = kGrooveSide * Vec3(0, std::cos(lean), std::sin(lean));
    return {{corner + rear, right, -rear, 1}, {corner, right, front, 1}};
}

std::vector<Panel> channel() {
    const Vec3 right(kChannelLength, 0, 0);
    const Vec3 rear(-kChannelLength / 2, 0, -kChannelWidth / 2);
    const Vec3 up(0, 2 * kChannelWidth, 0);
    const Vec3 across(0, 0, kChannelWidth);
    return {{rear + up, right, -up, 2}, {rear, right, across, 1}, {rear + across, right, up, 2}};
}

SimulatedObject from_panels(ObjectKind kind,
                            const std::string& name,
                            std::vector<Panel> panels,
                            const Reflectance& reflectance) {
    Mesh mesh = mesh_of_panels(panels);
    std::vector<Reflectance> values(mesh.positions.size(), reflectance);
    Tracer tracer(mesh);
    return {kind,
            name,
            std::move(mesh),
            std::move(values),
            std::move(tracer),
            {},
            std::move(panels),
            {}};
}

// Cells about as large as the texels, so that the mesh has about twice as many triangles as the
// surface of the range image; their vertices lie on the solid itself, and so do their normals.
double figurine_cell(const Figurine& figurine, int columns, int rows) {
    const double height = figurine.bounds.high.y() - figurine.bounds.low.y();
    const double texel_area = (2 * kPi * kTypicalRadius / columns) * (height / rows);
    return std::min(kCoarsestCell, std::sqrt(texel_area));
}

SimulatedObject from_figurine(
    ObjectKind kind, const std::string& name, Figurine figurine, int columns, int rows) {
    const double cell = figurine_cell(figurine, columns, rows);
    Mesh mesh = surface_nets(figurine.distance, {figurine.bounds, cell});
    std::vector<Reflectance> values(mesh.positions.size());
    parallel_for(values.size(), [&](std::size_t i) {
        values[i] =
            figurine.reflectance(mesh.positions[i].cast<double>(), mesh.normals[i].cast<double>());
    });
    Tracer tracer(mesh);
    const Bounds bounds = bounds_of(mesh);
    RangeFrame frame;
    frame.height_begin = bounds.low.y() + kBaseMargin;
    frame.height_end = bounds.high.y() - kTopMargin;
    const double spacing = std::max(2 * kPi * kTypicalRadius / columns,
                                    (frame.height_end - frame.height_begin) / rows);
    frame.max_step = std::max(kLargestStep, kStepOverSpacing * spacing);
    return {kind,
            name,
            std::move(mesh),
            std::move(values),
            std::move(tracer),
            frame,
            {},
            std::move(figurine.distance)};
}

void check_size(const SimulatedObject& object, int columns, int rows) {
    const int multiple = total_parts(object.panels);
    if (multiple == 0 || rows % multiple == 0) return;
    throw Error("--texels",
                "",
                fmt::format("{} x {} does not divide the rows of {}", columns, rows, object.name),
                fmt::format("a number of rows that is a multiple of {}", multiple));
}

}  // namespace

ObjectKind object_kind_from_name(const std::string& name) {
    std::string upper = name;
    std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) {
        return static_cast<char>(std::toupper(c));
    });
    if (upper == "A") return ObjectKind::a;
    if (upper == "B") return ObjectKind::b;
    if (upper == "C") return ObjectKind::c;
    if (upper == "V45") return ObjectKind::v45;
    if (upper == "U") return ObjectKind::u;
    throw Error("OBJECT", "", "'" + name + "' is not known", "A, B, C, V45 or U");
}

SimulatedObject make_object(ObjectKind kind, int columns, int rows) {
    if (columns < 1 || rows < 1) {
        throw Error("--texels",
                    "",
                    fmt::format("is {} x {}", columns, rows),
                    "at least one column and one row");
    }
    const Reflectance matte{Rgb::Constant(kGrooveDiffuse), 0, kObjectMaxRoughness};
    switch (kind) {
        case ObjectKind::b:
            return from_figurine(kind, "object B, a cat", make_cat(), columns, rows);
        case ObjectKind::c:
            return from_figurine(kind, "object C, a pig", make_pig(), columns, rows);
        case ObjectKind::v45: {
            auto object = from_panels(kind, "a groove of 45 degrees", groove(), matte);
            check_size(object, columns, rows);
            return object;
        }
        case ObjectKind::u: {
            auto object = from_panels(kind, "a channel twice as deep as wide", channel(), matte);
            check_size(object, columns, rows);
            return object;
        }
        case ObjectKind::a:
            break;
    }
    auto object = from_panels(
        kind, "object A, two glossy plates", plates(), make_reflectance(plate_finish()));
    check_size(object, columns, rows);
    return object;
}

std::optional<SurfacePoint> point_at_pixel(const SimulatedObject& object,
                                           int columns,
                                           int rows,
                                           const Vec2& pixel) {
    const Vec2 share(pixel.x() / columns, pixel.y() / rows);
    if (!object.range_frame) {
        if (share.minCoeff() < 0 || share.maxCoeff() >= 1) return std::nullopt;
        return point_on_panels(object.mesh, object.panels, share);
    }
    const RangeFrame& frame = *object.range_frame;
    const double azimuth = column_azimuth(frame, columns, pixel.x() - 0.5);
    const double y = frame.height_end - share.y() * (frame.height_end - frame.height_begin);
    const Vec3 outwards = rotate_about_y(azimuth, Vec3::UnitZ());
    const std::optional<RayHit> hit =
        object.tracer.intersect(kOutside * outwards + Vec3(0, y, 0), -outwards, 0, kOutside);
    if (!hit) return std::nullopt;
    return surface_point(object.mesh, hit->triangle, hit->barycentric);
}

std::optional<double> range_at_pixel(const SimulatedObject& object,
                                     int columns,
                                     int rows,
                                     const Vec2& pixel) {
    const auto point = point_at_pixel(object, columns, rows, pixel);
    if (!point) return std::nullopt;
    const Vec3 outwards = rotate_about_y(
        column_azimuth(*object.range_frame, columns, pixel.x() - 0.5), Vec3::UnitZ());
    const Vec3 axis(0, point->position.y(), 0);
    const auto distance = [&](double radius) { return object.distance(axis + radius * outwards); };
    const double facet = std::hypot(point->position.x(), point->position.z());
    double before = facet + kRangeGradientStep;
    double before_distance = distance(before);
    double radius = facet;
    for (int k = 0; k < kRangeSteps; ++k) {
        const double here = distance(radius);
        if (std::abs(here) < kOnSolid) break;
        const double slope = (here - before_distance) / (radius - before);
        before = radius;
        before_distance = here;
        radius -= here / slope;
        // Where the solid curves away from the ray there is none to be met: the facet stays.
        if (!(std::abs(radius - facet) < kCoarsestCell)) return facet;
    }
    return radius;
}

}  // namespace patina
