#include "patina/scan/rig.h"

#include <fmt/format.h>

#include <utility>

namespace patina {
namespace {

// Cylindrical scans [m]: distances from the axis; the surface lies about kScannedRadius from it.
constexpr double kCameraDistance = 0.85;
constexpr double kLampPlane = 0.3;
constexpr double kScannedRadius = 0.05;
// How far the held-out lamp is above the middle of the candidates: a step above their highest row.
constexpr double kHeldoutRise = 0.275;

// Object A [m].
constexpr double kPlateCamera = 0.3;    // over each plate
constexpr double kPlateHeldout = 0.5;   // over the lying plate, above the camera
constexpr double kPlateLamps = 0.5;     // over the plate whose highlights they make
constexpr double kBehindPlate = -0.21;  // where their grid begins, behind the other plate

// Grooves [m].
constexpr double kGrooveLamps = 0.8;
constexpr double kGrooveHeldout = 0.9;
// Sideways, so that a wall of the channel is seen at 70 degrees from its normal, down to its foot.
constexpr double kSideCamera = 0.3;

// A lamp under which white at this distance, facing it, has radiance 1.
Light make_lamp(const std::string& id,
                const Vec3& position,
                double distance,
                FrameOfReference frame) {
    Light light;
    light.id = id;
    light.position = position;
    light.intensity = Rgb::Constant(kPi * square(distance));
    light.frame = frame;
    return light;
}

Camera make_camera(
    const std::string& id, const Vec3& position, FrameOfReference frame, int columns, int rows) {
    Camera camera;
    camera.id = id;
    camera.model = CameraModel::registered;
    camera.width = columns;
    camera.height = rows;
    camera.position = position;
    camera.frame = frame;
    return camera;
}

// A grid of lamps about `center`, numbered on from those there are.
struct LampGrid {
    Vec3 center;  // [m]
    Vec3 across;  // unit
    Vec3 along;   // unit
    int num_across;
    int num_along;
    double distance;  // at which white has radiance 1 [m]
    FrameOfReference frame;
};

void add_grid(const LampGrid& grid, std::vector<Light>& lights) {
    for (int j = 0; j < grid.num_along; ++j) {
        for (int i = 0; i < grid.num_across; ++i) {
            const Vec3 position =
                grid.center + kLampSpacing * ((i - 0.5 * (grid.num_across - 1)) * grid.across +
                                              (j - 0.5 * (grid.num_along - 1)) * grid.along);
            const std::string id = fmt::format("L{:02}", lights.size());
            lights.push_back(make_lamp(id, position, grid.distance, grid.frame));
        }
    }
}

ScanRig cylindrical_rig(const RangeFrame& frame, int columns, int rows) {
    constexpr auto kFrame = FrameOfReference::scanner;
    const double height = 0.5 * (frame.height_begin + frame.height_end);
    const double distance = kLampPlane - kScannedRadius;
    ScanRig rig;
    rig.cameras.push_back(make_camera("line", {0, height, kCameraDistance}, kFrame, columns, rows));
    const Vec3 center(0, height, kLampPlane);
    add_grid({center, Vec3::UnitX(), -Vec3::UnitY(), 6, 10, distance, kFrame}, rig.candidates);
    rig.heldout = make_lamp("above", center + Vec3(0, kHeldoutRise, 0), distance, kFrame);
    return rig;
}

ScanRig plates_rig(int columns, int rows) {
    constexpr auto kFrame = FrameOfReference::world;
    ScanRig rig;
    rig.cameras.push_back(
        make_camera("front", {0, kPlateCamera, kPlateCamera}, kFrame, columns, rows));
    const int num_along = 6;
    const double middle = kBehindPlate + 0.5 * (num_along - 1) * kLampSpacing;
    for (const bool is_above : {true, false}) {
        const Vec3 center = is_above ? Vec3(0, kPlateLamps, middle) : Vec3(0, middle, kPlateLamps);
        const Vec3 along = is_above ? Vec3::UnitZ() : Vec3::UnitY();
        add_grid({center, Vec3::UnitX(), along, 5, num_along, kPlateLamps, kFrame}, rig.candidates);
    }
    const Vec3 above(0, kPlateHeldout, kPlateCamera);
    rig.heldout = make_lamp("above", above, kPlateLamps, kFrame);
    return rig;
}

ScanRig groove_rig(bool is_channel, int columns, int rows) {
    constexpr auto kFrame = FrameOfReference::world;
    ScanRig rig;
    const Vec3 center(0, kGrooveLamps, 0);
    rig.cameras.push_back(make_camera("above", center, kFrame, columns, rows));
    if (is_channel) {
        const Vec3 aside(0, 0, kSideCamera);
        rig.cameras.push_back(make_camera("rear", center - aside, kFrame, columns, rows));
        rig.cameras.push_back(make_camera("front", center + aside, kFrame, columns, rows));
    }
    // The walls of the channel need lamps from further aside than the groove's.
    const auto [num_across, num_along] = is_channel ? std::pair(4, 15) : std::pair(10, 6);
    add_grid({center, Vec3::UnitX(), Vec3::UnitZ(), num_across, num_along, kGrooveLamps, kFrame},
             rig.candidates);
    rig.heldout = make_lamp("top", {0, kGrooveHeldout, 0}, kGrooveLamps, kFrame);
    return rig;
}

}  // namespace

ScanRig make_rig(const SimulatedObject& object, int columns, int rows) {
    if (object.range_frame) return cylindrical_rig(*object.range_frame, columns, rows);
    if (object.kind == ObjectKind::a) return plates_rig(columns, rows);
    return groove_rig(object.kind == ObjectKind::u, columns, rows);
}

}  // namespace patina
