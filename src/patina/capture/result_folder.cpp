#include "patina/capture/result_folder.h"

#include "patina/base/check.h"
#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/base/parallel.h"
#include "patina/capture/json_fields.h"
#include "patina/math/types.h"
#include "patina/scene/mesh_io.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

namespace patina {
namespace {

namespace fs = std::filesystem;

constexpr const char* kJsonName = "result.json";
constexpr const char* kMeshName = "geometry.ply";

struct MapFile {
    const char* name;
    Image ReflectanceMaps::*map;
    int channels;         // in memory
    int stored_channels;  // in the file
    bool is_optional = false;
};

constexpr std::array<MapFile, 9> kMapFiles = {{
    {"diffuse.exr", &ReflectanceMaps::diffuse, 3, 3},
    {"specular.exr", &ReflectanceMaps::specular, 1, 3},
    {"roughness.exr", &ReflectanceMaps::roughness, 1, 1},
    {"diffuse_stderr.exr", &ReflectanceMaps::diffuse_stderr, 3, 3},
    {"specular_stderr.exr", &ReflectanceMaps::specular_stderr, 1, 3},
    {"roughness_stderr.exr", &ReflectanceMaps::roughness_stderr, 1, 1},
    {"status.exr", &ReflectanceMaps::status, 1, 1},
    {"measurability.exr", &ReflectanceMaps::measurability, 3, 3, true},
    {"reason.exr", &ReflectanceMaps::reason, 1, 1, true},
}};

Image repeat_channels(const Image& image, int channels) {
    if (image.channels == channels) return image;
    Image repeated(image.width, image.height, channels);
    for (std::size_t i = 0; i < repeated.data.size(); ++i) {
        repeated.data[i] = image.data[i / std::size_t(channels)];
    }
    return repeated;
}

// Whether the value is one of 0, 1, ... last.
bool is_code(float value, double last) {
    return value >= 0 && double(value) <= last && value == std::floor(value);
}

// Where a map's value breaks the rules of the result folder, and how.
struct Fault {
    int x = 0;
    int y = 0;
    const char* problem = "";
    const char* expected = "";
};

std::optional<Fault> find_fault(const MapFile& file, const Image& map, const Image& status) {
    const bool is_status_map = file.map == &ReflectanceMaps::status;
    const bool is_reason_map = file.map == &ReflectanceMaps::reason;
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            for (int c = 0; c < map.channels; ++c) {
                const float value = map.at(x, y, c);
                if (std::isnan(value)) return Fault{x, y, "is NaN", "a number"};
                if (is_status_map && !is_code(value, double(TexelStatus::filled))) {
                    return Fault{x, y, "is no status", "0, 1, 2 or 3"};
                }
                if (is_reason_map && !is_code(value, double(LobeReason::not_observed))) {
                    return Fault{x, y, "is no reason", "a whole number from 0 to 8"};
                }
                if (status.at(x, y) == 0 && value != 0) {
                    return Fault{x, y, "is not 0 where the status is 0", "0 off the surface"};
                }
            }
        }
    }
    return std::nullopt;
}

// A map of the file's channels as one of memory's; equal channels become one.
Image read_map(const fs::path& path, const MapFile& file) {
    const Image stored = read_image(path).image;
    if (stored.channels != file.stored_channels) {
        throw Error(path.string(),
                    "",
                    fmt::format("has {} channels", stored.channels),
                    fmt::format("{} channels", file.stored_channels));
    }
    if (stored.channels == file.channels) return stored;
    Image map(stored.width, stored.height, 1);
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            map.at(x, y) = stored.at(x, y);
            // NaN is reported by itself, later.
            const bool differs = stored.at(x, y, 0) < stored.at(x, y, 1) ||
                                 stored.at(x, y, 0) > stored.at(x, y, 1) ||
                                 stored.at(x, y, 0) < stored.at(x, y, 2) ||
                                 stored.at(x, y, 0) > stored.at(x, y, 2);
            if (!differs) continue;
            throw Error(path.string(),
                        "",
                        fmt::format("pixel ({}, {}) has a colour", x, y),
                        "three equal channels");
        }
    }
    return map;
}

void check_maps(const fs::path& folder, const ReflectanceMaps& maps) {
    const Image& status = maps.status;
    for (const MapFile& file : kMapFiles) {
        const Image& map = maps.*file.map;
        if (file.is_optional && map.empty()) continue;
        const std::string place = (folder / file.name).string();
        if (map.width != status.width || map.height != status.height) {
            throw Error(
                place,
                "",
                fmt::format("has {} x {} pixels", map.width, map.height),
                fmt::format("{} x {}, the size of status.exr", status.width, status.height));
        }
        if (const std::optional<Fault> fault = find_fault(file, map, status)) {
            throw Error(place,
                        "",
                        fmt::format("pixel ({}, {}) {}", fault->x, fault->y, fault->problem),
                        fault->expected);
        }
    }
}

// Does nothing for an optional map that is empty.
void write_map(const fs::path& folder, const MapFile& file, const ReflectanceMaps& maps) {
    const Image& map = maps.*file.map;
    if (file.is_optional && map.empty()) return;
    PATINA_CHECK_EQ(map.width, maps.status.width);
    PATINA_CHECK_EQ(map.height, maps.status.height);
    PATINA_CHECK_EQ(map.channels, file.channels);
    const std::optional<Fault> fault = find_fault(file, map, maps.status);
    PATINA_CHECK_EQ(std::string(fault ? fault->problem : ""), "");
    write_exr(folder / file.name, repeat_channels(map, file.stored_channels));
}

}  // namespace

void write_result_maps(const fs::path& folder, const ReflectanceMaps& maps) {
    const auto write = [&](std::size_t i) { write_map(folder, kMapFiles[i], maps); };
    parallel_for(kMapFiles.size(), write, 1);
}

void write_result(const fs::path& folder, const Result& result) {
    const auto write = [&](std::size_t i) {
        if (i == 0) {
            write_ply(folder / kMeshName, result.mesh);
        } else {
            write_map(folder, kMapFiles[i - 1], result.maps);
        }
    };
    parallel_for(1 + kMapFiles.size(), write, 1);
    write_file(folder / kJsonName, result.json);
}

Result read_result(const fs::path& path) {
    if (!fs::exists(path)) {
        throw Error(path.string(), "", "does not exist", "a folder with a result.json");
    }
    const fs::path json_path = fs::is_directory(path) ? path / kJsonName : path;
    const fs::path folder = json_path.parent_path();
    Result result;
    result.json = read_file(json_path);
    const Json document = parse_json(result.json, json_path.string());
    const JsonField root(&document, json_path.string(), "");
    static_cast<void>(root["format"].word<bool>({{"patina-result", true}}));
    static_cast<void>(root["version"].integer(1, 1));
    result.name = root["name"].text();
    if (root["scale"].present()) {
        result.lamp_factor = root["scale"]["factor"].number_above_zero();
    }
    if (root["noise_scale"].present()) {
        result.noise.scale = root["noise_scale"].number_not_below_zero();
        result.noise.own = square(result.noise.scale);
    }
    if (root["noise_own"].present() && root["noise_shared"].present()) {
        result.noise.own = root["noise_own"].number_not_below_zero();
        result.noise.shared = root["noise_shared"].number_not_below_zero();
    }
    for (const MapFile& file : kMapFiles) {
        if (file.is_optional && !fs::exists(folder / file.name)) continue;
        result.maps.*file.map = read_map(folder / file.name, file);
    }
    check_maps(folder, result.maps);
    result.mesh = read_mesh(folder / kMeshName);
    if (result.mesh.uvs.empty()) {
        throw Error((folder / kMeshName).string(), "", "has no texture coordinates", "s and t");
    }
    return result;
}

}  // namespace patina
