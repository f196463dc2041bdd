// Ray queries against a mesh. The only user of Embree, with a brute-force twin that tests it.
#pragma once

#include "patina/scene/mesh.h"

#include <array>
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

// Many rays at once, side by side as SIMD lanes read them: spans of one length.
struct RayLanes {
    std::array<std::span<const float>, 3> origin;     // x, y, z [length]
    std::array<std::span<const float>, 3> direction;  // x, y, z; unit
    std::span<const std::int32_t> active;             // -1: the ray is sent, 0: it is not
};
inline constexpr std::uint32_t kNoTriangle = std::numeric_limits<std::uint32_t>::max();
struct HitLanes {
    std::span<std::uint32_t> triangle;  // kNoTriangle: nothing was hit, or the ray was not sent
    std::span<float> u;                 // barycentric, as in SurfacePoint
    std::span<float> v;
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

    // Whether anything lies in between.
    [[nodiscard]] bool occluded(
        const Vec3& origin,
        const Vec3& direction,
        double max_distance = std::numeric_limits<double>::infinity()) const;

    // intersect() and occluded() of each ray that is sent, without their cost per call. hits: as
    // many lanes as rays. lit: -1 where the ray is sent and nothing lies in between, 0 elsewhere;
    // may be the rays' own active.
    void intersect_lanes(const RayLanes& rays, const HitLanes& hits) const;
    void lit_lanes(const RayLanes& rays,
                   std::span<const float> max_distance,
                   std::span<std::int32_t> lit) const;

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
