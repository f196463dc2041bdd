#include "patina/pipeline/shot_renderer.h"

#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/transport/path_budget.h"
#include "patina/transport/path_tracer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace patina {
namespace {

// Pixels that a thread takes at once; short enough for progress and for Ctrl-C.
constexpr std::size_t kPixelBlock = 64;
// Every pixel of every shot has two streams of random numbers.
enum class Stream : std::uint64_t { footprint = 0, light = 1 };
constexpr std::uint64_t kNumStreams = 2;
// Samples of a pixel that show what the maps' errors do to it: lobes vary little across a pixel.
constexpr int kErrorSamples = 4;

// What one sample of a pixel shows.
struct Footprint {
    SurfacePoint point;
    TexelId texel = kNoTexel;
    Vec3 w_o = Vec3::UnitZ();
};

class PixelRenderer {
  public:
    PixelRenderer(const Capture& capture,
                  const Surface& surface,
                  const UvLocator& locator,
                  std::span<const Reflectance> reflectance,
                  std::span<const LobeError> errors,
                  std::size_t shot,
                  const ShotRenderOptions& options)
        : capture_(capture),
          surface_(surface),
          locator_(locator),
          reflectance_(reflectance),
          errors_(errors),
          field_(ReflectanceField::per_texel(capture.mesh, capture.atlas, reflectance)),
          camera_(capture.description.cameras[capture.description.shots[shot].camera]),
          shot_(shot),
          options_(options),
          is_adaptive_(options.adaptive && is_worth_a_pilot(options.samples_per_pixel)) {
        for (const std::size_t light : capture.description.shots[shot].lights) {
            lights_.push_back(capture.description.lights[light]);
        }
        if (options.with_lobe_errors) collect_used_lights();
    }

    struct Pixel {
        Rgb radiance = Rgb::Zero();
        std::uint8_t status = 0;
        Rgb lobe_variance = Rgb::Zero();
        Rgb noise_variance = Rgb::Zero();
    };
    // status: per texel of the atlas.
    [[nodiscard]] Pixel render(std::size_t index,
                               int num_paths,
                               std::span<const std::uint8_t> status) const {
        const double azimuth = scanner_azimuth(int(index % std::size_t(camera_.width)));
        Pixel pixel;
        ErrorSums errors;
        const auto use = [&](const Footprint& shown) {
            if (shown.texel == kNoTexel) return;
            pixel.status = std::max(pixel.status, status[shown.texel]);
            if (options_.with_lobe_errors && errors.count < kErrorSamples) {
                add_errors(shown, azimuth, errors);
            }
        };
        PathSum paths = trace(index, 0, is_adaptive_ ? num_paths / 2 : num_paths, use);
        if (is_adaptive_) {
            const PathSum second = trace(index, 1, num_paths / 2, use);
            pixel.noise_variance = noise_variance(paths, second);
            paths.radiance += second.radiance;
            paths.num_seen += second.num_seen;
        }
        pixel.radiance = paths.radiance;
        pixel.lobe_variance = errors.variance();
        return finish(pixel, paths.num_seen, num_paths);
    }

    // Paths of every pixel.
    [[nodiscard]] std::vector<int> plan(Progress& progress) const {
        const auto num_pixels = std::size_t(camera_.width) * std::size_t(camera_.height);
        if (!is_adaptive_) return std::vector<int>(num_pixels, options_.samples_per_pixel);
        const auto pilot = [&](std::size_t index, std::uint32_t path_stream, int num_paths) {
            return trace(index, path_stream, num_paths, [](const Footprint&) {});
        };
        return plan_paths(
            camera_.width, camera_.height, options_.samples_per_pixel, pilot, progress);
    }
    [[nodiscard]] bool is_adaptive() const { return is_adaptive_; }

  private:
    // path_stream: of plan_paths(). Calls use(Footprint) for every sample that shows the surface.
    template <typename Use>
    [[nodiscard]] PathSum trace(std::size_t index,
                                std::uint32_t path_stream,
                                int num_paths,
                                const Use& use) const {
        const int column = int(index % std::size_t(camera_.width));
        const int row = int(index / std::size_t(camera_.width));
        const double azimuth = scanner_azimuth(column);
        PathSum paths;
        for (int sample = 0; sample < num_paths; ++sample) {
            const auto jitter = sampler(index, path_stream, Stream::footprint, sample).next_pair();
            const auto shown = look(Vec2(column + jitter[0], row + jitter[1]), azimuth);
            if (!shown) continue;
            ++paths.num_seen;
            use(*shown);
            auto numbers = sampler(index, path_stream, Stream::light, sample);
            const OutgoingRadiance radiance = trace_path(surface_,
                                                         field_,
                                                         lights_,
                                                         azimuth,
                                                         shown->point,
                                                         shown->w_o,
                                                         PathTracerOptions{},
                                                         numbers);
            paths.radiance += radiance.direct + radiance.indirect;
        }
        return paths;
    }

    // Of the used shots of the same camera.
    void collect_used_lights() {
        const CaptureDescription& description = capture_.description;
        std::vector<std::uint8_t> used(description.lights.size(), 0);
        for (const Shot& shot : description.shots) {
            if (shot.heldout || shot.camera != description.shots[shot_].camera) continue;
            for (const std::size_t light : shot.lights) used[light] = 1;
        }
        for (std::size_t i = 0; i < used.size(); ++i) {
            if (used[i] != 0) used_lights_.push_back(description.lights[i]);
        }
    }

    // Change of the radiance by one standard error of Ps and of sigma, summed over samples.
    struct ErrorSums {
        Rgb specular = Rgb::Zero();
        Rgb roughness = Rgb::Zero();
        int count = 0;

        [[nodiscard]] Rgb variance() const {
            return (specular.square() + roughness.square()) / square(std::max(count, 1));
        }
    };

    // Irradiance of a light and the lobe per Ps there; nothing where it does not shine.
    struct LitLobe {
        Rgb irradiance = Rgb::Zero();
        LobeDerivative lobe;
    };
    [[nodiscard]] LitLobe lit_lobe(const Light& light,
                                   const Footprint& shown,
                                   double azimuth,
                                   double roughness) const {
        const LightSample sample = sample_light(light, shown.point.position, azimuth);
        if (!is_lit(surface_, shown.point, sample)) return {};
        const Vec3& n = shown.point.normal;
        const double cos_i = n.dot(sample.w_i);
        return {sample.irradiance * cos_i,
                lobe_derivative(mirror_angle_squared(n, sample.w_i, shown.w_o),
                                cos_i,
                                n.dot(shown.w_o),
                                roughness)};
    }

    [[nodiscard]] LobeDerivative deepest_used_look(const Footprint& shown,
                                                   double azimuth,
                                                   double roughness) const {
        LobeDerivative deepest;
        for (const Light& light : used_lights_) {
            const LobeDerivative lobe = lit_lobe(light, shown, azimuth, roughness).lobe;
            deepest.value = std::max(deepest.value, lobe.value);
            deepest.by_roughness = std::max(deepest.by_roughness, lobe.by_roughness);
        }
        return deepest;
    }

    void add_errors(const Footprint& shown, double azimuth, ErrorSums& sums) const {
        const Reflectance& map = reflectance_[shown.texel];
        const LobeError& error = errors_[shown.texel];
        const LobeDerivative used =
            error.filled ? deepest_used_look(shown, azimuth, map.roughness) : LobeDerivative();
        ++sums.count;
        for (const Light& light : lights_) {
            const LitLobe lit = lit_lobe(light, shown, azimuth, map.roughness);
            const double value = std::max(0.0, lit.lobe.value - used.value);
            const double by_roughness = std::max(0.0, lit.lobe.by_roughness - used.by_roughness);
            sums.specular += lit.irradiance * error.specular * value;
            sums.roughness += lit.irradiance * map.specular * error.roughness * by_roughness;
        }
    }

    [[nodiscard]] bool is_registered() const { return camera_.model == CameraModel::registered; }

    // Registered images hold the surface where at least half of the texel shows it; others mix it
    // with what lies behind.
    [[nodiscard]] Pixel finish(Pixel pixel, int num_seen, int total) const {
        const bool is_whole = is_registered() ? 2 * num_seen >= total : num_seen == total;
        if (!is_whole) pixel.status = 0;
        if (is_registered() && !is_whole) return {};
        const int count = is_registered() ? num_seen : total;
        pixel.radiance /= count;
        return pixel;
    }

    [[nodiscard]] double scanner_azimuth(int column) const {
        const GeometrySource& geometry = capture_.description.geometry;
        const bool turns = !geometry.range_file.empty() &&
                           geometry.range_frame.projection == RangeProjection::cylindrical;
        return turns ? column_azimuth(geometry.range_frame, camera_.width, column) : 0.0;
    }

    // What lies at a position in the image, if the camera sees its front.
    [[nodiscard]] std::optional<Footprint> look(const Vec2& position, double azimuth) const {
        Footprint shown;
        if (is_registered()) {
            const auto point =
                locator_.find({position.x() / camera_.width, 1 - position.y() / camera_.height});
            if (!point) return std::nullopt;
            shown.point = *point;
            shown.w_o = camera_.direction_from(point->position, azimuth);
            if (!is_visible(shown, azimuth)) return std::nullopt;
        } else {
            const Ray ray = camera_.ray(position);
            const auto hit = surface_.tracer->intersect(ray.origin, ray.direction);
            if (!hit) return std::nullopt;
            shown.point = surface_point(capture_.mesh, hit->triangle, hit->barycentric);
            shown.w_o = -ray.direction;
            if (!faces(shown.point, shown.w_o)) return std::nullopt;
        }
        shown.texel =
            capture_.atlas.lookup(capture_.mesh, shown.point.triangle, shown.point.barycentric);
        return shown;
    }

    [[nodiscard]] bool is_visible(const Footprint& shown, double azimuth) const {
        if (!faces(shown.point, shown.w_o)) return false;
        const Vec3 origin = surface_.tracer->offset(shown.point, shown.w_o);
        return !surface_.tracer->occluded(
            origin, shown.w_o, camera_.distance_from(origin, azimuth));
    }

    [[nodiscard]] SobolSampler sampler(std::size_t index,
                                       std::uint32_t path_stream,
                                       Stream stream,
                                       int sample) const {
        const auto num_pixels = std::uint64_t(camera_.width) * std::uint64_t(camera_.height);
        const std::uint64_t of_shot = std::uint64_t(shot_) * kNumStreams + std::uint64_t(stream);
        if (!is_adaptive_) {
            return {options_.seed,
                    Pass::rendered_shots,
                    of_shot * num_pixels + index,
                    std::uint32_t(sample)};
        }
        return {options_.seed,
                Pass::adaptive_rendered_shots,
                (of_shot * kNumPathStreams + path_stream) * num_pixels + index,
                std::uint32_t(sample)};
    }

    const Capture& capture_;
    const Surface& surface_;
    const UvLocator& locator_;
    std::span<const Reflectance> reflectance_;
    std::span<const LobeError> errors_;
    ReflectanceField field_;
    const Camera& camera_;
    std::size_t shot_;
    const ShotRenderOptions& options_;
    bool is_adaptive_;
    std::vector<Light> lights_;
    std::vector<Light> used_lights_;  // empty unless lobe errors are asked for
};

// Where nothing is known, the value may be off by all of itself.
double known_error(float standard_error, double value) {
    return std::isfinite(standard_error) ? double(standard_error) : value;
}

}  // namespace

ShotRenderer::ShotRenderer(const Capture& capture,
                           const ReflectanceMaps& maps,
                           const std::string& result_place)
    : capture_(capture),
      tracer_(capture.mesh),
      locator_(capture.mesh, capture.atlas.width, capture.atlas.height) {
    const TexelAtlas& atlas = capture.atlas;
    if (maps.status.width != atlas.width || maps.status.height != atlas.height) {
        throw Error(
            result_place,
            "",
            fmt::format("has maps of {} x {} texels", maps.status.width, maps.status.height),
            fmt::format("{} x {}, as the capture", atlas.width, atlas.height));
    }
    reflectance_.reserve(atlas.texels.size());
    errors_.reserve(atlas.texels.size());
    status_.reserve(atlas.texels.size());
    for (const Texel& texel : atlas.texels) {
        const int x = texel.column;
        const int y = texel.row;
        Reflectance reflectance;
        LobeError error;
        for (int channel = 0; channel < 3; ++channel) {
            reflectance.diffuse[channel] = double(maps.diffuse.at(x, y, channel));
        }
        reflectance.specular = double(maps.specular.at(x, y));
        reflectance.roughness = std::max(double(maps.roughness.at(x, y)), kMinRoughness);
        error.specular = known_error(maps.specular_stderr.at(x, y), reflectance.specular);
        error.roughness = known_error(maps.roughness_stderr.at(x, y), reflectance.roughness);
        reflectance_.push_back(reflectance);
        status_.push_back(std::uint8_t(maps.status.at(x, y)));
        error.filled = TexelStatus(status_.back()) != TexelStatus::measured;
        errors_.push_back(error);
    }
}

RenderedShot ShotRenderer::render(std::size_t shot,
                                  const ShotRenderOptions& options,
                                  Progress& progress) const {
    const Surface surface{&capture_.mesh, &tracer_};
    const PixelRenderer renderer(capture_, surface, locator_, reflectance_, errors_, shot, options);
    const Camera& camera = capture_.description.cameras[capture_.description.shots[shot].camera];
    RenderedShot rendered;
    rendered.radiance = Image(camera.width, camera.height, 3);
    if (options.with_lobe_errors) rendered.lobe_variance = Image(camera.width, camera.height, 3);
    if (renderer.is_adaptive()) rendered.noise_variance = Image(camera.width, camera.height, 3);
    rendered.status.resize(std::size_t(camera.width) * std::size_t(camera.height));
    const auto store = [](const Rgb& value, std::size_t pixel, Image& image) {
        if (image.empty()) return;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            image.data[3 * pixel + channel] = float(value[int(channel)]);
        }
    };
    const std::vector<int> plan = renderer.plan(progress);
    parallel_blocks(plan.size(), kPixelBlock, [&](std::size_t begin, std::size_t end) {
        std::uint64_t num_paths = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const PixelRenderer::Pixel pixel = renderer.render(i, plan[i], status_);
            rendered.status[i] = pixel.status;
            store(pixel.radiance, i, rendered.radiance);
            store(pixel.lobe_variance, i, rendered.lobe_variance);
            store(pixel.noise_variance, i, rendered.noise_variance);
            num_paths += std::uint64_t(plan[i]);
        }
        progress.advance(num_paths);
    });
    return rendered;
}

std::uint64_t ShotRenderer::num_paths(std::size_t shot, const ShotRenderOptions& options) const {
    const Camera& camera = capture_.description.cameras[capture_.description.shots[shot].camera];
    return std::uint64_t(camera.width) * std::uint64_t(camera.height) *
           std::uint64_t(options.samples_per_pixel);
}

}  // namespace patina
