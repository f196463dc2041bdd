#include "patina/scan/render.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/transport/path_budget.h"
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
          is_adaptive_(options.adaptive && is_worth_a_pilot(options.samples_per_pixel)),
          surface_(object.surface()),
          field_(object.field()) {}

    // Paths of every pixel.
    [[nodiscard]] std::vector<int> plan(Progress& progress) const {
        const auto num_pixels = std::size_t(camera_.width) * std::size_t(camera_.height);
        if (!is_adaptive_) return std::vector<int>(num_pixels, options_.samples_per_pixel);
        const auto trace = [&](std::size_t pixel, std::uint32_t path_stream, int num_paths) {
            std::vector<Rgb> sums(lights_.size(), Rgb::Zero());
            PathSum paths;
            paths.num_seen = render(pixel, path_stream, num_paths, sums);
            for (const Rgb& sum : sums) paths.radiance += sum;
            return paths;
        };
        return plan_paths(
            camera_.width, camera_.height, options_.samples_per_pixel, trace, progress);
    }

    // path_stream: of plan_paths(). sums: one per lamp, added to. Returns how many samples count.
    int render(std::size_t pixel,
               std::uint32_t path_stream,
               int num_samples,
               std::span<Rgb> sums) const {
        const int column = int(pixel % std::size_t(camera_.width));
        const int row = int(pixel / std::size_t(camera_.width));
        const double azimuth = scanner_azimuth(object_, camera_.width, column);
        int num_seen = 0;
        for (int sample = 0; sample < num_samples; ++sample) {
            const auto jitter = sampler(pixel, path_stream, kFootprintStream, sample).next_pair();
            const Vec2 position = Vec2(column + jitter[0], row + jitter[1]) + options_.image_shift;
            const auto point = point_at_pixel(object_, camera_.width, camera_.height, position);
            if (!point || !is_seen(object_, camera_, *point, azimuth)) continue;
            ++num_seen;
            const Vec3 w_o = camera_.direction_from(point->position, azimuth);
            for (std::size_t i = 0; i < lights_.size(); ++i) {
                auto numbers = sampler(pixel, path_stream, options_.lamp_numbers[i], sample);
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
    [[nodiscard]] SobolSampler sampler(std::size_t pixel,
                                       std::uint32_t path_stream,
                                       std::uint32_t stream,
                                       int sample) const {
        const auto num_pixels = std::uint64_t(camera_.width) * std::uint64_t(camera_.height);
        const std::uint64_t of_camera = std::uint64_t(options_.camera_index) * kNumStreams + stream;
        if (!is_adaptive_) {
            return {options_.seed,
                    Pass::path_tracer,
                    of_camera * num_pixels + pixel,
                    std::uint32_t(sample)};
        }
        return {options_.seed,
                Pass::adaptive_path_tracer,
                (of_camera * kNumPathStreams + path_stream) * num_pixels + pixel,
                std::uint32_t(sample)};
    }

    const SimulatedObject& object_;
    const Camera& camera_;
    std::span<const Light> lights_;
    const RenderOptions& options_;
    bool is_adaptive_;
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
    const std::vector<int> plan = renderer.plan(progress);
    const auto render_block = [&](std::size_t begin, std::size_t end) {
        std::vector<Rgb> sums(lights.size());
        std::uint64_t num_paths = 0;
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
            const int column = int(pixel % std::size_t(camera.width));
            const int row = int(pixel / std::size_t(camera.width));
            std::fill(sums.begin(), sums.end(), Rgb::Zero());
            const int num_seen = renderer.render(pixel, 0, plan[pixel], sums);
            num_paths += std::uint64_t(plan[pixel]);
            if (2 * num_seen < plan[pixel]) continue;
            images.seen.data[pixel] = 1;
            for (std::size_t i = 0; i < lights.size(); ++i) {
                for (int channel = 0; channel < 3; ++channel) {
                    images.radiance[i].at(column, row, channel) =
                        float(sums[i][channel] / num_seen);
                }
            }
        }
        progress.advance(num_paths * lights.size());
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
