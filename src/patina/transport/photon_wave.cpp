#include "patina/transport/photon_wave.h"

#include "patina/base/wide_code.h"
#include "patina/transport/lane_directions.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// Arrivals nearly along the surface weigh at most this much: smooth over geometric cosine.
constexpr float kMaxShadingRatio = 4.0f;
constexpr float kFloor = float(kCosineFloor);
constexpr float kInversePi = float(1 / kPi);
constexpr float kTurn = float(2 * kPi);
// Of turning lamps, photons count whose direction lies so near to the mirror direction of the lamp
// as it stands for their column [sigma of the lobe that directions are drawn from].
constexpr float kColumnReach = 5.0f;
// Records are asked of memory so many hits before they are read: a processor waits for about a
// dozen lines at a time.
constexpr std::size_t kHitsAhead = 12;

// Epanechnikov kernel of unit integral [1/rad].
float azimuth_kernel(float difference, float half_width) {
    const float t = (difference - kTurn * std::nearbyint(difference / kTurn)) / half_width;
    return std::abs(t) < 1 ? 0.75f / half_width * (1 - t * t) : 0.0f;
}

std::uint8_t half_of(std::uint32_t photon) { return static_cast<std::uint8_t>(photon % 2); }

void prefetch(const void* address) { __builtin_prefetch(address); }

}  // namespace

PhotonWave::PhotonWave(const PhotonScene& scene,
                       const PhotonStart& start,
                       const PhotonNumbers& numbers,
                       const PhotonOptions& options,
                       bool turns_with_scanner,
                       const PhotonColumns* columns)
    : scene_(scene),
      start_(start),
      numbers_(numbers),
      options_(options),
      turns_with_scanner_(turns_with_scanner),
      columns_(columns),
      hits_(kWaveSize) {}

PhotonBlock PhotonWave::follow(std::uint64_t first_photon,
                               std::size_t count,
                               PhotonStart::Cursor& cursor) {
    num_rays_ = 0;
    num_paths_ = 0;
    num_bounces_.fill(0);
    arrivals_.clear();
    start_.fill(first_photon, count, cursor, lanes_);
    const auto first_sample = std::uint32_t(first_photon / 2);
    std::uint32_t pair = PhotonStart::kNumPairs;
    for (int bounce = 0; bounce < options_.max_bounces && lanes_.size > 0; ++bounce) {
        numbers_.draw(++pair, first_sample, lanes_.photon, lanes_.size, lanes_.u, lanes_.v);
        sample_directions();
        send_rays();
        collect_hits();
        if (columns_ != nullptr) turn_to_columns();
        if (turns_with_scanner_ && bounce == 0) drop_unlit();
        name_hits();
        locate_hits();
        for (std::size_t hit = 0; hit < std::min(kHitsAhead, num_hits_); ++hit) find_texel(hit);
        weigh_directions();
        if (columns_ != nullptr) weigh_over_teeth();
        if (bounce == 0) keep_powers();
        numbers_.draw(++pair,
                      first_sample,
                      hit_lanes_.photon,
                      num_hits_,
                      hit_lanes_.choice,
                      hit_lanes_.roulette);
        lanes_.size = 0;
        for (std::size_t hit = 0; hit < num_hits_; ++hit) {
            if (hit + kHitsAhead < num_hits_) find_texel(hit + kHitsAhead);
            arrive(hit);
        }
        if (bounce == 0) num_paths_ = arrivals_.size();
    }
    return block();
}

// As sample_lobe(): a cosine distribution about the normal or a von Mises-Fisher distribution about
// the mirror direction.
void PhotonWave::sample_directions() {
    PhotonLanes& at = lanes_;
    run_wide([&]() PATINA_WIDE {
        for (std::size_t i = 0; i < at.size; ++i) {
            const LaneDirection normal = lane_at(at.normal, i);
            const LaneDirection w_i = lane_at(at.w_i, i);
            const float cos_i = lane_dot(normal, w_i);
            const LaneDirection mirror = lane_mirror(normal, w_i, cos_i);
            // A texel may be black altogether.
            constexpr float kNegligibleAlbedo = 1e-30f;
            const float lobe = at.lobe[i] / std::max(cos_i, kFloor);
            at.share[i] = lobe / std::max(at.diffuse[i] + lobe, kNegligibleAlbedo);
            const bool glossy = at.choice[i] < at.share[i];
            const LaneDirection w_o = lane_direction(
                glossy, glossy ? mirror : normal, at.concentration[i], at.u[i], at.v[i]);
            const float cos_o = lane_dot(normal, w_o);
            const float departing = lane_dot(lane_at(at.geometric_normal, i), w_o);
            at.w_o.x[i] = w_o.x;
            at.w_o.y[i] = w_o.y;
            at.w_o.z[i] = w_o.z;
            at.cos_i[i] = cos_i;
            at.cos_o[i] = cos_o;
            at.departing[i] = departing;
            at.chord_squared[i] = lane_chord_squared(mirror, w_o);
            const std::uint32_t leaves =
                std::uint32_t(cos_i > 0) & std::uint32_t(cos_o > 0) & std::uint32_t(departing > 0);
            at.active[i] &= -std::int32_t(leaves);
        }
    });
}

void PhotonWave::send_rays() {
    const std::size_t size = lanes_.size;
    const auto active = std::span(lanes_.active).first(size);
    scene_.tracer().intersect_lanes(
        {lanes_.origin.first(size), lanes_.w_o.first(size), active},
        {std::span(lanes_.hit_triangle).first(size), lanes_.hit_u, lanes_.hit_v});
    std::int32_t sent = 0;
    for (const std::int32_t is_active : active) sent -= is_active;
    num_rays_ += std::uint64_t(sent);
}

void PhotonWave::collect_hits() {
    std::size_t count = 0;
    for (std::size_t i = 0; i < lanes_.size; ++i) {
        hit_lanes_.lane[count] = std::uint32_t(i);
        count += lanes_.hit_triangle[i] != kNoTriangle ? 1 : 0;
    }
    num_hits_ = count;
}

// Photons of which the lobe sends next to nothing to where they arrived are dropped: of a lobe that
// has become 1.75 times as wide since, 0.2 % of its light.
void PhotonWave::turn_to_columns() {
    locate_hits();
    std::size_t count = 0;
    for (std::size_t hit = 0; hit < num_hits_; ++hit) {
        find_texel(hit);
        if (hits_[hit].texel == kNoTexel || hits_[hit].arriving <= 0) continue;
        lanes_.azimuth[hits_[hit].lane] = scene_.texel(hits_[hit].texel).azimuth;
        hit_lanes_.lane[count++] = hits_[hit].lane;
    }
    start_.turn_lamp(lanes_);
    num_hits_ = 0;
    for (std::size_t hit = 0; hit < count; ++hit) {
        const std::uint32_t lane = hit_lanes_.lane[hit];
        const LaneDirection normal = lane_at(lanes_.normal, lane);
        const LaneDirection w_i = lane_at(lanes_.w_i, lane);
        lanes_.cos_i[lane] = lane_dot(normal, w_i);
        lanes_.chord_squared[lane] = lane_chord_squared(
            lane_mirror(normal, w_i, lanes_.cos_i[lane]), lane_at(lanes_.w_o, lane));
        const float reach_squared = square(kColumnReach) / lanes_.concentration[lane];
        if (lanes_.active[lane] == 0 || lanes_.chord_squared[lane] > reach_squared) {
            continue;
        }
        hit_lanes_.lane[num_hits_++] = lane;
    }
}

// Where lamps turn, nobody knows yet whether they shine on the photon's first texel. Most photons
// hit nothing afterwards, so that only the others are asked.
void PhotonWave::drop_unlit() {
    for (std::size_t hit = 0; hit < num_hits_; ++hit) {
        const std::size_t lane = hit_lanes_.lane[hit];
        hit_lanes_.origin.set(hit, lanes_.origin.at(lane));
        hit_lanes_.w_i.set(hit, lanes_.w_i.at(lane));
        hit_lanes_.distance[hit] = lanes_.distance[lane];
        hit_lanes_.lit[hit] = -1;
    }
    const auto lit = std::span(hit_lanes_.lit).first(num_hits_);
    scene_.tracer().lit_lanes(
        {hit_lanes_.origin.first(num_hits_), hit_lanes_.w_i.first(num_hits_), lit},
        hit_lanes_.distance,
        lit);
    std::size_t count = 0;
    for (std::size_t hit = 0; hit < num_hits_; ++hit) {
        hit_lanes_.lane[count] = hit_lanes_.lane[hit];
        count += lit[hit] != 0 ? 1 : 0;
    }
    num_hits_ = count;
}

void PhotonWave::name_hits() {
    for (std::size_t hit = 0; hit < num_hits_; ++hit) {
        hit_lanes_.photon[hit] = lanes_.photon[hit_lanes_.lane[hit]];
    }
}

void PhotonWave::ask_for_triangle(std::size_t hit) const {
    const PhotonTriangle& triangle = scene_.triangle(lanes_.hit_triangle[hit_lanes_.lane[hit]]);
    prefetch(&triangle.position);
    prefetch(&triangle.cell_edge2);
}

void PhotonWave::locate_hits() {
    for (std::size_t hit = 0; hit < std::min(kHitsAhead, num_hits_); ++hit) ask_for_triangle(hit);
    for (std::size_t i = 0; i < num_hits_; ++i) {
        if (i + kHitsAhead < num_hits_) ask_for_triangle(i + kHitsAhead);
        Hit& hit = hits_[i];
        hit.lane = hit_lanes_.lane[i];
        const PhotonTriangle& triangle = scene_.triangle(lanes_.hit_triangle[hit.lane]);
        const float u = lanes_.hit_u[hit.lane];
        const float v = lanes_.hit_v[hit.lane];
        hit.cell =
            scene_.cell_at(triangle.cell + u * triangle.cell_edge1 + v * triangle.cell_edge2);
        prefetch(&scene_.texel_of_cell(hit.cell));
        hit.normal = triangle.normal + u * triangle.normal_edge1 + v * triangle.normal_edge2;
        const float length = hit.normal.norm();
        // Opposite vertex normals may cancel.
        hit.normal = length > 0 ? Vec3f(hit.normal / length) : triangle.geometric_normal;
        hit.position =
            triangle.position + u * triangle.position_edge1 + v * triangle.position_edge2;
        hit.arriving = triangle.geometric_normal.dot(w_back(hit));
        hit.shading = hit.normal.dot(w_back(hit));
    }
}

void PhotonWave::find_texel(std::size_t number) {
    Hit& hit = hits_[number];
    hit.texel = scene_.texel_of_cell(hit.cell);
    if (hit.texel == kNoTexel) return;
    prefetch(&scene_.receiver(hit.texel));
    if (turns_with_scanner_) prefetch(&scene_.texel(hit.texel));
}

// The density of the directions that hit something, and what weights need to know of them.
void PhotonWave::weigh_directions() {
    auto& at = hit_lanes_;
    for (std::size_t hit = 0; hit < num_hits_; ++hit) {
        const std::size_t i = at.lane[hit];
        at.cos_i[hit] = lanes_.cos_i[i];
        at.cos_o[hit] = lanes_.cos_o[i];
        at.departing[hit] = lanes_.departing[i];
        at.chord_squared[hit] = lanes_.chord_squared[i];
        at.concentration[hit] = lanes_.concentration[i];
        at.share[hit] = lanes_.share[i];
        at.survival[hit] = lanes_.survival[i];
    }
    run_wide([&]() PATINA_WIDE {
        for (std::size_t i = 0; i < num_hits_; ++i) {
            const float lobe_pdf = lane_lobe_density(at.concentration[i], at.chord_squared[i]);
            const float pdf = (1 - at.share[i]) * at.cos_o[i] * kInversePi + at.share[i] * lobe_pdf;
            const float theta_r = angle_of_chord_squared(at.chord_squared[i]);
            at.theta_r_squared[i] = theta_r * theta_r;
            at.lobe_cosines[i] =
                1 / (std::max(at.cos_i[i], kFloor) * std::max(at.cos_o[i], kFloor));
            at.geometry[i] = at.departing[i] / (pdf * at.survival[i]);
        }
    });
}

// The lamp has been turned, and the direction may have come from any tooth.
void PhotonWave::weigh_over_teeth() {
    for (std::size_t hit = 0; hit < num_hits_; ++hit) {
        const std::size_t i = hit_lanes_.lane[hit];
        hit_lanes_.geometry[hit] =
            lanes_.departing[i] /
            columns_->density(scene_.texel(lanes_.texel[i]), lanes_.w_o.at(i));
    }
}

// Before the lanes are given to photons that live on.
void PhotonWave::keep_powers() {
    for (std::size_t hit = 0; hit < num_hits_; ++hit) {
        power_[hit_lanes_.photon[hit]] = start_.power(lanes_, hit_lanes_.lane[hit]);
    }
}

// Stores the arrival and, where the photon lives on, moves it to the next free lane. Hits come in
// the order of their lanes, so that no lane is overwritten before it was read.
void PhotonWave::arrive(std::size_t number) {
    const Hit& hit = hits_[number];
    if (hit.arriving <= 0 || hit.shading <= 0 || hit.texel == kNoTexel) return;
    const std::uint32_t photon = hit_lanes_.photon[number];
    Arrival& arrival = arrivals_.emplace_back();
    arrival.photon = photon;
    arrival.w_back = w_back(hit);
    arrival.position = hit.position;
    PhotonBounce& bounce = arrival.bounce;
    bounce.from = lanes_.texel[hit.lane];
    bounce.to = hit.texel;
    bounce.theta_r_squared = hit_lanes_.theta_r_squared[number];
    bounce.lobe_cosines = hit_lanes_.lobe_cosines[number];
    bounce.geometry =
        hit_lanes_.geometry[number] * std::min(hit.shading / hit.arriving, kMaxShadingRatio);
    bounce.window = 1;
    if (turns_with_scanner_ && columns_ == nullptr) {
        bounce.window = azimuth_kernel(lanes_.azimuth[photon] - scene_.texel(hit.texel).azimuth,
                                       float(options_.azimuth_window));
    }
    ++num_bounces_[photon];
    const float survival = scene_.survival(scene_.receiver(hit.texel), hit.shading);
    if (hit_lanes_.roulette[number] < survival) reflect(number, survival);
}

void PhotonWave::reflect(std::size_t number, float survival) {
    const Hit& hit = hits_[number];
    const PhotonReceiver& receiver = scene_.receiver(hit.texel);
    const Vec3f& geometric_normal = scene_.triangle(lanes_.hit_triangle[hit.lane]).geometric_normal;
    const std::size_t next = lanes_.size++;
    lanes_.w_i.set(next, w_back(hit));
    lanes_.origin.set(next, hit.position + scene_.offset_length() * geometric_normal);
    lanes_.geometric_normal.set(next, geometric_normal);
    lanes_.normal.set(next, hit.normal);
    lanes_.texel[next] = hit.texel;
    lanes_.diffuse[next] = receiver.diffuse;
    lanes_.lobe[next] = receiver.lobe;
    lanes_.concentration[next] = receiver.concentration;
    lanes_.survival[next] = survival;
    lanes_.choice[next] = hit_lanes_.choice[number];
    lanes_.photon[next] = hit_lanes_.photon[number];
    lanes_.active[next] = -1;
}

// Photons that arrive once do so first after the first reflection, where they are still in order.
PhotonBlock PhotonWave::block() {
    const auto paths = kept_paths_.take(num_paths_);
    const auto arrivals = kept_arrivals_.take(arrivals_.size());
    const auto positions = kept_positions_.take(options_.keep_positions ? arrivals_.size() : 0);
    Lane<std::uint32_t> next_bounce;
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < num_paths_; ++i) {
        const std::uint32_t photon = arrivals_[i].photon;
        paths[i] = {power_[photon], next, half_of(photon)};
        next_bounce[photon] = next;
        next += num_bounces_[photon];
    }
    for (const Arrival& arrival : arrivals_) {
        const std::uint32_t bounce = next_bounce[arrival.photon]++;
        arrivals[bounce] = {arrival.bounce, arrival.w_back, half_of(arrival.photon)};
        if (options_.keep_positions) positions[bounce] = arrival.position;
    }
    return {paths, arrivals, positions, num_rays_};
}

}  // namespace patina
