#include "patina/plan/lamp_stand.h"

#include "patina/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patina {
namespace {

// Lamps beyond light a facing surface too flatly to be used (ObservationOptions).
constexpr double kDomeReach = radians(80);
constexpr double kSpacingPerRadius = 0.1;
// Directions to the cameras whose mean is shorter than this lie all around.
constexpr double kMinMean = 0.1;

struct Stand {
    Vec3 center;  // [length]
    Vec3 axis;    // unit
    Vec3 across;  // unit
    Vec3 along;   // unit
    double radius;
    FrameOfReference frame;
};

Stand find_stand(const Capture& capture, const LampStandOptions& options) {
    const Bounds bounds = bounds_of(capture.mesh);
    const std::vector<Camera>& cameras = capture.description.cameras;
    Stand stand;
    stand.center = options.center.value_or(bounds.center());
    Vec3 mean = Vec3::Zero();
    double distance = 0;
    for (const Camera& camera : cameras) {
        mean += camera.direction_from(stand.center, 0) / double(cameras.size());
        distance += std::abs(camera.distance_from(stand.center, 0)) / double(cameras.size());
    }
    const Vec3 to_cameras = mean.norm() < kMinMean ? Vec3(Vec3::UnitY()) : mean;
    stand.axis = options.axis.value_or(to_cameras).normalized();
    const Vec3 up_hint =
        std::abs(stand.axis.y()) < 0.99 ? Vec3(Vec3::UnitY()) : Vec3(-Vec3::UnitZ());
    stand.across = up_hint.cross(stand.axis).normalized();
    stand.along = stand.axis.cross(stand.across);
    stand.radius = options.radius.value_or(std::max(distance, bounds.diagonal()));
    const double least = 0.5 * bounds.diagonal();
    if (stand.radius <= least) {
        throw Error("--radius",
                    "",
                    fmt::format("is {}, inside the object", stand.radius),
                    fmt::format("above {:.4g}", least));
    }
    const bool turn = std::all_of(cameras.begin(), cameras.end(), [](const Camera& camera) {
        return camera.frame == FrameOfReference::scanner;
    });
    stand.frame = turn ? FrameOfReference::scanner : FrameOfReference::world;
    return stand;
}

std::vector<Vec3> dome_offsets(const Stand& stand, int count) {
    std::vector<Vec3> offsets;
    const double lowest = std::cos(kDomeReach);
    for (int i = 0; i < count; ++i) {
        const double height = 1 - (1 - lowest) * (i + 0.5) / count;
        const double width = std::sqrt(1 - square(height));
        // By the golden angle from one to the next.
        const double turn = 2 * kPi * i * (2 - std::numbers::phi);
        offsets.emplace_back(stand.radius *
                             (height * stand.axis + width * (std::cos(turn) * stand.across +
                                                             std::sin(turn) * stand.along)));
    }
    return offsets;
}

// Row by row from above.
std::vector<Vec3> grid_offsets(const Stand& stand, const LampStandOptions& options) {
    const double spacing = options.spacing.value_or(kSpacingPerRadius * stand.radius);
    std::vector<Vec3> offsets;
    for (int j = 0; j < options.grid_along; ++j) {
        for (int i = 0; i < options.grid_across; ++i) {
            const double x = spacing * (i - 0.5 * (options.grid_across - 1));
            const double y = spacing * (0.5 * (options.grid_along - 1) - j);
            offsets.emplace_back(stand.radius * stand.axis + x * stand.across + y * stand.along);
        }
    }
    return offsets;
}

}  // namespace

void validate(const LampStandOptions& options) {
    constexpr const char* kPlaces = "--dome or --grid besides";
    const bool has_grid = options.grid_across != 0 || options.grid_along != 0;
    if (options.dome > 0 && has_grid) {
        throw Error("--grid", "", "is given besides --dome", "one of the two");
    }
    if (has_grid && (options.grid_across < 1 || options.grid_along < 1)) {
        throw Error("--grid",
                    "",
                    fmt::format("is {}x{}", options.grid_across, options.grid_along),
                    "1 or more each");
    }
    const auto needs = [](bool is_given, bool is_right, const char* option, const char* expected) {
        if (is_given && !is_right) throw Error(option, "", "has nothing to place", expected);
    };
    needs(options.radius.has_value(), options.is_given(), "--radius", kPlaces);
    needs(options.center.has_value(), options.is_given(), "--center", kPlaces);
    needs(options.axis.has_value(), options.is_given(), "--axis", kPlaces);
    needs(options.spacing.has_value(), has_grid, "--spacing", "--grid besides");
    if (options.axis && options.axis->norm() == 0) {
        throw Error("--axis", "", "is 0,0,0", "a direction");
    }
}

std::vector<Light> stand_lamps(const Capture& capture, const LampStandOptions& options) {
    const Stand stand = find_stand(capture, options);
    const bool is_dome = options.dome > 0;
    std::vector<Light> lamps;
    for (const Vec3& offset :
         is_dome ? dome_offsets(stand, options.dome) : grid_offsets(stand, options)) {
        Light lamp;
        lamp.id = fmt::format("{}{:02}", is_dome ? "D" : "G", lamps.size());
        lamp.position = stand.center + offset;
        lamp.intensity = Rgb::Constant(kPi * offset.squaredNorm());
        lamp.frame = stand.frame;
        lamps.push_back(std::move(lamp));
    }
    return lamps;
}

}  // namespace patina
