// Cost of the photon engine, its steps one after the other, beside the bare ray queries of the same
// photons.
//
//     photon_benchmark [OBJECT [PHOTONS [REPEATS]]]        A, 2000000 and 7 unless given
//
// The program puts its own rtcIntersect8 in front of Embree's. While the photons are traced once by
// one thread it writes down the scene and every ray that a packet sends; then the recorded rays are
// sent to Embree again in the same order, one by one (rtcIntersect1), and the two are timed in
// turns, so that whatever else the machine does falls on both. Times are the least of all repeats.
// Shadow rays to lamps that turn are part of the photons' time and not of the bare rays'.
#include "patina/base/parallel.h"
#include "patina/base/process_memory.h"
#include "patina/transport/photon_paths.h"
#include "patina/transport/ratio_kernel.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include "scanned_object.h"
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <dlfcn.h>
#include <exception>
#include <limits>
#include <string>
#include <vector>

namespace {

using Intersect8 = void (*)(const int*, RTCScene, RTCIntersectContext*, RTCRayHit8*);
constexpr std::size_t kPacketSize = 8;

struct RecordedRay {
    std::array<float, 3> origin{};
    std::array<float, 3> direction{};
};
struct Recording {
    bool active = false;  // set only while one thread traces
    RTCScene scene = nullptr;
    std::vector<RecordedRay> rays;
};

Recording& recording() {
    static Recording instance;
    return instance;
}

const Intersect8 kEmbreeIntersect8 =
    reinterpret_cast<Intersect8>(dlsym(RTLD_NEXT, "rtcIntersect8"));

}  // namespace

extern "C" void rtcIntersect8(const int* valid,
                              RTCScene scene,
                              RTCIntersectContext* context,
                              RTCRayHit8* ray_hit) {
    if (recording().active) {
        const RTCRay8& ray = ray_hit->ray;
        recording().scene = scene;
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            if (valid[i] == 0) continue;
            recording().rays.push_back({{ray.org_x[i], ray.org_y[i], ray.org_z[i]},
                                        {ray.dir_x[i], ray.dir_y[i], ray.dir_z[i]}});
        }
    }
    kEmbreeIntersect8(valid, scene, context, ray_hit);
}

namespace patina {
namespace {

constexpr std::size_t kRaysPerBlock = 8192;
constexpr std::uint32_t kStream = 0;

double seconds_of(const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

PhotonPaths trace(const LitObject& scene, const PhotonScene& photon_scene, std::uint64_t photons) {
    PhotonOptions options;
    options.photons = photons;
    Progress progress;
    return trace_photons(photon_scene, scene.lamps, options, kStream, progress);
}

// Sends the recorded rays to Embree. Returns how many hit something.
std::size_t replay() {
    std::atomic<std::size_t> hits = 0;
    const std::vector<RecordedRay>& rays = recording().rays;
    parallel_blocks(rays.size(), kRaysPerBlock, [&](std::size_t begin, std::size_t end) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        std::size_t count = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const auto& [origin, direction] = rays[i];
            RTCRayHit ray_hit;
            ray_hit.ray = {origin[0],
                           origin[1],
                           origin[2],
                           0,
                           direction[0],
                           direction[1],
                           direction[2],
                           0,
                           std::numeric_limits<float>::infinity(),
                           ~0u,
                           0,
                           0};
            ray_hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            ray_hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(recording().scene, &context, &ray_hit);
            count += ray_hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        }
        hits += count;
    });
    return hits;
}

// Least times of all repeats [s].
struct Times {
    double clock = 1e300;
    double processor = 1e300;

    void measure(const auto& work) {
        const std::clock_t start = std::clock();
        clock = std::min(clock, seconds_of(work));
        processor = std::min(processor, double(std::clock() - start) / CLOCKS_PER_SEC);
    }
};

struct RayTimes {
    Times bare;
    Times records;  // PhotonScene, which is made once for all sets of lamps
    Times photons;  // the same rays within trace_photons()
};

// One and two threads in turns, so that whatever else the machine does falls on both; of each turn
// all is done twice, the second time with caches as such work leaves them.
std::array<RayTimes, 2> time_rays(const LitObject& scene, std::uint64_t photons, int repeats) {
    const PhotonScene photon_scene(scene.surface, scene.capture.atlas, scene.maps);
    std::array<RayTimes, 2> times;
    for (int turn = 0; turn < 2 * repeats; ++turn) {
        RayTimes& at = times[std::size_t(turn % 2)];
        const ThreadLimit limit(turn % 2 + 1);
        for (int time = 0; time < 2; ++time) {
            at.bare.measure([] { static_cast<void>(replay()); });
        }
        for (int time = 0; time < 2; ++time) {
            at.records.measure([&] {
                static_cast<void>(PhotonScene(scene.surface, scene.capture.atlas, scene.maps));
            });
        }
        for (int time = 0; time < 2; ++time) {
            at.photons.measure([&] { static_cast<void>(trace(scene, photon_scene, photons)); });
        }
    }
    return times;
}

void compare_with_bare_rays(const LitObject& scene, std::uint64_t photons, int repeats) {
    {
        const ThreadLimit limit(1);
        recording().active = true;
        const PhotonScene photon_scene(scene.surface, scene.capture.atlas, scene.maps);
        const PhotonPaths paths = trace(scene, photon_scene, photons);
        recording().active = false;
        fmt::print("{} photons, {} rays, {} hits, {} arrivals\n",
                   photons,
                   recording().rays.size(),
                   replay(),
                   paths.bounces.size());
    }
    const double to_ns = 1e9 / double(recording().rays.size());
    const std::array<RayTimes, 2> times = time_rays(scene, photons, repeats);
    for (int threads = 1; threads <= 2; ++threads) {
        const RayTimes& at = times[std::size_t(threads - 1)];
        const auto print = [&](const char* what, double Times::*time) {
            const double bare = at.bare.*time;
            fmt::print(
                "{} threads, {} time: bare rays {:.1f} ns, photons {:.1f} ns per ray, "
                "ratio {:.2f}; records of the scene {:.1f} ms, with them {:.2f}\n",
                threads,
                what,
                bare * to_ns,
                at.photons.*time * to_ns,
                at.photons.*time / bare,
                at.records.*time * 1e3,
                (at.photons.*time + at.records.*time) / bare);
        };
        print("processor", &Times::processor);
        print("clock", &Times::clock);
    }
    const double bare_gain = times[0].bare.clock / times[1].bare.clock;
    const double photon_gain = times[0].photons.clock / times[1].photons.clock;
    fmt::print("2 threads over 1: bare rays {:.2f}, photons {:.2f}, {:.2f} of it\n",
               bare_gain,
               photon_gain,
               photon_gain / bare_gain);
}

void print_least(const char* name, int repeats, std::size_t elements, const auto& work) {
    Times times;
    for (int repeat = 0; repeat < repeats; ++repeat) times.measure(work);
    fmt::print(
        "{:20} {:8.2f} ms of the processor, {:8.2f} ms of the clock, {:8.1f} ns per element\n",
        name,
        1e3 * times.processor,
        1e3 * times.clock,
        1e9 * times.processor / double(elements));
}

// Everything that one turn of the paper's method does with stored photons of one lamp.
void time_steps(const LitObject& scene, std::uint64_t photons, int repeats) {
    const TexelAtlas& atlas = scene.capture.atlas;
    const PhotonScene photon_scene(scene.surface, scene.capture.atlas, scene.maps);
    const PhotonPaths paths = trace(scene, photon_scene, photons);
    std::vector<double> arrivals(atlas.texels.size());
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        arrivals[i] = double(paths.arrivals_begin[i + 1] - paths.arrivals_begin[i]);
    }
    const RatioKernel kernel = build_ratio_kernel(atlas, arrivals, {});
    const PhotonPower power = photon_power(paths, scene.maps);
    std::vector<Vec3f> w_v;
    for (const Texel& texel : atlas.texels) {
        w_v.push_back((texel.point.normal + 0.3 * Vec3::UnitY()).normalized().cast<float>());
    }
    const std::vector<std::uint8_t> wanted(atlas.texels.size(), 1);
    fmt::print("{} texels, {} kernel entries, {} threads\n",
               atlas.texels.size(),
               kernel.texel.size(),
               thread_count());
    print_least("build_ratio_kernel", repeats, kernel.texel.size(), [&] {
        static_cast<void>(build_ratio_kernel(atlas, arrivals, {}));
    });
    print_least("photon_power", repeats, paths.bounces.size(), [&] {
        static_cast<void>(photon_power(paths, scene.maps));
    });
    print_least("indirect_irradiance", repeats, kernel.texel.size(), [&] {
        static_cast<void>(indirect_irradiance(kernel, paths, power.arrivals));
    });
    std::vector<IndirectLobe> lobes(atlas.texels.size());
    print_least("add_indirect_lobe", repeats, atlas.texels.size(), [&] {
        add_indirect_lobe(
            kernel, paths, power.arrivals, atlas, w_v, scene.maps, wanted, {lobes.data()});
    });
}

void run(const std::vector<std::string>& words) {
    const auto word = [&](std::size_t i, const char* otherwise) {
        return words.size() > i ? words[i] : std::string(otherwise);
    };
    const LitObject scene(object_kind_from_name(word(0, "A")));
    const std::uint64_t photons = std::stoull(word(1, "2000000"));
    const int repeats = std::stoi(word(2, "7"));
    compare_with_bare_rays(scene, photons, repeats);
    time_steps(scene, photons, repeats);
}

}  // namespace
}  // namespace patina

int main(int argc, char** argv) {
    try {
        patina::keep_freed_memory();
        patina::run({argv + 1, argv + argc});
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "photon_benchmark: {}\n", error.what());
        return 1;
    }
}
