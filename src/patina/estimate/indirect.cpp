#include "patina/estimate/indirect.h"

#include "patina/base/parallel.h"
#include "patina/transport/disc_estimator.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {
namespace {

// Photons are traced anew when their effective number has fallen below this share.
constexpr double kMinEffectiveShare = 0.5;
// Texels with less specular albedo than this do not show indirect light by their lobe.
constexpr double kNegligibleLobe = 1e-5;

std::vector<Reflectance> without_specular(std::span<const Reflectance> maps) {
    std::vector<Reflectance> result(maps.begin(), maps.end());
    for (Reflectance& map : result) map.specular = 0;
    return result;
}

// lambda as the decay of the power from bounce to bounce, once the first bounces' shape has faded.
double spectral_radius(const std::vector<PhotonPower>& power) {
    constexpr std::size_t kFirstBounce = 1;
    double before = 0;
    double after = 0;
    for (const PhotonPower& set : power) {
        for (std::size_t k = kFirstBounce; k + 1 < set.by_bounce.size(); ++k) {
            before += set.by_bounce[k];
            after += set.by_bounce[k + 1];
        }
    }
    return before > 0 ? after / before : 0;
}

}  // namespace

PhotonEngine::PhotonEngine(const Surface& surface,
                           const TexelAtlas& atlas,
                           const SceneView& scene,
                           const EstimateOptions& options,
                           Progress& progress)
    : surface_(surface), atlas_(atlas), scene_(scene), options_(options), progress_(progress) {
    for (const std::vector<TexelView>& views : scene.views) {
        std::vector<Vec3f>& directions = w_v_.emplace_back(views.size());
        for (std::size_t i = 0; i < views.size(); ++i) directions[i] = views[i].w_v;
    }
}

void PhotonEngine::trace(std::span<const Reflectance> guide) {
    progress_.begin_stage("photons", options_.photons.photons * scene_.lamp_sets.size(), "photons");
    paths_.clear();
    PhotonOptions photons = options_.photons;
    photons.keep_positions = options_.irradiance == Irradiance::disc;
    std::vector<double> arrivals(atlas_.texels.size(), 0.0);
    std::uint64_t rays = 0;
    const PhotonScene photon_scene(surface_, atlas_, guide);
    for (std::size_t set = 0; set < scene_.lamp_sets.size(); ++set) {
        paths_.push_back(trace_photons(photon_scene,
                                       scene_.lamp_sets[set],
                                       photons,
                                       static_cast<std::uint32_t>(set),
                                       progress_));
        const PhotonPaths& paths = paths_.back();
        rays += paths.rays;
        for (std::size_t i = 0; i < arrivals.size(); ++i) {
            arrivals[i] += double(paths.arrivals_begin[i + 1] - paths.arrivals_begin[i]) /
                           double(scene_.lamp_sets.size());
        }
    }
    kernel_ = build_ratio_kernel(atlas_, arrivals, options_.kernel);
    progress_.end_stage(fmt::format("{:.1f} M rays", double(rays) / 1e6));
}

double PhotonEngine::weigh(std::span<const Reflectance> maps) {
    power_.clear();
    double effective = 0;
    for (const PhotonPaths& paths : paths_) {
        power_.push_back(photon_power(paths, maps));
        effective += effective_number(power_.back().arrivals);
    }
    return effective;
}

std::vector<IndirectIrradiance> PhotonEngine::irradiance(const PhotonPaths& paths,
                                                         std::span<const Rgbf> power) const {
    if (options_.irradiance == Irradiance::ratio) return indirect_irradiance(kernel_, paths, power);
    DiscOptions disc;
    // As many as the ratio estimator's kernel holds; a disc takes two or more.
    disc.neighbors = int(std::clamp(options_.kernel.arrivals, 2.0, 1e9));
    return disc_indirect_irradiance(paths, power, atlas_, disc);
}

IndirectLight PhotonEngine::evaluate(std::span<const Reflectance> maps,
                                     std::span<const std::uint8_t> seen,
                                     bool with_specular) {
    const std::vector<Reflectance> diffuse_maps =
        with_specular ? std::vector<Reflectance>() : without_specular(maps);
    const std::span<const Reflectance> used =
        with_specular ? maps : std::span<const Reflectance>(diffuse_maps);
    IndirectLight light;
    double effective = -1;
    if (!paths_.empty() && traced_with_specular_ == with_specular) effective = weigh(used);
    if (effective < kMinEffectiveShare * effective_when_traced_ || effective < 0) {
        trace(used);
        effective_when_traced_ = weigh(used);
        traced_with_specular_ = with_specular;
        light.retraced = true;
    }
    light.spectral_radius = spectral_radius(power_);
    light.irradiance.reset(atlas_.texels.size(), paths_.size());
    for (std::size_t set = 0; set < paths_.size(); ++set) {
        const std::vector<IndirectIrradiance> of_set =
            irradiance(paths_[set], power_[set].arrivals);
        parallel_for(of_set.size(),
                     [&](std::size_t i) { light.irradiance.of(i)[set] = of_set[i]; });
    }
    if (!with_specular) return light;
    std::vector<std::uint8_t> glossy(atlas_.texels.size());
    for (std::size_t i = 0; i < glossy.size(); ++i) {
        const Reflectance& map = maps[i];
        glossy[i] = seen[i] != 0 && 2 * square(map.roughness) * map.specular > kNegligibleLobe;
    }
    light.lobe.reset(atlas_.texels.size(), scene_.shots.size());
    for (std::size_t shot = 0; shot < scene_.shots.size(); ++shot) {
        const std::size_t set = scene_.lamp_set_of_shot[shot];
        add_indirect_lobe(kernel_,
                          paths_[set],
                          power_[set].arrivals,
                          atlas_,
                          w_v_[scene_.camera_of_shot[shot]],
                          maps,
                          glossy,
                          lobe_column(light.lobe, shot));
    }
    return light;
}

}  // namespace patina
