#include "patina/pipeline/plan_given.h"

#include "patina/base/error.h"
#include "patina/capture/json.h"

#include <algorithm>
#include <set>
#include <utility>

namespace patina {
namespace {

namespace fs = std::filesystem;

// Boxes of one object scanned twice differ by less than this share of its size.
constexpr double kSameObject = 0.02;
// Places closer than this share of the object's size are one.
constexpr double kSamePlace = 1e-6;

// Adds what a rig offers to a capture that was taken.
class Merger {
  public:
    Merger(PlanScene& scene, const Capture& rig, const fs::path& given)
        : scene_(scene), rig_(rig), given_(given.string()) {
        const Bounds bounds = bounds_of(scene.capture.mesh);
        const Bounds other = bounds_of(rig.mesh);
        tolerance_ = kSamePlace * bounds.diagonal();
        const double apart =
            std::max((bounds.low - other.low).norm(), (bounds.high - other.high).norm());
        if (scene.capture.description.length_unit != rig.description.length_unit ||
            apart > kSameObject * bounds.diagonal()) {
            throw Error("--given",
                        "",
                        quote(given_) + " is of another geometry",
                        "the object of " + rig.description.file.string());
        }
    }

    void merge() const {
        CaptureDescription& description = scene_.capture.description;
        const std::vector<Light> taken = description.lights;
        for (const Light& light : rig_.description.lights) {
            if (!is_known(light, "lamp", taken)) description.lights.push_back(light);
        }
        for (const Camera& camera : rig_.description.cameras) {
            if (!is_known(camera, "camera", description.cameras)) {
                scene_.new_cameras.push_back(camera);
            }
        }
    }

  private:
    [[nodiscard]] bool same_place(const Light& a, const Light& b) const {
        const Vec3 zero = Vec3::Zero();
        return a.type == b.type && a.frame == b.frame &&
               (a.position - b.position).norm() <= tolerance_ &&
               (a.direction.value_or(zero) - b.direction.value_or(zero)).norm() <= kSamePlace;
    }
    [[nodiscard]] bool same_place(const Camera& a, const Camera& b) const {
        return a.model == b.model && a.frame == b.frame &&
               (a.position - b.position).norm() <= tolerance_ &&
               (a.world_from_camera.translation - b.world_from_camera.translation).norm() <=
                   tolerance_ &&
               (a.world_from_camera.rotation - b.world_from_camera.rotation).norm() <= kSamePlace;
    }

    // Whether the capture has it already.
    template <typename Device>
    bool is_known(const Device& device,
                  const std::string& what,
                  const std::vector<Device>& known) const {
        for (const Device& other : known) {
            if (same_place(device, other)) return true;
            if (device.id == other.id) {
                throw Error(
                    "--given",
                    "",
                    quote(given_) + " has " + what + " " + quote(device.id) + " at another place",
                    "one place for one id");
            }
        }
        return false;
    }

    PlanScene& scene_;
    const Capture& rig_;
    std::string given_;
    double tolerance_ = 0;  // [length]
};

}  // namespace

CaptureDescription read_capture_or_rig(const fs::path& path) {
    const bool is_rig = path.filename() == "rig.json" ||
                        (fs::exists(path / "rig.json") && !fs::exists(path / "capture.json"));
    return is_rig ? read_rig_description(path) : read_capture_description(path);
}

PlanScene read_plan_scene(const fs::path& path,
                          const LampStandOptions& stand,
                          const fs::path& given) {
    validate(stand);
    Capture rig = load_capture(read_capture_or_rig(path));
    if (stand.is_given()) {
        rig.description.lights = stand_lamps(rig, stand);
        rig.description.shots.clear();
    }
    PlanScene scene;
    if (given.empty()) {
        scene.capture = std::move(rig);
        return scene;
    }
    scene.capture = load_capture(read_capture_description(given));
    std::set<std::size_t> taken;
    for (const Shot& shot : scene.capture.description.shots) {
        if (!shot.heldout) taken.insert(shot.lights.begin(), shot.lights.end());
    }
    scene.taken.assign(taken.begin(), taken.end());
    Merger(scene, rig, given).merge();
    return scene;
}

}  // namespace patina
