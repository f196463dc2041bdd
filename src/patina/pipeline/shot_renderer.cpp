#include "patina/pipeline/shot_renderer.h"

#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/transport/path_tracer.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace patina {
namespace {

// Pixels that a thread takes at once; short enough for progress and for Ctrl-C.
constexpr std::size_t kPixelBlock = 64;
// Every pixel of every shot has two streams of random numbers.
enum class Stream : std::uint64_t { footprint = 0, light = 1 };
constexpr std::uint64_t kNumStreams = 2;

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
                  std::size_t shot,
                  const ShotRenderOptions& options)
        : capture_(capture),
          surface_(surface),
          locator_(locator),
          field_(ReflectanceField::per_texel(capture.mesh, capture.atlas, reflectance)),
          camera_(capture.description.cameras[capture.description.shots[shot].camera]),
          shot_(shot),
          options_(options) {
        for (const std::size_t light : capture.description.shots[shot].lights) {
            lights_.push_back(capture.description.lights[light]);
        }
    }

    struct Pixel {
        Rgb radiance = Rgb::Zero();
        std::uint8_t status = 0;
    };
    // status: per texel of the atlas.
    [[nodiscard]] Pixel render(int column, int row, std::span<const std::uint8_t> status) const {
        const double azimuth = scanner_azimuth(column);
        Pixel pixel;
        int num_seen = 0;
        for (int sample = 0; sample < options_.samples_per_pixel; ++sample) {
            const auto jitter = sampler(column, row, Stream::footprint, sample).next_pair();
            const auto shown = look(Vec2(column + jitter[0], row + jitter[1]), azimuth);
            if (!shown) continue;
            ++num_seen;
            if (shown->texel != kNoTexel) {
                pixel.status = std::max(pixel.status, status[shown->texel]);
            }
            auto numbers = sampler(column, row, Stream::light, sample);
            const OutgoingRadiance radiance = trace_path(surface_,
                                                         field_,
                                                         lights_,
                                                         azimuth,
                                                         shown->point,
                                                         shown->w_o,
                                                         PathTracerOptions{},
                                                         numbers);
            pixel.radiance += radiance.direct + radiance.indirect;
        }
        return finish(pixel, num_seen);
    }

  private:
    [[nodiscard]] bool is_registered() const { return camera_.model == CameraModel::registered; }

    // Registered images hold the surface where at least half of the texel shows it; others mix it
    // with what lies behind.
    [[nodiscard]] Pixel finish(Pixel pixel, int num_seen) const {
        const int total = options_.samples_per_pixel;
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

    [[nodiscard]] SobolSampler sampler(int column, int row, Stream stream, int sample) const {
        const auto pixel =
            std::uint64_t(row) * std::uint64_t(camera_.width) + std::uint64_t(column);
        const auto num_pixels = std::uint64_t(camera_.width) * std::uint64_t(camera_.height);
        const std::uint64_t element =
            (std::uint64_t(shot_) * kNumStreams + std::uint64_t(stream)) * num_pixels + pixel;
        return {options_.seed, Pass::rendered_shots, element, std::uint32_t(sample)};
    }

    const Capture& capture_;
    const Surface& surface_;
    const UvLocator& locator_;
    ReflectanceField field_;
    const Camera& camera_;
    std::size_t shot_;
    const ShotRenderOptions& options_;
    std::vector<Light> lights_;
};

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
    status_.reserve(atlas.texels.size());
    for (const Texel& texel : atlas.texels) {
        const int x = texel.column;
        const int y = texel.row;
        Reflectance reflectance;
        for (int channel = 0; channel < 3; ++channel) {
            reflectance.diffuse[channel] = double(maps.diffuse.at(x, y, channel));
        }
        reflectance.specular = double(maps.specular.at(x, y));
        reflectance.roughness = std::max(double(maps.roughness.at(x, y)), kMinRoughness);
        reflectance_.push_back(reflectance);
        status_.push_back(std::uint8_t(maps.status.at(x, y)));
    }
}

RenderedShot ShotRenderer::render(std::size_t shot,
                                  const ShotRenderOptions& options,
                                  Progress& progress) const {
    const Surface surface{&capture_.mesh, &tracer_};
    const PixelRenderer renderer(capture_, surface, locator_, reflectance_, shot, options);
    const Camera& camera = capture_.description.cameras[capture_.description.shots[shot].camera];
    RenderedShot rendered;
    rendered.radiance = Image(camera.width, camera.height, 3);
    rendered.status.resize(std::size_t(camera.width) * std::size_t(camera.height));
    parallel_blocks(rendered.status.size(), kPixelBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const int column = int(i % std::size_t(camera.width));
            const int row = int(i / std::size_t(camera.width));
            const PixelRenderer::Pixel pixel = renderer.render(column, row, status_);
            rendered.status[i] = pixel.status;
            for (int channel = 0; channel < 3; ++channel) {
                rendered.radiance.at(column, row, channel) = float(pixel.radiance[channel]);
            }
        }
        progress.advance((end - begin) * std::uint64_t(options.samples_per_pixel));
    });
    return rendered;
}

std::uint64_t ShotRenderer::num_paths(std::size_t shot, const ShotRenderOptions& options) const {
    const Camera& camera = capture_.description.cameras[capture_.description.shots[shot].camera];
    return std::uint64_t(camera.width) * std::uint64_t(camera.height) *
           std::uint64_t(options.samples_per_pixel);
}

}  // namespace patina
