// What kernels are timed on: a simulated object as the virtual scanner hands it out, with its true
// maps.
#pragma once

#include "patina/scan/scanner.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace patina {

// 512 columns; 256 rows of A, 512 of the others. Rows of maps: texels of the atlas.
struct ScannedObject {
    explicit ScannedObject(ObjectKind kind) {
        ScanOptions scan;
        scan.rows = kind == ObjectKind::a ? 256 : 512;
        const SimulatedObject object = make_object(kind, scan.columns, scan.rows);
        capture = simulate_rig(object, scan);
        tracer = std::make_unique<Tracer>(capture.mesh);
        surface = {&capture.mesh, tracer.get()};
        const TruthMaps truth = truth_maps(object, scan);
        for (const Texel& texel : capture.atlas.texels) {
            Reflectance& map = maps.emplace_back();
            for (int c = 0; c < 3; ++c) {
                map.diffuse[c] = double(truth.diffuse.at(texel.column, texel.row, c));
            }
            map.specular = double(truth.specular.at(texel.column, texel.row));
            map.roughness =
                std::max(kMinRoughness, double(truth.roughness.at(texel.column, texel.row)));
        }
    }

    Capture capture;
    std::unique_ptr<Tracer> tracer;
    Surface surface;
    std::vector<Reflectance> maps;
};

// The same under one lamp, as photons are traced for it.
struct LitObject : ScannedObject {
    explicit LitObject(ObjectKind kind) : ScannedObject(kind) {
        constexpr std::size_t kLamp = 37;  // of the 60 candidates
        const Light& lamp = capture.description.lights[kLamp];
        direct = direct_light(surface, capture.atlas, lamp);
        lamps.lights = {&lamp};
        lamps.direct = {&direct};
        lamps.turns_with_scanner = lamp.frame == FrameOfReference::scanner;
    }

    LargeVector<DirectLight> direct;
    LampSet lamps;
};

}  // namespace patina
