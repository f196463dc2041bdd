#include "patina/reflectance/lobe.h"

#include "patina/math/warp.h"
#include "patina/reflectance/albedo_table.h"

namespace patina {
namespace {

// Share of the samples that go to the lobe: its energy before the horizon cuts it, against Pd.
// Taking the uncut energy bounds the weights (lobe.h) and needs no table.
double lobe_share(const Reflectance& reflectance, double cos_i) {
    const double diffuse = reflectance.diffuse.maxCoeff();
    const double lobe =
        2 * square(reflectance.roughness) * reflectance.specular / std::max(cos_i, kCosineFloor);
    return lobe > 0 ? lobe / (diffuse + lobe) : 0;
}

double mixture_pdf(
    double share, const Vec3& mirror, double roughness, const Vec3& w_o, double cos_o) {
    double pdf = (1 - share) * cos_o / kPi;
    if (share > 0) {
        pdf += share * von_mises_fisher_pdf(mirror.dot(w_o), 1 / square(roughness));
    }
    return pdf;
}

Vec3 mirror_direction(const Vec3& n, const Vec3& w, double cosine) { return 2 * cosine * n - w; }

}  // namespace

LobeDerivative lobe_derivative(double theta_r_squared,
                               double cos_i,
                               double cos_v,
                               double roughness) {
    const double value =
        lobe_gaussian(theta_r_squared, roughness) * lobe_cosines(cos_i, cos_v) / kPi;
    return {value, value * theta_r_squared / (roughness * roughness * roughness)};
}

double lobe_albedo(double cos_i, double roughness) {
    if (!(cos_i > 0)) return 0;
    return 2 * square(roughness) / std::max(cos_i, kCosineFloor) *
           albedo_table().relative(cos_i, roughness);
}

double max_lobe_albedo(double roughness) {
    return 2 * square(roughness) / kCosineFloor * albedo_table().relative_maximum(roughness);
}

Projection project_to_feasible(const Reflectance& reflectance) {
    // Scaled a little further than asked, so that projecting twice changes nothing.
    constexpr double kRoundingRoom = 1e-12;
    Projection result{reflectance, false};
    Reflectance& projected = result.reflectance;
    projected.diffuse = projected.diffuse.max(0.0);
    projected.specular = std::max(projected.specular, 0.0);
    projected.roughness = std::clamp(projected.roughness, kMinRoughness, kMaxRoughness);
    const double albedo =
        projected.diffuse.maxCoeff() + projected.specular * max_lobe_albedo(projected.roughness);
    if (albedo > kMaxAlbedo) {
        const double scale = kMaxAlbedo / albedo * (1 - kRoundingRoom);
        projected.diffuse *= scale;
        projected.specular *= scale;
    }
    result.was_clamped = (projected.diffuse != reflectance.diffuse).any() ||
                         projected.specular != reflectance.specular ||
                         projected.roughness != reflectance.roughness;
    return result;
}

LobeSample sample_lobe(const Reflectance& reflectance,
                       const Vec3& n,
                       const Vec3& w_i,
                       double choice,
                       const std::array<double, 2>& u) {
    LobeSample sample;
    const double cos_i = n.dot(w_i);
    if (!(cos_i > 0)) return sample;
    const Vec3 mirror = mirror_direction(n, w_i, cos_i);
    const double share = lobe_share(reflectance, cos_i);
    sample.w_o = choice < share ? Frame(mirror).to_world(square_to_von_mises_fisher(
                                      u, 1 / square(reflectance.roughness)))
                                : Frame(n).to_world(square_to_cosine_hemisphere(u));
    const double cos_o = n.dot(sample.w_o);
    if (!(cos_o > 0)) return sample;
    sample.pdf = mixture_pdf(share, mirror, reflectance.roughness, sample.w_o, cos_o);
    sample.weight = evaluate(reflectance, n, w_i, sample.w_o) * (cos_o / sample.pdf);
    return sample;
}

double sample_lobe_pdf(const Reflectance& reflectance,
                       const Vec3& n,
                       const Vec3& w_i,
                       const Vec3& w_o) {
    const double cos_i = n.dot(w_i);
    const double cos_o = n.dot(w_o);
    if (!(cos_i > 0) || !(cos_o > 0)) return 0;
    return mixture_pdf(lobe_share(reflectance, cos_i),
                       mirror_direction(n, w_i, cos_i),
                       reflectance.roughness,
                       w_o,
                       cos_o);
}

}  // namespace patina
