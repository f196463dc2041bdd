#include "patina/transport/gather_rays.h"

#include "patina/base/wide_code.h"
#include "patina/math/lanes.h"
#include "patina/transport/lane_directions.h"

#include <algorithm>
#include <array>
#include <limits>

namespace patina {
namespace {

// One lobe ray in so many is drawn over the whole hemisphere, so that no weight is unbounded where
// a lobe is wider than the one that the rays are drawn from.
constexpr int kDefensiveShare = 4;
// One first ray in so many goes on, the first ones of each half: what lobes send on is a small part
// of the light.
constexpr int kOnwardShare = 2;
// Those that go on are drawn over the hemisphere and from lobes of these widths [rad], in one
// mixture of equal parts: a narrow lobe finds enough of them, and no weight is unbounded in a wide
// one.
constexpr std::array<float, 3> kOnwardSpreads = {0.25f, 0.1f, 0.1f};

constexpr float kFloor = float(kCosineFloor);
constexpr float kInversePi = float(1 / kPi);

// Streams of random numbers for each texel, and the pairs of dimensions of one ray.
enum class Stream : std::uint64_t { probe = 0, irradiance = 1, first_view = 2 };
constexpr std::uint32_t kFirstPair = 1;
constexpr std::uint32_t kOnwardPair = 2;

// Consecutive points of the sequence are stratified among themselves, so each half is, and what of
// it goes on.
std::uint32_t half_of(int ray, int num_rays) { return ray < num_rays / 2 ? 0u : 1u; }
bool goes_on(int ray, int num_rays) {
    const int half = num_rays / 2;
    return ray % half < half / kOnwardShare;
}

// In which of `count` equal parts of [0, 1) a random number lies; it becomes its place there: one
// number chooses and is drawn with, and what is stratified stays so.
std::size_t choose_part(std::size_t count, float& u) {
    const float scaled = u * float(count);
    const std::size_t part = std::min(std::size_t(scaled), count - 1);
    u = scaled - float(part);
    return part;
}

void fill(Lane3& lane, std::size_t size, const Vec3f& value) {
    std::fill_n(lane.x.begin(), size, value.x());
    std::fill_n(lane.y.begin(), size, value.y());
    std::fill_n(lane.z.begin(), size, value.z());
}

}  // namespace

// --- Rays on their way -------------------------------------------------------------------------

void GatherRays::Rays::draw() {
    run_wide([&]() PATINA_WIDE {
        for (std::size_t i = 0; i < size; ++i) {
            const float kappa = concentration[i];
            const bool is_lobe = kappa > 0;
            const auto [x, y, z] = lane_direction(
                is_lobe, {axis.x[i], axis.y[i], axis.z[i]}, is_lobe ? kappa : 1.0f, u[i], v[i]);
            w.x[i] = x;
            w.y[i] = y;
            w.z[i] = z;
        }
    });
}

void GatherRays::send(Rays& rays) const {
    const std::size_t size = rays.size;
    surface_.tracer->intersect_lanes(
        {rays.origin.first(size), rays.w.first(size), std::span(rays.active).first(size)},
        {std::span(rays.triangle).first(size), rays.hit_u, rays.hit_v});
}

GatherRays::Met GatherRays::meet(const Rays& rays, std::size_t lane, Front& front) const {
    const std::uint32_t triangle = rays.triangle[lane];
    if (triangle == kNoTriangle) return Met::nothing;
    const Vec2f barycentric(rays.hit_u[lane], rays.hit_v[lane]);
    const Vec3 w = rays.w.at(lane).cast<double>();
    front.point = surface_point(*surface_.mesh, triangle, barycentric);
    if (front.point.geometric_normal.dot(w) >= 0) return Met::back;
    if (!faces(front.point, -w)) return Met::nothing;
    front.texel = atlas_.lookup(*surface_.mesh, triangle, barycentric);
    return Met::front;
}

// --- First rays --------------------------------------------------------------------------------

// Rays `begin` to begin + count of the texel, about its normal; concentrations are the caller's.
void GatherRays::start(std::size_t texel, std::uint64_t stream, int begin, int count) {
    const SurfacePoint& point = atlas_.texels[texel].point;
    first_.size = std::size_t(count);
    const std::uint32_t element =
        sobol_element_hash(options_.seed, Pass::gather, stream * atlas_.texels.size() + texel);
    const SobolScramble scramble = sobol_scramble(element, kFirstPair);
    onward_scramble_ = sobol_scramble(element, kOnwardPair);
    run_wide([&]() PATINA_WIDE {
        for (std::size_t i = 0; i < first_.size; ++i) {
            const auto numbers = sobol_pair(scramble, std::uint32_t(begin) + std::uint32_t(i));
            first_.u[i] = unit_from_bits(numbers[0]);
            first_.v[i] = unit_from_bits(numbers[1]);
        }
    });
    fill(first_.axis, first_.size, point.normal.cast<float>());
    fill(first_.origin,
         first_.size,
         surface_.tracer->offset(point, point.geometric_normal).cast<float>());
}

// Those that leave to the back of the texel stay.
void GatherRays::draw_first(std::size_t texel) {
    first_.draw();
    const Vec3f normal = atlas_.texels[texel].point.normal.cast<float>();
    const Vec3f geometric = atlas_.texels[texel].point.geometric_normal.cast<float>();
    for (std::size_t i = 0; i < first_.size; ++i) {
        const float x = first_.w.x[i], y = first_.w.y[i], z = first_.w.z[i];
        const float cosine = normal.x() * x + normal.y() * y + normal.z() * z;
        const float departing = geometric.x() * x + geometric.y() * y + geometric.z() * z;
        first_.cosine[i] = cosine;
        first_.active[i] = -(std::int32_t(cosine > 0) & std::int32_t(departing > 0));
    }
}

bool GatherRays::probe_hits(std::size_t texel) {
    start(texel, std::uint64_t(Stream::probe), 0, kProbeRays);
    std::fill_n(first_.concentration.begin(), kProbeRays, 0.0f);
    draw_first(texel);
    std::array<float, kProbeRays> far;
    far.fill(std::numeric_limits<float>::infinity());
    std::array<std::int32_t, kProbeRays> lit;
    const auto active = std::span(first_.active).first(kProbeRays);
    surface_.tracer->lit_lanes(
        {first_.origin.first(kProbeRays), first_.w.first(kProbeRays), active}, far, lit);
    return !std::equal(lit.begin(), lit.end(), active.begin());
}

int GatherRays::trace_irradiance(std::size_t texel, TracedRow row) {
    int num_backs = 0;
    for (int begin = 0; begin < options_.rays; begin += int(kWaveSize)) {
        const int count = std::min(int(kWaveSize), options_.rays - begin);
        start(texel, std::uint64_t(Stream::irradiance), begin, count);
        std::fill_n(first_.concentration.begin(), count, 0.0f);
        draw_first(texel);
        std::fill_n(first_.weight.begin(), count, float(kPi / options_.rays));
        num_backs += follow(begin, options_.rays, row);
    }
    return num_backs;
}

void GatherRays::trace_lobe(std::size_t texel, std::size_t view, const Vec3f& w_v, TracedRow row) {
    const Vec3f normal = atlas_.texels[texel].point.normal.cast<float>();
    const float cos_v = normal.dot(w_v);
    if (!(cos_v > 0)) return;
    const Vec3f mirror = 2 * cos_v * normal - w_v;
    const auto concentration = float(1 / square(options_.lobe_spread));
    for (int begin = 0; begin < options_.lobe_rays; begin += int(kWaveSize)) {
        const int count = std::min(int(kWaveSize), options_.lobe_rays - begin);
        start(texel, std::uint64_t(Stream::first_view) + view, begin, count);
        for (std::size_t i = 0; i < first_.size; ++i) {
            // One number chooses and is drawn with, as in choose_part().
            float u = first_.u[i] * float(kDefensiveShare);
            const bool is_defensive = u < 1;
            if (!is_defensive) u = (u - 1) / float(kDefensiveShare - 1);
            first_.u[i] = u;
            first_.concentration[i] = is_defensive ? 0.0f : concentration;
            if (!is_defensive) first_.axis.set(i, mirror);
        }
        draw_first(texel);
        run_wide([&]() PATINA_WIDE {
            for (std::size_t i = 0; i < first_.size; ++i) {
                const float dx = mirror.x() - first_.w.x[i];
                const float dy = mirror.y() - first_.w.y[i];
                const float dz = mirror.z() - first_.w.z[i];
                const float lobe = lane_lobe_density(concentration, dx * dx + dy * dy + dz * dz);
                const float density =
                    (first_.cosine[i] * kInversePi + (kDefensiveShare - 1) * lobe) /
                    kDefensiveShare;
                first_.weight[i] = first_.cosine[i] / (density * float(options_.lobe_rays));
            }
        });
        static_cast<void>(follow(begin, options_.lobe_rays, row));
    }
}

// Returns how many met a back.
int GatherRays::follow(int begin, int num_rays, TracedRow row) {
    send(first_);
    second_.size = 0;
    int num_backs = 0;
    Front front;
    for (std::size_t i = 0; i < first_.size; ++i) {
        const Met met = meet(first_, i, front);
        num_backs += met == Met::back ? 1 : 0;
        if (met != Met::front || front.texel == kNoTexel) continue;
        const int number = begin + int(i);
        const Vec3f w = first_.w.at(i);
        row.hits.push_back({front.texel, w, first_.weight[i], half_of(number, num_rays)});
        if (goes_on(number, num_rays)) start_onward(front.point, w, number, row);
    }
    follow_onward(row);
    return num_backs;
}

// --- Second rays -------------------------------------------------------------------------------

// From where the last hit of the row is.
void GatherRays::start_onward(const SurfacePoint& point,
                              const Vec3f& w,
                              int number,
                              TracedRow row) {
    const std::size_t i = second_.size++;
    const auto numbers = sobol_pair(onward_scramble_, std::uint32_t(number));
    second_.u[i] = unit_from_bits(numbers[0]);
    second_.v[i] = unit_from_bits(numbers[1]);
    const Vec3f normal = point.normal.cast<float>();
    second_.cos_o[i] = -normal.dot(w);
    second_.normal.set(i, normal);
    second_.geometric_normal.set(i, point.geometric_normal.cast<float>());
    second_.mirror.set(i, w + 2 * second_.cos_o[i] * normal);
    const std::size_t lobe = choose_part(kOnwardSpreads.size() + 1, second_.u[i]);
    second_.axis.set(i, lobe == 0 ? normal : second_.mirror.at(i));
    second_.concentration[i] = lobe == 0 ? 0.0f : 1 / square(kOnwardSpreads[lobe - 1]);
    second_.origin.set(i, surface_.tracer->offset(point, point.geometric_normal).cast<float>());
    second_.hit[i] = std::uint32_t(row.hits.size() - 1 - row.first);
}

void GatherRays::follow_onward(TracedRow row) {
    second_.draw();
    for (std::size_t i = 0; i < second_.size; ++i) {
        const LaneDirection w = lane_at(second_.w, i);
        const float cos_i = lane_dot(lane_at(second_.normal, i), w);
        const float departing = lane_dot(lane_at(second_.geometric_normal, i), w);
        second_.cosine[i] = cos_i;
        second_.active[i] = -(std::int32_t(cos_i > 0) & std::int32_t(departing > 0));
    }
    send(second_);
    Front front;
    for (std::size_t i = 0; i < second_.size; ++i) {
        if (meet(second_, i, front) != Met::front || front.texel == kNoTexel) continue;
        const float chord = lane_chord_squared(lane_at(second_.w, i), lane_at(second_.mirror, i));
        const float cos_i = second_.cosine[i];
        float density = cos_i * kInversePi;
        for (const float spread : kOnwardSpreads) {
            density += lane_lobe_density(1 / square(spread), chord);
        }
        density /= float(kOnwardSpreads.size() + 1);
        GlossyHit& glossy = row.glossy.emplace_back();
        glossy.to = front.texel;
        glossy.hit = std::uint16_t(second_.hit[i]);
        glossy.theta_squared = to_compact(square(angle_of_chord_squared(chord)));
        glossy.weight = float(kOnwardShare) * cos_i /
                        (std::max(cos_i, kFloor) * std::max(second_.cos_o[i], kFloor) * density);
    }
}

}  // namespace patina
