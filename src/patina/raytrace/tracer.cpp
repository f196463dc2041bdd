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
    virtual void intersect_all(std::span<const TraceRay> rays,
                               std::span<TriangleHit> hits) const = 0;
    [[nodiscard]] virtual bool occluded(const Vec3& origin,
                                        const Vec3& direction,
                                        double max_distance) const = 0;
};

namespace {

static_assert(RTC_INVALID_GEOMETRY_ID == kNoTriangle);

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

    void intersect_all(std::span<const TraceRay> rays, std::span<TriangleHit> hits) const override {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit ray_hit{};
        for (std::size_t i = 0; i < rays.size(); ++i) {
            RTCRay& ray = ray_hit.ray;
            ray.org_x = rays[i].origin.x();
            ray.org_y = rays[i].origin.y();
            ray.org_z = rays[i].origin.z();
            ray.dir_x = rays[i].direction.x();
            ray.dir_y = rays[i].direction.y();
            ray.dir_z = rays[i].direction.z();
            ray.tnear = 0;
            ray.tfar = std::numeric_limits<float>::infinity();
            ray.mask = ~0u;
            ray_hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            ray_hit.hit.primID = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene_, &context, &ray_hit);
            hits[i] = {ray_hit.hit.primID, ray_hit.hit.u, ray_hit.hit.v};
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

    void intersect_all(std::span<const TraceRay> rays, std::span<TriangleHit> hits) const override {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto hit = intersect(rays[i].origin.cast<double>(),
                                       rays[i].direction.cast<double>(),
                                       0,
                                       std::numeric_limits<double>::infinity());
            hits[i] = hit ? TriangleHit{hit->triangle, hit->barycentric.x(), hit->barycentric.y()}
                          : TriangleHit{};
        }
    }

    [[nodiscard]] bool occluded(const Vec3& origin,
                                const Vec3& direction,
                                double max_distance) const override {
        return intersect(origin, direction, 0, max_distance).has_value();
    }

  private:
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

void Tracer::intersect_all(std::span<const TraceRay> rays, std::span<TriangleHit> hits) const {
    PATINA_CHECK_EQ(rays.size(), hits.size());
    backend_->intersect_all(rays, hits);
}

bool Tracer::occluded(const Vec3& origin, const Vec3& direction, double max_distance) const {
    return backend_->occluded(origin, direction, max_distance);
}

Vec3 Tracer::offset(const SurfacePoint& point, const Vec3& direction) const {
    const double side = point.geometric_normal.dot(direction) >= 0 ? 1.0 : -1.0;
    return point.position + side * offset_length_ * point.geometric_normal;
}

}  // namespace patina
