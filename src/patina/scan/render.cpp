#include "patina/scan/render.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/transport/path_tracer.h"

namespace patina {
namespace {

// Pixels that a thread takes at once; short enough for progress and for Ctrl-C.
constexpr std::size_t kPixelBlock = 64;
// The stream of numbers for the footprint; the lamps' streams are below it.
constexpr std::uint32_t kFootprintStream = kMaxLampNumber;
constexpr std::uint32_t kNumStreams = kMaxLampNumber + 1;

class PixelRenderer {
  public:
    PixelRenderer(const SimulatedObject& object,
                  const Camera& camera,
                  std::span<const Light> lights,
                  const RenderOptions& options)
        : object_(object),
          camera_(camera),
          lights_(lights),
          options_(options),
          surface_(object.surface()),
          field_(object.field()) {}

    // sums: one per lamp, added to. Returns how many samples count.
    int render(int column, int row, std::span<Rgb> sums) const {
        const double azimuth = scanner_azimuth(object_, camera_.width, column);
        int num_seen = 0;
        for (int sample = 0; sample < options_.samples_per_pixel; ++sample) {
            const auto jitter = sampler(column, row, kFootprintStream, sample).next_pair();
            const Vec2 pixel = Vec2(column + jitter[0], row + jitter[1]) + options_.image_shift;
            const auto point = point_at_pixel(object_, camera_.width, camera_.height, pixel);
            if (!point || !is_seen(object_, camera_, *point, azimuth)) continue;
            ++num_seen;
            const Vec3 w_o = camera_.direction_from(point->position, azimuth);
            for (std::size_t i = 0; i < lights_.size(); ++i) {
                auto numbers = sampler(column, row, options_.lamp_numbers[i], sample);
                const OutgoingRadiance radiance = trace_path(surface_,
                                                             field_,
                                                             lights_.subspan(i, 1),
                                                             azimuth,
                                                             *point,
                                                             w_o,
                                                             PathTracerOptions{},
                                                             numbers);
                sums[i] += radiance.direct + radiance.indirect;
            }
        }
        return num_seen;
    }

  private:
    [[nodiscard]] SobolSampler sampler(int column,
                                       int row,
                                       std::uint32_t stream,
                                       int sample) const {
        const auto pixel =
            std::uint64_t(row) * std::uint64_t(camera_.width) + std::uint64_t(column);
        const auto num_pixels = std::uint64_t(camera_.width) * std::uint64_t(camera_.height);
        const std::uint64_t element =
            (std::uint64_t(options_.camera_index) * kNumStreams + stream) * num_pixels + pixel;
        return {options_.seed, Pass::path_tracer, element, std::uint32_t(sample)};
    }

    const SimulatedObject& object_;
    const Camera& camera_;
    std::span<const Light> lights_;
    const RenderOptions& options_;
    Surface surface_;
    ReflectanceField field_;
};

}  // namespace

RenderedImages render_lamps(const SimulatedObject& object,
                            const Camera& camera,
                            std::span<const Light> lights,
                            const RenderOptions& options,
                            Progress& progress) {
    PATINA_CHECK_EQ(options.lamp_numbers.size(), lights.size());
    for (const std::uint32_t number : options.lamp_numbers) PATINA_CHECK_LT(number, kMaxLampNumber);
    const PixelRenderer renderer(object, camera, lights, options);
    RenderedImages images;
    images.radiance.assign(lights.size(), Image(camera.width, camera.height, 3));
    images.seen = Image(camera.width, camera.height, 1);
    const auto render_block = [&](std::size_t begin, std::size_t end) {
        std::vector<Rgb> sums(lights.size());
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
            const int column = int(pixel % std::size_t(camera.width));
            const int row = int(pixel / std::size_t(camera.width));
            std::fill(sums.begin(), sums.end(), Rgb::Zero());
            const int num_seen = renderer.render(column, row, sums);
            if (2 * num_seen < options.samples_per_pixel) continue;
            images.seen.data[pixel] = 1;
            for (std::size_t i = 0; i < lights.size(); ++i) {
                for (int channel = 0; channel < 3; ++channel) {
                    images.radiance[i].at(column, row, channel) =
                        float(sums[i][channel] / num_seen);
                }
            }
        }
        progress.advance((end - begin) * std::uint64_t(options.samples_per_pixel) * lights.size());
    };
    parallel_blocks(images.seen.data.size(), kPixelBlock, render_block);
    return images;
}

bool is_seen(const SimulatedObject& object,
             const Camera& camera,
             const SurfacePoint& point,
             double azimuth) {
    const Vec3 w_o = camera.direction_from(point.position, azimuth);
    if (!faces(point, w_o)) return false;
    const double distance = camera.distance_from(point.position, azimuth);
    return !object.tracer.occluded(object.tracer.offset(point, w_o), w_o, distance);
}

double scanner_azimuth(const SimulatedObject& object, int columns, int column) {
    return object.range_frame ? column_azimuth(*object.range_frame, columns, column) : 0.0;
}

}  // namespace patina
