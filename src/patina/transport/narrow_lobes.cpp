#include "patina/transport/narrow_lobes.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/transport/lobe_reach.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

// Photons carry all of the image up to the first sigma and nothing from the second on: about where
// the errors of both ways are the same (docs/theory.md, "Narrow lobes") [rad].
constexpr double kAllByPhotons = 0.10;
constexpr double kNoneByPhotons = 0.14;
// Photons start on lobes up to this width, and as if they carried this share at least, so that
// lobes may grow narrower in later turns.
constexpr double kWidestGuide = 0.16;  // [rad]
constexpr double kMinGuideShare = 0.1;
// Directions are drawn from lobes wider by this factor: of standing lamps seven photons of eight
// still count, and the weights' variance stays finite until a lobe has become so many times as wide
// as the second says. Lobes that have become still wider are left to the sweeps.
constexpr double kGuideWidth = 1.25;
constexpr double kMostWidened = 1.75;
// Narrow lobes that send on less than this of all reflected light are left to the sweeps: if sigma
// is as below, these then err by 2 % of the light in the mean square, no more than photons do. Of
// lobes k times as wide they err by 1/k of that, and photons gain the less the nearer they are to
// where both ways err alike, so that more is left to them.
constexpr double kWorthwhile = 1e-3;
constexpr double kWorthwhileSigma = 0.03;  // [rad]
// Photons are traced anew when their effective number has fallen below this share of what it was,
// or their number is below this share of what the images that they carry call for now.
constexpr double kMinEffectiveShare = 0.5;

// What texels reflect, weighted by their area [length^2].
struct Reflected {
    double narrow = 0;  // images that photons are to carry
    double gained = 0;  // of them, by how much more of them sweeps err than photons
    double guided = 0;  // of them, those on which photons start
    double all = 0;
    double shares = 0;  // guide_share(), not weighted by anything [texels]
    Reflected& operator+=(const Reflected& other) {
        narrow += other.narrow;
        gained += other.gained;
        guided += other.guided;
        all += other.all;
        shares += other.shares;
        return *this;
    }
};

// Chords between unit vectors in single precision err by less [-].
constexpr float kChordRounding = 1e-5f;

// For one lamp.
std::uint64_t num_photons(double num_texels, bool turning, const NarrowLobeOptions& options) {
    const double per_texel =
        turning ? options.photons_per_turning_texel : options.photons_per_texel;
    return std::clamp<std::uint64_t>(std::uint64_t(per_texel * num_texels), 2, options.max_photons);
}

// Over that at kWorthwhileSigma; docs/theory.md, "Whether it pays" [-].
double gain_of_photons(double roughness) {
    return std::max(0.0, 1 - square(roughness / kNoneByPhotons)) * kWorthwhileSigma / roughness;
}

// Of the images in a texel's lobe, those for which photons start; 0 where none do [-].
double guide_share(const Reflectance& map) {
    if (!(map.specular > 0) || map.roughness >= kWidestGuide) return 0;
    return std::max(kMinGuideShare, photon_share(map.roughness));
}

}  // namespace

double photon_share(double roughness) {
    const double t =
        std::clamp((roughness - kAllByPhotons) / (kNoneByPhotons - kAllByPhotons), 0.0, 1.0);
    return 1 - square(t) * (3 - 2 * t);
}

NarrowLobes::NarrowLobes(const Surface& surface,
                         const TexelAtlas& atlas,
                         std::vector<LampBlock> blocks,
                         const NarrowLobeOptions& options)
    : surface_(surface), atlas_(atlas), blocks_(std::move(blocks)), options_(options) {}

void NarrowLobes::forget() {
    photons_.clear();
    shares_.clear();
}

bool NarrowLobes::follow(std::span<const Reflectance> maps) {
    const std::size_t num_texels = atlas_.texels.size();
    PATINA_CHECK_EQ(maps.size(), num_texels);
    if (blocks_.empty()) return false;
    const auto reflected = ordered_reduce(num_texels, Reflected(), [&](std::size_t i) {
        const Reflectance& map = maps[i];
        const double area = atlas_.texels[i].area;
        const double lobe = map.specular * max_lobe_albedo(map.roughness);
        Reflected sum;
        sum.narrow = area * photon_share(map.roughness) * lobe;
        sum.gained = sum.narrow * gain_of_photons(map.roughness);
        sum.guided = !photons_.empty() && is_guided(i, map) ? sum.narrow : 0;
        sum.shares = guide_share(map);
        sum.all = area * (map.diffuse.mean() + lobe);
        return sum;
    });
    const bool worthwhile = reflected.gained > kWorthwhile * reflected.all;
    if (!photons_.empty()) {
        const double effective = weigh(maps);
        // Lobes that have become narrow since photons were traced count as photons that are
        // missing.
        const bool enough = effective * reflected.guided >=
                                kMinEffectiveShare * effective_when_traced_ * reflected.narrow &&
                            shares_when_traced_ >= kMinEffectiveShare * reflected.shares;
        if (!worthwhile || enough) return false;
    }
    if (!worthwhile) return false;
    shares_when_traced_ = reflected.shares;
    trace(maps);
    effective_when_traced_ = weigh(maps);
    return true;
}

bool NarrowLobes::is_guided(std::size_t texel, const Reflectance& map) const {
    return map.roughness <= kMostWidened * double(guide_roughness_[texel]);
}

void NarrowLobes::trace(std::span<const Reflectance> maps) {
    const std::size_t num_texels = maps.size();
    std::vector<Reflectance> guide(num_texels);
    guide_roughness_.assign(num_texels, 0);
    for (std::size_t i = 0; i < num_texels; ++i) {
        const double share = guide_share(maps[i]);
        if (share == 0) continue;
        guide[i].specular = share * maps[i].specular;
        guide[i].roughness = kGuideWidth * maps[i].roughness;
        guide_roughness_[i] = float(maps[i].roughness);
    }
    PhotonOptions options;
    options.seed = options_.seed;
    options.max_bounces = 1;
    options.min_guide_albedo = 0;
    const PhotonScene scene(surface_, atlas_, guide);
    photons_.assign(blocks_.size(), {});
    std::vector<double> arrivals(num_texels, 0.0);
    std::uint32_t num_lamps = 0;
    Progress quiet;
    for (std::size_t block = 0; block < blocks_.size(); ++block) {
        const LampBlock& lamps = blocks_[block];
        for (std::size_t lane = 0; lane < lamps.size(); ++lane) {
            options.exact_columns = lamps.lights[lane]->frame == FrameOfReference::scanner;
            options.photons = num_photons(shares_when_traced_, options.exact_columns, options_);
            LampSet set;
            set.turns_with_scanner = options.exact_columns;
            set.lights = {lamps.lights[lane]};
            set.direct = {lamps.direct[lane]};
            PhotonPaths& paths = photons_[block].emplace_back().paths;
            paths = trace_photons(scene, set, options, num_lamps++, quiet);
            for (std::size_t i = 0; i < num_texels; ++i) {
                arrivals[i] += double(paths.arrivals_begin[i + 1] - paths.arrivals_begin[i]);
            }
        }
    }
    for (double& count : arrivals) count /= num_lamps;
    RatioKernelOptions kernel;
    kernel.max_radius = options_.kernel_radius;
    kernel.min_radius = std::min(kernel.min_radius, kernel.max_radius);
    kernel_ = build_ratio_kernel(atlas_, arrivals, kernel);
    for (std::vector<LampPhotons>& block : photons_) {
        for (LampPhotons& lamp : block) {
            lamp.cones.resize(num_texels);
            parallel_for(num_texels,
                         [&](std::size_t i) { lamp.cones[i] = cone_at(i, lamp.paths); });
        }
    }
}

NarrowLobes::ArrivalCone NarrowLobes::cone_at(std::size_t texel, const PhotonPaths& paths) const {
    const auto over_arrivals = [&](const auto& visit) {
        for (std::size_t k = kernel_.begin[texel]; k < kernel_.begin[texel + 1]; ++k) {
            const TexelId from = kernel_.texel[k];
            for (auto a = paths.arrivals_begin[from]; a < paths.arrivals_begin[from + 1]; ++a) {
                visit(paths.arrival_direction[a]);
            }
        }
    };
    Vec3f sum = Vec3f::Zero();
    over_arrivals([&](const Vec3f& w) { sum += w; });
    ArrivalCone cone;
    // Directions that cancel have no axis; any will do.
    if (sum.squaredNorm() > 0) cone.axis = sum.normalized();
    over_arrivals(
        [&](const Vec3f& w) { cone.chord = std::max(cone.chord, (w - cone.axis).norm()); });
    return cone;
}

double NarrowLobes::weigh(std::span<const Reflectance> maps) {
    shares_.resize(maps.size());
    std::vector<Reflectance> carried(maps.size());
    parallel_for(maps.size(), [&](std::size_t i) {
        const double share = is_guided(i, maps[i]) ? photon_share(maps[i].roughness) : 0.0;
        shares_[i] = float(share);
        carried[i].specular = share * maps[i].specular;
        carried[i].roughness = maps[i].roughness;
    });
    double effective = 0;
    for (std::vector<LampPhotons>& block : photons_) {
        for (LampPhotons& lamp : block) {
            lamp.power = photon_power(lamp.paths, carried).arrivals;
            effective += effective_number(lamp.power);
        }
    }
    return effective;
}

NarrowLobes::Irradiance NarrowLobes::irradiance(std::size_t block) const {
    const std::vector<LampPhotons>& lamps = photons_[block];
    const std::size_t num_texels = atlas_.texels.size();
    Irradiance power(num_texels);
    parallel_for(num_texels, [&](std::size_t i) {
        power[i] = {};
        for (std::size_t lane = 0; lane < lamps.size(); ++lane) {
            const PhotonPaths& paths = lamps[lane].paths;
            const auto color = float(lamp_color(*blocks_[block].lights[lane]).maxCoeff());
            for (std::uint32_t k = paths.arrivals_begin[i]; k < paths.arrivals_begin[i + 1]; ++k) {
                power[i][paths.arrival_half[k]][lane] += lamps[lane].power[k].maxCoeff() / color;
            }
        }
    });
    Irradiance result(num_texels);
    parallel_for(num_texels, [&](std::size_t i) {
        std::array<Lanes, 2> sum{};
        for (std::size_t k = kernel_.begin[i]; k < kernel_.begin[i + 1]; ++k) {
            const std::array<Lanes, 2>& from = power[kernel_.texel[k]];
            // Half of the photons carries half of the power.
            const float weight = 2 * kernel_.weight[k];
            sum[0] += weight * from[0];
            sum[1] += weight * from[1];
        }
        result[i] = sum;
    });
    return result;
}

void NarrowLobes::add_lobe(std::size_t block,
                           std::size_t lane,
                           std::span<const Vec3f> w_v,
                           std::span<const Reflectance> maps,
                           std::span<const std::uint8_t> wanted,
                           LobeColumn sum) const {
    const LampPhotons& lamp = photons_[block][lane];
    // Most narrow lobes look past all that arrives: the triangle inequality tells.
    std::vector<std::uint8_t> meets(wanted.size());
    parallel_for(meets.size(), [&](std::size_t i) {
        const ArrivalCone& cone = lamp.cones[i];
        if (wanted[i] == 0 || cone.chord < 0) return;
        const Vec3f normal = atlas_.texels[i].point.normal.cast<float>();
        const Vec3f mirror = 2 * normal.dot(w_v[i]) * normal - w_v[i];
        const float reach =
            lobe_reach_chord(float(maps[i].roughness)) + cone.chord + kChordRounding;
        meets[i] = (mirror - cone.axis).squaredNorm() <= square(reach);
    });
    add_indirect_lobe(kernel_, lamp.paths, lamp.power, atlas_, w_v, maps, meets, sum);
}

double NarrowLobes::expect_bytes(std::size_t num_texels,
                                 double hit_share,
                                 bool turning,
                                 const NarrowLobeOptions& options) {
    constexpr double kArrival = sizeof(PhotonPaths::Path) + sizeof(PhotonBounce) +
                                sizeof(std::uint32_t) + sizeof(std::uint8_t) + sizeof(Vec3f) +
                                sizeof(Rgbf);
    const double photons = double(num_photons(double(num_texels), turning, options));
    return hit_share * photons * kArrival +
           double(num_texels) * (sizeof(ArrivalCone) + sizeof(std::uint32_t));
}

}  // namespace patina
