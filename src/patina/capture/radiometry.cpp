#include "patina/base/error.h"
#include "patina/base/parallel.h"
#include "patina/capture/capture.h"
#include "patina/capture/json_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// Below this stored value of 8 bits a mask leaves the pixel out; from the format.
constexpr float kMaskThreshold = 128.0F / 255.0F;

// What was exposed, from a stored value v in [0, 1] of an integer image.
double undo_response(const Radiometry& radiometry, double v) {
    switch (radiometry.response) {
        case ResponseKind::linear:
            return v;
        case ResponseKind::srgb:  // IEC 61966-2-1
            return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
        case ResponseKind::gamma:
            return std::pow(v, radiometry.gamma);
    }
    return v;
}

// An image of a shot; the size was checked when the description was read, but the file may have
// changed, or the description may have been made in memory.
StoredImage read_shot_image(const CaptureDescription& description,
                            const Camera& camera,
                            const std::string& name,
                            const std::string& field) {
    StoredImage stored = read_image(description.folder / name, field);
    const Image& image = stored.image;
    if (image.width != camera.width || image.height != camera.height) {
        throw Error(description.file.string(),
                    field,
                    fmt::format("{} has {} x {} pixels", quote(name), image.width, image.height),
                    fmt::format("{} x {}", camera.width, camera.height));
    }
    return stored;
}

// p of a pixel's channel, NaN or infinite where the file says so.
double linear_value(const Radiometry& radiometry,
                    const StoredImage& stored,
                    std::size_t pixel,
                    int channel) {
    const auto channels = std::size_t(stored.image.channels);
    const std::size_t source = std::min(std::size_t(channel), channels - 1);
    const double v = stored.image.data[pixel * channels + source];
    return stored.kind == SampleKind::floating ? v : undo_response(radiometry, v);
}

bool is_saturated(const Radiometry& radiometry, const StoredImage& stored, std::size_t pixel) {
    const bool integer = stored.kind != SampleKind::floating;
    if (!integer && !radiometry.saturation) return false;
    const auto level = float(radiometry.saturation.value_or(1.0));
    const auto channels = std::size_t(stored.image.channels);
    const float* const values = &stored.image.data[pixel * channels];
    return std::any_of(values, values + channels, [level](float v) { return v >= level; });
}

void apply_mask(const CaptureDescription& description,
                const Camera& camera,
                const std::string& name,
                const std::string& field,
                std::vector<std::uint8_t>& usable) {
    const StoredImage mask = read_shot_image(description, camera, name, field);
    if (mask.kind != SampleKind::unsigned8) {
        throw Error(description.file.string(),
                    field,
                    quote(name) + " is not an image of 8 bits",
                    "an image of 8 bits");
    }
    const auto channels = std::size_t(mask.image.channels);
    for (std::size_t pixel = 0; pixel < usable.size(); ++pixel) {
        const float* const values = &mask.image.data[pixel * channels];
        if (*std::min_element(values, values + channels) < kMaskThreshold) usable[pixel] = 0;
    }
}

}  // namespace

void multiply_lamps(double factor, CaptureDescription& description) {
    for (Light& light : description.lights) {
        light.intensity *= factor;
        light.irradiance *= factor;
    }
}

RadianceImage load_radiance(const CaptureDescription& description, std::size_t shot_index) {
    const Shot& shot = description.shots.at(shot_index);
    const Camera& camera = description.cameras[shot.camera];
    const Radiometry& radiometry = description.radiometry;
    const std::string path = item_path("shots", shot_index);
    const StoredImage stored =
        read_shot_image(description, camera, shot.image, field_path(path, "image"));
    StoredImage dark;
    if (!shot.dark.empty()) {
        dark = read_shot_image(description, camera, shot.dark, field_path(path, "dark"));
    }

    RadianceImage result;
    result.radiance = Image(camera.width, camera.height, 3);
    if (radiometry.has_noise) result.variance = Image(camera.width, camera.height, 3);
    const std::size_t num_pixels = std::size_t(camera.width) * std::size_t(camera.height);
    result.usable.assign(num_pixels, 1);
    parallel_for(num_pixels, [&](std::size_t pixel) {
        if (is_saturated(radiometry, stored, pixel)) result.usable[pixel] = 0;
        for (int channel = 0; channel < 3; ++channel) {
            double p = linear_value(radiometry, stored, pixel, channel);
            if (!dark.image.empty()) p -= linear_value(radiometry, dark, pixel, channel);
            const auto radiance = float(p / shot.exposure);
            const double variance =
                (square(radiometry.noise_read) + radiometry.noise_gain * std::max(p, 0.0)) /
                square(shot.exposure);
            // NaN compares false.
            if (!(std::abs(radiance) <= kMaxNumber && variance <= square(kMaxNumber))) {
                result.usable[pixel] = 0;
                continue;
            }
            const std::size_t slot = 3 * pixel + std::size_t(channel);
            result.radiance.data[slot] = radiance;
            if (radiometry.has_noise) result.variance.data[slot] = float(variance);
        }
    });
    if (!shot.mask.empty()) {
        apply_mask(description, camera, shot.mask, field_path(path, "mask"), result.usable);
    }
    return result;
}

}  // namespace patina
