// A channel of three glossy plates under two lamps, and what a path tracer sees in it.
#pragma once

#include "patina/transport/direct.h"
#include "patina/transport/path_tracer.h"

#include "support/lit_scene.h"
#include "support/scenes.h"
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patina {

// A floor between two walls, with gaps in the corners: light that a texel sends on is computed for
// its centre, which is wrong close to an edge. Two lamps above, nothing shadowed.
struct Channel {
    enum Plate { floor, left, right };

    static constexpr int kSide = 32;            // texels along a plate's side
    static constexpr int kPitch = kSide + 4;    // columns from plate to plate
    static constexpr double kNarrowest = 0.15;  // sigma of the right wall [rad]

    LitScene scene = [] {
        Mesh mesh = rectangle({-0.35, 0, 0}, {0.7, 0, 0}, Vec3::UnitY(), plate_uv(floor));
        append(mesh, rectangle({-0.5, 0, 0.2}, Vec3::UnitY(), {0, 0, 0.8}, plate_uv(left)));
        append(mesh, rectangle({0.5, 1, 0.2}, -Vec3::UnitY(), {0, 0, 0.8}, plate_uv(right)));
        return LitScene(
            mesh, {}, {point_light(Vec3(-0.1, 0.4, 1.6), 1), point_light(Vec3(0.1, 0.7, 1.8), 2)});
    }();
    TexelAtlas atlas = build_atlas(scene.mesh, 3 * kPitch, kSide);
    std::vector<LargeVector<DirectLight>> direct;  // per lamp
    std::vector<Reflectance> maps;

    Channel() {
        for (const Light& light : scene.lights) {
            direct.push_back(direct_light(scene.surface(), atlas, light));
        }
        const std::array<Reflectance, 3> of_plate = {
            Reflectance{Rgb(0.5, 0.4, 0.3), 0.8, 0.25},
            Reflectance{Rgb(0.2, 0.3, 0.4), 1.0, 0.3},
            Reflectance{Rgb(0.3, 0.2, 0.3), 4.0, kNarrowest},
        };
        for (const Texel& texel : atlas.texels) {
            maps.push_back(of_plate[std::size_t(texel.column / kPitch)]);
        }
    }

    // Texels of a plate; columns and rows from begin to end - 1, counted from the plate's corner.
    [[nodiscard]] std::vector<TexelId> patch(
        Plate plate, int column_begin, int column_end, int row_begin, int row_end) const {
        std::vector<TexelId> texels;
        for (int row = row_begin; row < row_end; ++row) {
            for (int column = column_begin; column < column_end; ++column) {
                texels.push_back(
                    atlas.cell_texel[std::size_t(row * atlas.width + plate * kPitch + column)]);
            }
        }
        return texels;
    }
    // The floor in two halves, and the walls.
    [[nodiscard]] std::array<std::vector<TexelId>, 4> patches() const {
        return {patch(floor, 0, kSide / 2, 0, kSide),
                patch(floor, kSide / 2, kSide, 0, kSide),
                patch(left, 0, kSide, 0, kSide),
                patch(right, 0, kSide, 0, kSide)};
    }
    // The middle of the floor, and where it is looked at from: its mirror image is seen in the left
    // wall's middle.
    [[nodiscard]] std::vector<TexelId> looked_at() const { return patch(floor, 8, 24, 8, 24); }
    [[nodiscard]] static Vec3 towards_camera() { return Vec3(0.6, 0.1, 0.8).normalized(); }

  private:
    // Plates of 32 x 32 texels; texel borders are cell borders.
    static UvRectangle plate_uv(int plate) {
        const double width = 3 * kPitch;
        return {Vec2(plate * kPitch / width, 0), Vec2((plate * kPitch + kSide) / width, 1)};
    }
};

// Light sent on is summed over texel centres. By Euler and Maclaurin that differs from the integral
// by h^2 / 24 times the difference of the first derivative at the ends, in either direction. The
// sharpest function is the image of a lobe, a Gaussian of the width s = sigma D, whose derivative
// is at most 0.242 / s^2 of its integral; with two ends and two directions 4 x 0.242 / 24 (h /
// s)^2. h: side of a texel; D: mean distance from what is lit to what is reflected there. [-]
[[nodiscard]] inline double texel_centre_bias(double h, double sigma, double distance) {
    return 4 * 0.242 / 24 * square(h / (sigma * distance));
}
// The plates are 0.7 or more from each other in the mean, and the lamps 0.85 or more.
inline const double kChannelBias =
    texel_centre_bias(1.0 / Channel::kSide, Channel::kNarrowest, 0.7);

[[nodiscard]] inline double mean_over(const std::vector<TexelId>& patch, const auto& value) {
    double sum = 0;
    for (const TexelId texel : patch) sum += value(texel);
    return sum / double(patch.size());
}

[[nodiscard]] inline TexelId random_texel(const std::vector<TexelId>& patch,
                                          SobolSampler& sampler) {
    const auto [choice, unused] = sampler.next_pair();
    return patch[std::min(std::size_t(choice * double(patch.size())), patch.size() - 1)];
}

// Irradiance by bounced light at the centres of a patch's texels, by path tracing: of all lamps, in
// the mean over texels and channels. num_samples: of each of 128 randomisations.
[[nodiscard]] inline SampleMean traced_irradiance(const Channel& channel,
                                                  const std::vector<TexelId>& patch,
                                                  std::span<const Reflectance> maps,
                                                  int max_bounces,
                                                  std::size_t num_samples,
                                                  std::uint64_t seed) {
    PathTracerOptions options;
    options.max_bounces = max_bounces;
    const ReflectanceField field =
        ReflectanceField::per_texel(channel.scene.mesh, channel.atlas, maps);
    return randomised_mean(128, num_samples, seed, [&](SobolSampler& sampler) {
        const TexelId texel = random_texel(patch, sampler);
        return trace_indirect_irradiance(channel.scene.surface(),
                                         field,
                                         channel.scene.lights,
                                         channel.atlas.texels[texel].azimuth,
                                         channel.atlas.texels[texel].point,
                                         options,
                                         sampler)
            .mean();
    });
}

// One sample of what IndirectLobe holds, for a lobe of the given sigma [rad] at `point`: a
// direction drawn from the lobe itself, the radiance it meets by path tracing.
[[nodiscard]] inline OutgoingRadiance sample_through_lobe(const LitScene& scene,
                                                          const ReflectanceField& field,
                                                          const SurfacePoint& point,
                                                          const Vec3& w_v,
                                                          double sigma,
                                                          SobolSampler& sampler) {
    const Reflectance lobe{Rgb::Zero(), 1, sigma};
    const LobeSample sample = sample_lobe(lobe, point.normal, w_v, 0, sampler.next_pair());
    if (sample.pdf <= 0) return {};
    const auto hit = scene.tracer.intersect(scene.tracer.offset(point, sample.w_o), sample.w_o);
    if (!hit) return {};
    OutgoingRadiance radiance =
        trace_path(scene.surface(),
                   field,
                   scene.lights,
                   0,
                   surface_point(scene.mesh, hit->triangle, hit->barycentric),
                   -sample.w_o,
                   {},
                   sampler);
    const Rgb scale = kPi * sample.weight / square(sigma);
    radiance.direct *= scale;
    radiance.indirect *= scale;
    return radiance;
}

[[nodiscard]] inline SampleMean difference(const SampleMean& a, const SampleMean& b) {
    return {a.mean - b.mean,
            std::hypot(a.standard_error, b.standard_error),
            std::min(a.count, b.count)};
}

// The three widths of IndirectLobe.
struct LobeWidth {
    const char* name;
    double factor;  // of sigma
};
inline constexpr std::array<LobeWidth, 3> kLobeWidths = {
    {{"half", 0.5}, {"same", 1.0}, {"twice", 2.0}}};

}  // namespace patina
