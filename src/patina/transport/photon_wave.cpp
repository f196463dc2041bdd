#include "patina/transport/photon_wave.h"

#include "patina/base/random.h"
#include "patina/reflectance/lobe_lanes.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// Arrivals nearly along the surface weigh at most this much: smooth over geometric cosine.
constexpr float kMaxShadingRatio = 4.0f;
constexpr float kFloor = float(kCosineFloor);
constexpr float kInversePi = float(1 / kPi);

// Epanechnikov kernel of unit integral [1/rad].
double azimuth_kernel(double difference, double half_width) {
    const double t = std::remainder(difference, 2 * kPi) / half_width;
    return std::abs(t) < 1 ? 0.75 / half_width * (1 - t * t) : 0.0;
}

}  // namespace

PhotonWave::PhotonWave(const PhotonScene& scene,
                       const TexelAtlas& atlas,
                       const PhotonOptions& options,
                       bool turns_with_scanner,
                       const std::array<std::uint32_t, 2>& element_hashes,
                       std::uint32_t num_lamp_pairs)
    : scene_(scene),
      atlas_(atlas),
      options_(options),
      turns_with_scanner_(turns_with_scanner),
      element_hashes_(element_hashes),
      num_lamp_pairs_(num_lamp_pairs),
      rays_(kSize),
      hits_(kSize) {}

void PhotonWave::clear(std::uint32_t first_sample) {
    first_sample_ = first_sample;
    size_ = 0;
    num_rays_ = 0;
    num_bounces_.fill(0);
    arrivals_.clear();
}

void PhotonWave::set_guide(std::size_t lane, TexelId texel, float survival) {
    const GuideTexel& guide = scene_.guide(texel);
    texel_[lane] = texel;
    diffuse_[lane] = guide.diffuse;
    lobe_[lane] = guide.lobe;
    concentration_[lane] = guide.concentration;
    survival_[lane] = survival;
}

void PhotonWave::add(const Start& start) {
    const SurfacePoint& point = atlas_.texels[start.texel].point;
    const std::size_t lane = size_++;
    position_.set(lane, point.position.cast<float>());
    geometric_normal_.set(lane, point.geometric_normal.cast<float>());
    normal_.set(lane, point.normal.cast<float>());
    w_i_.set(lane, start.w_i);
    set_guide(lane, start.texel, 1);
    photon_[lane] = std::uint32_t(start.number);
    element_hash_[lane] = element_hashes_[start.number % 2];
    sample_[lane] = first_sample_ + std::uint32_t(start.number / 2);
    power_[start.number] = start.power;
    azimuth_[start.number] = start.azimuth;
}

void PhotonWave::follow(PhotonBlock& block) {
    std::uint32_t pair = num_lamp_pairs_ + 1;
    draw(pair, choice_, next_roulette_);
    for (int bounce = 0; bounce < options_.max_bounces && size_ > 0; ++bounce) {
        draw(pair + 1, u_, v_);
        pair += 2;
        draw(pair, next_choice_, next_roulette_);
        sample_directions();
        weigh_directions();
        send_rays();
        size_ = num_next_;
    }
    append_to(block);
}

void PhotonWave::draw(std::uint32_t pair, Lane<float>& first, Lane<float>& second) const {
    for (std::size_t i = 0; i < size_; ++i) {
        const auto numbers = sobol_pair(element_hash_[i], sample_[i], pair);
        first[i] = unit_from_bits(numbers[0]);
        second[i] = unit_from_bits(numbers[1]);
    }
}

// As sample_lobe(): a cosine distribution about the normal or a von Mises-Fisher distribution about
// the mirror direction.
void PhotonWave::sample_directions() {
    for (std::size_t i = 0; i < size_; ++i) {
        const float nx = normal_.x[i], ny = normal_.y[i], nz = normal_.z[i];
        const float cos_i = nx * w_i_.x[i] + ny * w_i_.y[i] + nz * w_i_.z[i];
        const float mx = 2 * cos_i * nx - w_i_.x[i];
        const float my = 2 * cos_i * ny - w_i_.y[i];
        const float mz = 2 * cos_i * nz - w_i_.z[i];
        mirror_.x[i] = mx;
        mirror_.y[i] = my;
        mirror_.z[i] = mz;
        // A texel may be black altogether.
        constexpr float kNegligibleAlbedo = 1e-30f;
        const float lobe = lobe_[i] / std::max(cos_i, kFloor);
        share_[i] = lobe / std::max(diffuse_[i] + lobe, kNegligibleAlbedo);
        const bool glossy = choice_[i] < share_[i];

        const float decay = exp_of_negative(-2 * concentration_[i]);
        const float versine =
            std::min(2.0f, -lane_log(u_[i] + (1 - u_[i]) * decay) / concentration_[i]);
        const float radius_squared = glossy ? versine * (2 - versine) : u_[i];
        const float z = glossy ? 1 - versine : std::sqrt(1 - u_[i]);
        const float radius = std::sqrt(std::max(radius_squared, 0.0f));
        const SinCos phi = lane_sin_cos(v_[i]);
        const float x = radius * phi.cos;
        const float y = radius * phi.sin;

        // Frame of Duff et al. about the axis (math/warp.h).
        const float ax = glossy ? mx : nx;
        const float ay = glossy ? my : ny;
        const float az = glossy ? mz : nz;
        const float sign = std::copysign(1.0f, az);
        const float a = -1.0f / (sign + az);
        const float b = ax * ay * a;
        w_o_.x[i] = x * (1 + sign * ax * ax * a) + y * b + z * ax;
        w_o_.y[i] = x * sign * b + y * (sign + ay * ay * a) + z * ay;
        w_o_.z[i] = -x * sign * ax - y * ay + z * az;
    }
}

// The density of the directions, and what weights need to know of them.
void PhotonWave::weigh_directions() {
    const auto offset = float(scene_.tracer().offset_length());
    for (std::size_t i = 0; i < size_; ++i) {
        const float ox = w_o_.x[i], oy = w_o_.y[i], oz = w_o_.z[i];
        const float nx = normal_.x[i], ny = normal_.y[i], nz = normal_.z[i];
        const float gx = geometric_normal_.x[i];
        const float gy = geometric_normal_.y[i];
        const float gz = geometric_normal_.z[i];
        const float cos_i = nx * w_i_.x[i] + ny * w_i_.y[i] + nz * w_i_.z[i];
        const float cos_o = nx * ox + ny * oy + nz * oz;
        const float departing = gx * ox + gy * oy + gz * oz;
        const float dx = mirror_.x[i] - ox;
        const float dy = mirror_.y[i] - oy;
        const float dz = mirror_.z[i] - oz;
        const float chord_squared = dx * dx + dy * dy + dz * dz;

        const float kappa = concentration_[i];
        const float lobe_pdf = 0.5f * kInversePi * kappa *
                               exp_of_negative(-0.5f * kappa * chord_squared) /
                               (1 - exp_of_negative(-2 * kappa));
        const float pdf = (1 - share_[i]) * cos_o * kInversePi + share_[i] * lobe_pdf;
        const float theta_r = angle_of_chord_squared(chord_squared);
        theta_r_squared_[i] = theta_r * theta_r;
        lobe_cosines_[i] = 1 / (std::max(cos_i, kFloor) * std::max(cos_o, kFloor));
        geometry_[i] = departing / (pdf * survival_[i]);
        leaves_[i] =
            std::uint32_t(cos_i > 0) & std::uint32_t(cos_o > 0) & std::uint32_t(departing > 0);
        origin_.x[i] = position_.x[i] + offset * gx;
        origin_.y[i] = position_.y[i] + offset * gy;
        origin_.z[i] = position_.z[i] + offset * gz;
    }
}

void PhotonWave::send_rays() {
    std::size_t count = 0;
    for (std::size_t i = 0; i < size_; ++i) {
        rays_[count] = {origin_.at(i), w_o_.at(i)};
        lane_of_ray_[count] = std::uint32_t(i);
        count += leaves_[i];
    }
    num_rays_ += count;
    scene_.tracer().intersect_all({rays_.data(), count}, {hits_.data(), count});
    num_next_ = 0;
    for (std::size_t ray = 0; ray < count; ++ray) {
        if (hits_[ray].triangle != kNoTriangle) arrive(ray, lane_of_ray_[ray]);
    }
}

// Stores the arrival and, where the photon lives on, moves it to the next free lane. Rays come in
// the order of their lanes, so that no lane is overwritten before it was read.
void PhotonWave::arrive(std::size_t ray, std::size_t lane) {
    const auto [index, u, v] = hits_[ray];
    const PhotonTriangle& triangle = scene_.triangle(index);
    const Vec3f w_back = -rays_[ray].direction;
    const float arriving = triangle.geometric_normal.dot(w_back);
    if (arriving <= 0) return;
    Vec3f normal = triangle.normal + u * triangle.normal_edge1 + v * triangle.normal_edge2;
    const float length = normal.norm();
    // Opposite vertex normals may cancel.
    normal = length > 0 ? Vec3f(normal / length) : triangle.geometric_normal;
    const float shading = normal.dot(w_back);
    if (shading <= 0) return;
    const TexelId texel =
        scene_.texel_at(triangle.cell + u * triangle.cell_edge1 + v * triangle.cell_edge2);
    if (texel == kNoTexel) return;
    const Vec3f position =
        triangle.position + u * triangle.position_edge1 + v * triangle.position_edge2;
    const std::uint32_t photon = photon_[lane];
    PhotonBounce bounce;
    bounce.from = texel_[lane];
    bounce.to = texel;
    bounce.theta_r_squared = theta_r_squared_[lane];
    bounce.lobe_cosines = lobe_cosines_[lane];
    bounce.geometry = geometry_[lane] * std::min(shading / arriving, kMaxShadingRatio);
    if (turns_with_scanner_) {
        bounce.window = float(azimuth_kernel(azimuth_[photon] - atlas_.texels[texel].azimuth,
                                             options_.azimuth_window));
    }
    arrivals_.push_back({bounce, w_back, position, photon});
    ++num_bounces_[photon];

    const float survival = scene_.survival(scene_.guide(texel), shading);
    if (next_roulette_[lane] >= survival) return;
    const std::size_t next = num_next_++;
    position_.set(next, position);
    geometric_normal_.set(next, triangle.geometric_normal);
    normal_.set(next, normal);
    w_i_.set(next, w_back);
    set_guide(next, texel, survival);
    choice_[next] = next_choice_[lane];
    element_hash_[next] = element_hash_[lane];
    sample_[next] = sample_[lane];
    photon_[next] = photon;
}

void PhotonWave::append_to(PhotonBlock& block) {
    block.rays += num_rays_;
    const auto first = std::uint32_t(block.bounces.size());
    const std::size_t end = first + arrivals_.size();
    block.bounces.resize(end);
    block.directions.resize(end);
    if (options_.keep_positions) block.positions.resize(end);
    Lane<std::uint32_t> next_bounce;
    std::uint32_t next = first;
    for (std::size_t photon = 0; photon < kSize; ++photon) {
        const std::uint32_t count = num_bounces_[photon];
        next_bounce[photon] = next;
        if (count == 0) continue;
        block.paths.push_back({power_[photon], next, static_cast<std::uint8_t>(photon % 2)});
        next += count;
    }
    for (const Arrival& arrival : arrivals_) {
        const std::uint32_t bounce = next_bounce[arrival.photon]++;
        block.bounces[bounce] = arrival.bounce;
        block.directions[bounce] = arrival.w_back;
        if (options_.keep_positions) block.positions[bounce] = arrival.position;
    }
}

}  // namespace patina
