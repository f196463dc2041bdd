// Whether methods gather and photon agree: their maps with each other, and the light that each
// finds under the maps of gather with the path tracer's.
//
//     agreement CAPTURE GATHER PHOTON [PHOTONS [STRIDE]]
//
// GATHER and PHOTON: results of the capture. PHOTONS for each lamp set, 2000000 unless given;
// STRIDE: the light of every so manyth texel is traced, 16 unless given. Prints for Pd, Ps and
// sigma the share of texels of status 1 in both results whose maps differ by more than 1.96
// standard errors of the difference (5 % of independent errors would) and the mean of that ratio;
// then light over the path tracer's, with one standard error of either.
#include "support/agreement.h"

#include "patina/base/error.h"
#include "patina/capture/capture.h"
#include "patina/capture/result_folder.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <string>
#include <vector>

namespace patina {
namespace {

// Neighbours share rays or photons, say so many to a patch, as tests/recovery/agreement_test.cpp
// has it.
constexpr double kPatch = 10;

Reflectance at(const Image& diffuse,
               const Image& specular,
               const Image& roughness,
               const Texel& texel) {
    const int x = texel.column;
    const int y = texel.row;
    Reflectance map;
    for (int c = 0; c < 3; ++c) map.diffuse[c] = double(diffuse.at(x, y, c));
    map.specular = double(specular.at(x, y));
    map.roughness = double(roughness.at(x, y));
    return map;
}

Reflectance value_at(const ReflectanceMaps& maps, const Texel& texel) {
    return at(maps.diffuse, maps.specular, maps.roughness, texel);
}

Reflectance error_at(const ReflectanceMaps& maps, const Texel& texel) {
    return at(maps.diffuse_stderr, maps.specular_stderr, maps.roughness_stderr, texel);
}

void print(const std::string& name, const Scores& scores) {
    fmt::print("{:8} beyond 1.96: {:.1f} % of {:.0f}, mean {:.2f}\n",
               name,
               100 * scores.beyond / scores.count,
               scores.count,
               scores.sum / scores.count);
}

void compare_maps(const Capture& capture, const ReflectanceMaps& a, const ReflectanceMaps& b) {
    Scores diffuse;
    Scores specular;
    Scores roughness;
    for (const Texel& texel : capture.atlas.texels) {
        const auto is_measured = [&](const ReflectanceMaps& maps) {
            return TexelStatus(int(maps.status.at(texel.column, texel.row))) ==
                   TexelStatus::measured;
        };
        if (!is_measured(a) || !is_measured(b)) continue;
        const Reflectance value_a = value_at(a, texel);
        const Reflectance value_b = value_at(b, texel);
        const Reflectance error_a = error_at(a, texel);
        const Reflectance error_b = error_at(b, texel);
        for (int c = 0; c < 3; ++c) {
            diffuse.add(
                value_a.diffuse[c], value_b.diffuse[c], error_a.diffuse[c], error_b.diffuse[c]);
        }
        specular.add(value_a.specular, value_b.specular, error_a.specular, error_b.specular);
        roughness.add(value_a.roughness, value_b.roughness, error_a.roughness, error_b.roughness);
    }
    print("Pd", diffuse);
    print("Ps", specular);
    print("sigma", roughness);
}

void print(const std::string& name, const LightSum& found, const LightSum& traced) {
    const double ratio = found.value / traced.value;
    const double of_found = std::sqrt(kPatch * found.variance) / traced.value;
    const double of_traced = ratio * std::sqrt(traced.variance) / traced.value;
    fmt::print(
        "{:8} over the path tracer's light: {:.4f} +- {:.4f} (its own) +- {:.4f} (the path "
        "tracer's)\n",
        name,
        ratio,
        of_found,
        of_traced);
}

void run(std::span<char*> words) {
    const Capture capture = load_capture(words[1]);
    const ReflectanceMaps gather = read_result(words[2]).maps;
    const ReflectanceMaps photon = read_result(words[3]).maps;
    compare_maps(capture, gather, photon);

    std::vector<Reflectance> maps;
    for (const Texel& texel : capture.atlas.texels) maps.push_back(value_at(gather, texel));
    PathTracerCheck check(capture, maps, words.size() > 5 ? std::stoull(words[5]) : 16);
    const LightSum traced = check.traced();
    EstimateOptions options;
    print("gather", check.found(options), traced);
    options.method = Method::photon;
    options.photons.photons = words.size() > 4 ? std::stoull(words[4]) : 2'000'000;
    print("photon", check.found(options), traced);
}

}  // namespace
}  // namespace patina

int main(int argc, char** argv) {
    try {
        if (argc < 4) {
            std::fputs("usage: agreement CAPTURE GATHER PHOTON [PHOTONS [STRIDE]]\n", stderr);
            return 2;
        }
        patina::run({argv, std::size_t(argc)});
    } catch (const std::exception& error) {
        fmt::print(stderr, "agreement: {}\n", error.what());
        return 2;
    }
}
