#include "simulated_capture.h"

#include "patina/base/random.h"
#include "patina/image/image.h"
#include "patina/scan/render.h"
#include "patina/scan/sensor.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace patina {

SimulatedCapture::SimulatedCapture(ObjectKind kind,
                                   const std::vector<std::size_t>& lamps,
                                   const ScanOptions& options)
    : SimulatedCapture(make_object(kind, options.columns, options.rows), lamps, options) {}

SimulatedCapture::SimulatedCapture(const SimulatedObject& object,
                                   const std::vector<std::size_t>& lamps,
                                   const ScanOptions& options) {
    Progress progress;
    simulate_capture(object, lamps, options, progress, folder_.path());
    capture_ = load_capture(folder_.path());
    truth_ = load_truth(capture_.description);
}

SimulatedCapture::SimulatedCapture(ObjectKind kind,
                                   const ScanOptions& options,
                                   const std::vector<Light>& lamps) {
    Progress progress;
    const SimulatedObject object = make_object(kind, options.columns, options.rows);
    capture_ = simulate_rig(object, options);
    truth_ = truth_maps(object, options);
    CaptureDescription& description = capture_.description;
    description.folder = folder_.path();
    description.lights = lamps;
    RenderOptions render;
    render.samples_per_pixel = options.samples_per_pixel;
    render.seed = options.seed;
    render.lamp_numbers.resize(lamps.size());
    std::iota(render.lamp_numbers.begin(), render.lamp_numbers.end(), 0U);
    RenderedImages images =
        render_lamps(object, description.cameras.front(), lamps, render, progress);
    Shot shot;
    shot.mask = "mask.png";
    write_png(folder_ / shot.mask, images.seen);
    for (std::size_t i = 0; i < lamps.size(); ++i) {
        shot.image = lamps[i].id + ".exr";
        shot.lights = {i};
        add_noise({options.noise_read, options.noise_gain},
                  images.seen,
                  options.seed,
                  i,
                  images.radiance[i]);
        write_exr(folder_ / shot.image, images.radiance[i]);
        description.shots.push_back(shot);
    }
}

Estimate SimulatedCapture::estimate(const EstimateOptions& options) const {
    Progress progress;
    return estimate_reflectance(capture_, options, progress);
}

void SimulatedCapture::spoil(double share) {
    for (const Shot& shot : capture_.description.shots) {
        if (shot.heldout) continue;
        const auto file = folder_.path() / shot.image;
        Image image = read_image(file, shot.image).image;
        const float brightest = *std::max_element(image.data.begin(), image.data.end());
        for (std::size_t pixel = 0; 3 * pixel < image.data.size(); ++pixel) {
            Rng rng(
                30, Pass::tests, (&shot - capture_.description.shots.data()) * 1'000'000 + pixel);
            if (rng.uniform() >= share) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                image.data[3 * pixel + c] = 2 * brightest * float(rng.uniform());
            }
        }
        write_exr(file, image);
    }
}

std::vector<double> SimulatedCapture::row_errors(const Estimate& estimate, int channel) const {
    const TexelAtlas& atlas = capture_.atlas;
    std::vector<double> sums(std::size_t(atlas.height), 0.0);
    std::vector<double> counts(sums.size(), 0.0);
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
        const auto [column, row] = std::pair(atlas.texels[i].column, atlas.texels[i].row);
        if (4 * column < atlas.width || 4 * column >= 3 * atlas.width) continue;
        const double truth = double(truth_.diffuse.at(column, row, channel));
        sums[std::size_t(row)] += estimate.maps[i].diffuse[channel] / truth - 1;
        counts[std::size_t(row)] += 1;
    }
    for (std::size_t row = 0; row < sums.size(); ++row) sums[row] /= counts[row];
    return sums;
}

}  // namespace patina
