#include "patina/base/error.h"
#include "patina/capture/capture.h"
#include "patina/capture/uv_overlap.h"
#include "patina/scene/mesh_io.h"
#include "patina/scene/unwrap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace patina {
namespace {

// Texture coordinates this far outside the square are rounding, and are pulled in [uv].
constexpr float kUvRounding = 1e-6F;
// How far triangles may reach into each other in the texture: rounding of the coordinates [uv], and
// what no texel notices [texels].
constexpr double kOverlapRounding = 1e-6;
constexpr double kOverlapTexels = 0.02;

// Far beyond any object in any unit, and small enough for its cube to be finite as a float
// [length].
constexpr float kMaxCoordinate = 1e9F;

// Where a fault of the geometry is reported: the file of the surface, and the field that names it.
struct Place {
    std::string file;
    std::string field;

    [[noreturn]] void fail(const std::string& problem, const std::string& expected) const {
        throw Error(file, field, problem, expected);
    }
};

// The first triangle of which `is_bad` holds, and how many there are.
template <typename IsBad>
void check_triangles(const Mesh& mesh,
                     const Place& place,
                     const IsBad& is_bad,
                     const std::string& problem,
                     const std::string& expected) {
    std::optional<std::size_t> first;
    std::size_t count = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (!is_bad(mesh.triangles[i])) continue;
        if (!first) first = i;
        ++count;
    }
    if (count == 0) return;
    place.fail(
        fmt::format(
            "triangle {} {} ({} of {} triangles)", *first, problem, count, mesh.triangles.size()),
        expected);
}

// For range images too, whose points follow from numbers of capture.json.
void check_positions(const Mesh& mesh, const Place& place) {
    for (const Vec3f& p : mesh.positions) {
        // NaN compares false.
        if (p.cwiseAbs().maxCoeff() <= kMaxCoordinate && p.allFinite()) continue;
        place.fail(fmt::format("has a point at ({:g}, {:g}, {:g})", p.x(), p.y(), p.z()),
                   fmt::format("coordinates of at most {:g} in size", kMaxCoordinate));
    }
}

void check_areas(const Mesh& mesh, const Place& place) {
    // Exact: differences and products of 24-bit numbers fit in double but for the last rounding.
    const auto is_flat = [&](const Triangle& triangle) {
        const Vec3 p0 = mesh.positions[triangle[0]].cast<double>();
        const Vec3 edge1 = mesh.positions[triangle[1]].cast<double>() - p0;
        const Vec3 edge2 = mesh.positions[triangle[2]].cast<double>() - p0;
        return (edge1.cross(edge2).array() == 0).all();
    };
    check_triangles(mesh, place, is_flat, "has no area", "no degenerate triangles");
}

void check_uvs(Mesh& mesh, const Place& place, int width, int height) {
    const auto outside = [&](const Triangle& triangle) {
        return std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t corner) {
            const Vec2f& uv = mesh.uvs[corner];
            return !(uv.minCoeff() >= -kUvRounding && uv.maxCoeff() <= 1 + kUvRounding);
        });
    };
    check_triangles(mesh,
                    place,
                    outside,
                    "has texture coordinates outside the unit square",
                    "u and v from 0 to 1");
    for (Vec2f& uv : mesh.uvs) uv = uv.cwiseMax(0).cwiseMin(1);
    const auto is_flat = [&](const Triangle& triangle) {
        const Vec2 uv0 = mesh.uvs[triangle[0]].cast<double>();
        const Vec2 edge1 = mesh.uvs[triangle[1]].cast<double>() - uv0;
        const Vec2 edge2 = mesh.uvs[triangle[2]].cast<double>() - uv0;
        return edge1.x() * edge2.y() - edge1.y() * edge2.x() == 0;
    };
    check_triangles(mesh,
                    place,
                    is_flat,
                    "has no area in the texture",
                    "a place of its own for every triangle");
    const double tolerance = std::max(kOverlapRounding, kOverlapTexels / std::max(width, height));
    if (const std::optional<UvOverlap> overlap = find_uv_overlap(mesh, tolerance)) {
        place.fail(
            fmt::format(
                "triangles {} and {} overlap in the texture", overlap->first, overlap->second),
            "a place of its own for every triangle, or \"unwrap\": true and no UVs");
    }
}

Mesh load_mesh(const CaptureDescription& description) {
    const GeometrySource& source = description.geometry;
    const std::filesystem::path path = description.folder / source.mesh_file;
    const Place place{path.string(), "geometry.mesh"};
    Mesh mesh = read_mesh(path, place.field);
    check_positions(mesh, place);
    check_areas(mesh, place);
    if (mesh.uvs.empty()) {
        if (!source.unwrap) {
            place.fail("has no texture coordinates", "UVs, or \"unwrap\": true beside \"mesh\"");
        }
        const std::optional<Mesh> unwrapped = unwrap(mesh, source.texel_width, source.texel_height);
        if (!unwrapped) {
            throw Error(description.file.string(),
                        "geometry.texels",
                        fmt::format("are too few to unwrap {} triangles", mesh.triangles.size()),
                        "at least 9 texels for every 2 triangles, and some to spare");
        }
        return *unwrapped;
    }
    check_uvs(mesh, place, source.texel_width, source.texel_height);
    return mesh;
}

// Whether a range value means something: measured, or marked as not measured.
bool is_range_value(const RangeFrame& frame, float value) {
    if (std::isnan(value)) return true;
    const bool any_sign = frame.projection == RangeProjection::camera &&
                          frame.camera.model == CameraModel::orthographic;
    return std::isfinite(value) && (any_sign || value >= 0);
}

Image read_range(const GeometrySource& source, const Place& place) {
    StoredImage stored = read_image(place.file, place.field);
    const Image& range = stored.image;
    if (stored.kind != SampleKind::floating) {
        place.fail("holds integers", "an image of floating-point numbers");
    }
    if (range.channels != 1) {
        place.fail(fmt::format("has {} channels", range.channels), "1 channel");
    }
    if (range.width != source.texel_width || range.height != source.texel_height) {
        place.fail(fmt::format("has {} x {} pixels", range.width, range.height),
                   fmt::format("{} x {}", source.texel_width, source.texel_height));
    }
    for (int y = 0; y < range.height; ++y) {
        for (int x = 0; x < range.width; ++x) {
            if (is_range_value(source.range_frame, range.at(x, y))) continue;
            place.fail(fmt::format("pixel ({}, {}) is {}", x, y, range.at(x, y)),
                       "a distance above 0, or NaN where nothing was measured");
        }
    }
    return std::move(stored.image);
}

Mesh load_range(const CaptureDescription& description) {
    const GeometrySource& source = description.geometry;
    const std::filesystem::path path = description.folder / source.range_file;
    const Place place{path.string(), "geometry.range"};
    Mesh mesh = mesh_from_range(source.range_frame, read_range(source, place));
    if (mesh.triangles.empty()) {
        place.fail("has no surface: no measured pixels are joined",
                   "measured neighbours nearer than max_step");
    }
    check_positions(mesh, place);
    return mesh;
}

}  // namespace

Capture load_capture(const CaptureDescription& description) {
    const GeometrySource& source = description.geometry;
    const bool from_mesh = !source.mesh_file.empty();
    Capture capture;
    capture.description = description;
    capture.mesh = from_mesh ? load_mesh(description) : load_range(description);
    capture.atlas = build_atlas(capture.mesh, source.texel_width, source.texel_height);
    if (capture.atlas.texels.empty()) {
        throw Error(description.file.string(),
                    "geometry",
                    "has no texel whose centre lies on the surface",
                    "more texels");
    }
    if (!from_mesh && source.range_frame.projection == RangeProjection::cylindrical) {
        set_scanner_columns(capture.atlas, source.range_frame);
    }
    return capture;
}

Capture load_capture(const std::filesystem::path& path) {
    return load_capture(read_capture_description(path));
}

}  // namespace patina
