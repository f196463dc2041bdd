#include "patina/raytrace/tracer.h"

#include "patina/base/check.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace patina {
namespace {

// Offsets are this share of the largest coordinate: about 64 units in the last place of a float, so
// that neither the vertex rounding nor Embree's own error brings the ray back onto its surface.
constexpr double kOffsetShare = 64.0 / (1 << 23);

float to_float_distance(double distance) {
    return distance > 3e38 ? std::numeric_limits<float>::infinity() : static_cast<float>(distance);
}

RTCRay make_ray(const Vec3& origin,
                const Vec3& direction,
                double min_distance,
                double max_distance) {
    RTCRay ray{};
    ray.org_x = static_cast<float>(origin.x());
    ray.org_y = static_cast<float>(origin.y());
    ray.org_z = static_cast<float>(origin.z());
    ray.dir_x = static_cast<float>(direction.x());
    ray.dir_y = static_cast<float>(direction.y());
    ray.dir_z = static_cast<float>(direction.z());
    ray.tnear = static_cast<float>(min_distance);
    ray.tfar = to_float_distance(max_distance);
    ray.mask = ~0u;
    return ray;
}

}  // namespace

class Tracer::Backend {
  public:
    Backend() = default;
    Backend(const Backend&) = delete;
    Backend& operator=(const Backend&) = delete;
    virtual ~Backend() = default;
    [[nodiscard]] virtual std::optional<RayHit> intersect(const Vec3& origin,
                                                          const Vec3& direction,
                                                          double min_distance,
                                                          double max_distance) const = 0;
    virtual void intersect_lanes(const RayLanes& rays, const HitLanes& hits) const = 0;
    virtual void lit_lanes(const RayLanes& rays,
                           std::span<const float> max_distance,
                           std::span<std::int32_t> lit) const = 0;
    [[nodiscard]] virtual bool occluded(const Vec3& origin,
                                        const Vec3& direction,
                                        double max_distance) const = 0;
};

namespace {

static_assert(RTC_INVALID_GEOMETRY_ID == kNoTriangle);

// Rays that Embree takes at once.
constexpr std::size_t kPacketSize = 8;
struct alignas(32) PacketMask {
    std::array<int, kPacketSize> lanes{};
};

// count <= kPacketSize lanes; a whole packet by one instruction.
template <typename Value>
void copy_lanes(const Value* from, std::size_t count, Value* to) {
    if (count == kPacketSize) {
        std::memcpy(to, from, kPacketSize * sizeof(Value));
    } else {
        std::copy_n(from, count, to);
    }
}

// Lanes from begin on, count of them, except for the far ends. The others are switched off.
PacketMask load_packet(const RayLanes& rays,
                       std::size_t begin,
                       std::size_t count,
                       RTCRay8& packet) {
    PacketMask active;
    copy_lanes(&rays.active[begin], count, active.lanes.data());
    copy_lanes(&rays.origin[0][begin], count, packet.org_x);
    copy_lanes(&rays.origin[1][begin], count, packet.org_y);
    copy_lanes(&rays.origin[2][begin], count, packet.org_z);
    copy_lanes(&rays.direction[0][begin], count, packet.dir_x);
    copy_lanes(&rays.direction[1][begin], count, packet.dir_y);
    copy_lanes(&rays.direction[2][begin], count, packet.dir_z);
    std::ranges::fill(packet.tnear, 0.0f);
    std::ranges::fill(packet.mask, ~0u);
    return active;
}

class EmbreeBackend final : public Tracer::Backend {
  public:
    explicit EmbreeBackend(const Mesh& mesh)
        // One instruction set everywhere: Embree's last bits differ between AVX2 and AVX-512, and
        // results are promised to be the same bytes.
        : device_(rtcNewDevice("isa=avx2")), scene_(rtcNewScene(device_)) {
        PATINA_CHECK(device_ != nullptr);
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        void* vertices = rtcSetNewGeometryBuffer(geometry,
                                                 RTC_BUFFER_TYPE_VERTEX,
                                                 0,
                                                 RTC_FORMAT_FLOAT3,
                                                 sizeof(Vec3f),
                                                 mesh.positions.size());
        void* triangles = rtcSetNewGeometryBuffer(geometry,
                                                  RTC_BUFFER_TYPE_INDEX,
                                                  0,
                                                  RTC_FORMAT_UINT3,
                                                  sizeof(Triangle),
                                                  mesh.triangles.size());
        if (!mesh.triangles.empty()) {
            std::memcpy(vertices, mesh.positions.data(), mesh.positions.size() * sizeof(Vec3f));
            std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle));
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }

    ~EmbreeBackend() override {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }

    [[nodiscard]] std::optional<RayHit> intersect(const Vec3& origin,
                                                  const Vec3& direction,
                                                  double min_distance,
                                                  double max_distance) const override {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit ray_hit{};
        ray_hit.ray = make_ray(origin, direction, min_distance, max_distance);
        ray_hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &ray_hit);
        if (ray_hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
        return RayHit{ray_hit.ray.tfar, ray_hit.hit.primID, Vec2f(ray_hit.hit.u, ray_hit.hit.v)};
    }

    void intersect_lanes(const RayLanes& rays, const HitLanes& hits) const override {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit8 packet{};
        for (std::size_t begin = 0; begin < rays.active.size(); begin += kPacketSize) {
            const std::size_t count = std::min(kPacketSize, rays.active.size() - begin);
            const PacketMask active = load_packet(rays, begin, count, packet.ray);
            std::ranges::fill(packet.ray.tfar, std::numeric_limits<float>::infinity());
            std::ranges::fill(packet.hit.geomID, RTC_INVALID_GEOMETRY_ID);
            std::ranges::fill(packet.hit.primID, RTC_INVALID_GEOMETRY_ID);
            rtcIntersect8(active.lanes.data(), scene_, &context, &packet);
            copy_lanes(packet.hit.primID, count, &hits.triangle[begin]);
            copy_lanes(packet.hit.u, count, &hits.u[begin]);
            copy_lanes(packet.hit.v, count, &hits.v[begin]);
        }
    }

    void lit_lanes(const RayLanes& rays,
                   std::span<const float> max_distance,
                   std::span<std::int32_t> lit) const override {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRay8 packet{};
        for (std::size_t begin = 0; begin < rays.active.size(); begin += kPacketSize) {
            const std::size_t count = std::min(kPacketSize, rays.active.size() - begin);
            const PacketMask active = load_packet(rays, begin, count, packet);
            copy_lanes(&max_distance[begin], count, packet.tfar);
            rtcOccluded8(active.lanes.data(), scene_, &context, &packet);
            // Embree sets the far end of a ray that meets something to minus infinity.
            for (std::size_t i = 0; i < count; ++i) {
                lit[begin + i] = packet.tfar[i] < 0 ? 0 : active.lanes[i];
            }
        }
    }

    [[nodiscard]] bool occluded(const Vec3& origin,
                                const Vec3& direction,
                                double max_distance) const override {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRay ray = make_ray(origin, direction, 0, max_distance);
        rtcOccluded1(scene_, &context, &ray);
        return ray.tfar < 0;
    }

  private:
    RTCDevice device_;
    RTCScene scene_;
};

// Tests every triangle (Moeller and Trumbore, 1997) in double precision.
class BruteForceBackend final : public Tracer::Backend {
  public:
    explicit BruteForceBackend(const Mesh& mesh) {
        corners_.reserve(mesh.triangles.size());
        for (const Triangle& triangle : mesh.triangles) {
            corners_.push_back({mesh.positions[triangle[0]].cast<double>(),
                                mesh.positions[triangle[1]].cast<double>(),
                                mesh.positions[triangle[2]].cast<double>()});
        }
    }

    [[nodiscard]] std::optional<RayHit> intersect(const Vec3& origin,
                                                  const Vec3& direction,
                                                  double min_distance,
                                                  double max_distance) const override {
        std::optional<RayHit> nearest;
        for (std::size_t i = 0; i < corners_.size(); ++i) {
            const auto& [p0, p1, p2] = corners_[i];
            const Vec3 edge1 = p1 - p0;
            const Vec3 edge2 = p2 - p0;
            const Vec3 p = direction.cross(edge2);
            const double determinant = edge1.dot(p);
            if (determinant == 0) continue;
            const Vec3 s = origin - p0;
            const double u = s.dot(p) / determinant;
            const Vec3 q = s.cross(edge1);
            const double v = direction.dot(q) / determinant;
            if (u < 0 || v < 0 || u + v > 1) continue;
            const double t = edge2.dot(q) / determinant;
            if (t <= min_distance || t >= max_distance) continue;
            max_distance = t;
            nearest = RayHit{t, static_cast<std::uint32_t>(i), Vec2(u, v).cast<float>()};
        }
        return nearest;
    }

    void intersect_lanes(const RayLanes& rays, const HitLanes& hits) const override {
        for (std::size_t i = 0; i < rays.active.size(); ++i) {
            const auto hit = rays.active[i] != 0
                                 ? intersect(lane(rays.origin, i), lane(rays.direction, i), 0, kFar)
                                 : std::nullopt;
            hits.triangle[i] = hit ? hit->triangle : kNoTriangle;
            hits.u[i] = hit ? hit->barycentric.x() : 0;
            hits.v[i] = hit ? hit->barycentric.y() : 0;
        }
    }

    void lit_lanes(const RayLanes& rays,
                   std::span<const float> max_distance,
                   std::span<std::int32_t> lit) const override {
        for (std::size_t i = 0; i < rays.active.size(); ++i) {
            const bool is_lit =
                rays.active[i] != 0 &&
                !occluded(lane(rays.origin, i), lane(rays.direction, i), double(max_distance[i]));
            lit[i] = is_lit ? -1 : 0;
        }
    }

    [[nodiscard]] bool occluded(const Vec3& origin,
                                const Vec3& direction,
                                double max_distance) const override {
        return intersect(origin, direction, 0, max_distance).has_value();
    }

  private:
    static constexpr double kFar = std::numeric_limits<double>::infinity();
    static Vec3 lane(const std::array<std::span<const float>, 3>& lanes, std::size_t i) {
        return Vec3f(lanes[0][i], lanes[1][i], lanes[2][i]).cast<double>();
    }

    std::vector<std::array<Vec3, 3>> corners_;
};

std::unique_ptr<Tracer::Backend> make_backend(const Mesh& mesh, TracerBackend backend) {
    if (backend == TracerBackend::brute_force) return std::make_unique<BruteForceBackend>(mesh);
    return std::make_unique<EmbreeBackend>(mesh);
}

}  // namespace

Tracer::Tracer(const Mesh& mesh, TracerBackend backend) : backend_(make_backend(mesh, backend)) {
    float largest = 0;
    for (const Vec3f& p : mesh.positions) largest = std::max(largest, p.cwiseAbs().maxCoeff());
    offset_length_ = kOffsetShare * double(largest);
}

Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

std::optional<RayHit> Tracer::intersect(const Vec3& origin,
                                        const Vec3& direction,
                                        double min_distance,
                                        double max_distance) const {
    return backend_->intersect(origin, direction, min_distance, max_distance);
}

void Tracer::intersect_lanes(const RayLanes& rays, const HitLanes& hits) const {
    PATINA_CHECK_EQ(rays.active.size(), hits.triangle.size());
    backend_->intersect_lanes(rays, hits);
}

void Tracer::lit_lanes(const RayLanes& rays,
                       std::span<const float> max_distance,
                       std::span<std::int32_t> lit) const {
    PATINA_CHECK_EQ(rays.active.size(), lit.size());
    backend_->lit_lanes(rays, max_distance, lit);
}

bool Tracer::occluded(const Vec3& origin, const Vec3& direction, double max_distance) const {
    return backend_->occluded(origin, direction, max_distance);
}

Vec3 Tracer::offset(const SurfacePoint& point, const Vec3& direction) const {
    const double side = point.geometric_normal.dot(direction) >= 0 ? 1.0 : -1.0;
    return point.position + side * offset_length_ * point.geometric_normal;
}

}  // namespace patina
