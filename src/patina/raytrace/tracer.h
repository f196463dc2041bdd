// Ray queries against a mesh. The only user of Embree, with a brute-force twin that tests it.
#pragma once

#include "patina/scene/mesh.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

namespace patina {

struct RayHit {
    double distance = 0;  // [length]
    std::uint32_t triangle = 0;
    Vec2f barycentric = Vec2f::Zero();
};

// For many rays at once. direction: unit.
struct TraceRay {
    Vec3f origin = Vec3f::Zero();  // [length]
    Vec3f direction = Vec3f::UnitZ();
};
inline constexpr std::uint32_t kNoTriangle = std::numeric_limits<std::uint32_t>::max();
struct TriangleHit {
    std::uint32_t triangle = kNoTriangle;  // kNoTriangle: nothing was hit
    float u = 0;                           // barycentric, as in SurfacePoint
    float v = 0;
};

enum class TracerBackend { embree, brute_force };

// Thread-safe after construction. Copies what it needs of the mesh.
class Tracer {
  public:
    explicit Tracer(const Mesh& mesh, TracerBackend backend = TracerBackend::embree);
    ~Tracer();
    Tracer(Tracer&&) noexcept;
    Tracer& operator=(Tracer&&) noexcept;

    // The nearest hit with min_distance < t < max_distance, front or back. direction: unit.
    [[nodiscard]] std::optional<RayHit> intersect(
        const Vec3& origin,
        const Vec3& direction,
        double min_distance = 0,
        double max_distance = std::numeric_limits<double>::infinity()) const;

    // The nearest hit of each ray, front or back, at any distance: the same as intersect(), without
    // its cost per call. hits: as many as rays.
    void intersect_all(std::span<const TraceRay> rays, std::span<TriangleHit> hits) const;

    // Whether anything lies in between.
    [[nodiscard]] bool occluded(
        const Vec3& origin,
        const Vec3& direction,
        double max_distance = std::numeric_limits<double>::infinity()) const;

    // Moves a point off its surface along the geometric normal, to the side of `direction`, by the
    // size of the rounding error of single-precision coordinates in this scene.
    [[nodiscard]] Vec3 offset(const SurfacePoint& point, const Vec3& direction) const;
    // How far offset() moves a point [length].
    [[nodiscard]] double offset_length() const { return offset_length_; }

    class Backend;

  private:
    std::unique_ptr<Backend> backend_;
    double offset_length_ = 0;  // [length]
};

}  // namespace patina
