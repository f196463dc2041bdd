#include "patina/base/check.h"
#include "patina/base/error.h"
#include "patina/capture/capture.h"
#include "patina/capture/json.h"

#include <fmt/format.h>

#include <cmath>

namespace patina {
namespace {

// A map of the truth with one or three channels as `channels` (1: the mean of three; 3: grey
// thrice).
Image read_truth_map(const CaptureDescription& description,
                     const std::string& name,
                     const std::string& field,
                     int channels) {
    const GeometrySource& geometry = description.geometry;
    const Image stored = read_image(description.folder / name, field).image;
    if (stored.width != geometry.texel_width || stored.height != geometry.texel_height) {
        throw Error(description.file.string(),
                    field,
                    fmt::format("{} has {} x {} pixels", quote(name), stored.width, stored.height),
                    fmt::format("{} x {}, the size of the texel domain",
                                geometry.texel_width,
                                geometry.texel_height));
    }
    if (stored.channels == channels) return stored;
    Image map(stored.width, stored.height, channels);
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            double sum = 0;
            for (int c = 0; c < stored.channels; ++c) sum += stored.at(x, y, c);
            for (int c = 0; c < channels; ++c) map.at(x, y, c) = float(sum / stored.channels);
        }
    }
    return map;
}

bool is_finite(const Image& image, int x, int y) {
    for (int c = 0; c < image.channels; ++c) {
        if (!std::isfinite(image.at(x, y, c))) return false;
    }
    return true;
}

// Texels where the truth is not a number are ignored, as the mask does it.
void mask_unknown(TruthMaps& maps) {
    for (int y = 0; y < maps.diffuse.height; ++y) {
        for (int x = 0; x < maps.diffuse.width; ++x) {
            const bool known = is_finite(maps.diffuse, x, y) && is_finite(maps.specular, x, y) &&
                               is_finite(maps.roughness, x, y);
            if (known) continue;
            if (maps.mask.empty()) maps.mask = Image(maps.diffuse.width, maps.diffuse.height, 1, 1);
            maps.mask.at(x, y) = 0;
        }
    }
}

}  // namespace

TruthMaps load_truth(const CaptureDescription& description) {
    PATINA_CHECK(description.truth.has_value());
    const Truth& truth = *description.truth;
    TruthMaps maps;
    maps.diffuse = read_truth_map(description, truth.diffuse, "truth.diffuse", 3);
    maps.specular = read_truth_map(description, truth.specular, "truth.specular", 1);
    maps.roughness = read_truth_map(description, truth.roughness, "truth.roughness", 1);
    if (!truth.mask.empty()) {
        maps.mask = read_truth_map(description, truth.mask, "truth.mask", 1);
    }
    mask_unknown(maps);
    return maps;
}

}  // namespace patina
