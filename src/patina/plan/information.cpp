#include "patina/plan/information.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/math/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patina {
namespace {

// A look says as much of a grey surface in each of its channels.
constexpr double kChannels = 3;
// Keeps looks finite whose noise is zero to the last bit, as in an estimate [radiance^2].
constexpr double kSmallestVariance = 1e-16;
// One look: the radiance [radiance] and its derivatives.
struct LookModel {
    double by_diffuse = 0;
    double by_specular = 0;
    double by_roughness = 0;  // [radiance / rad]
    double radiance = 0;
};

// The look whose terms begin at `term`, which moves on behind it.
LookModel next_look(const LookTerm*& term, const LookTerm* end, const Reflectance& reflectance) {
    LookModel look;
    const double precision = 1 / square(reflectance.roughness);
    do {
        const double theta_squared = double(term->theta_r_squared);
        const double h = double(term->irradiance) / kPi;
        const double b =
            h * double(term->lobe_cosines) * std::exp(-0.5 * theta_squared * precision);
        look.by_diffuse += h;
        look.by_specular += b;
        look.by_roughness +=
            reflectance.specular * b * theta_squared * precision / reflectance.roughness;
        ++term;
    } while (term != end && term->is_joined);
    look.radiance =
        reflectance.diffuse.mean() * look.by_diffuse + reflectance.specular * look.by_specular;
    return look;
}

double relative(double error, double value) {
    return value > 0 ? error / value : std::numeric_limits<double>::infinity();
}

Reflectance typical(const SurfacePrior& prior, double roughness) {
    Reflectance reflectance;
    reflectance.diffuse = Rgb::Constant(prior.diffuse);
    reflectance.specular = prior.specular_albedo / (2 * square(roughness));
    reflectance.roughness = roughness;
    return reflectance;
}

}  // namespace

double LookNoise::variance(double radiance) const {
    return std::max(read_variance + gain * radiance + square(calibration_stddev * radiance),
                    kSmallestVariance);
}

SupposedSurface::SupposedSurface(const SurfacePrior& prior) : prior_(prior) {
    for (const double factor : {0.5, 1.0, 2.0}) {
        cases_.push_back(typical(prior, factor * prior.roughness));
    }
}

SupposedSurface::SupposedSurface(const SurfacePrior& prior, std::vector<Reflectance> maps)
    : prior_(prior), cases_(std::move(maps)), is_mapped_(true) {}

Vec3 SupposedSurface::prior_stddev(std::size_t texel, std::size_t which) const {
    const double roughness = of(texel, which).roughness;
    return {prior_.diffuse, typical(prior_, roughness).specular, roughness};
}

LookGradients look_gradients(const LookTable& looks,
                             const SupposedSurface& surface,
                             const LookNoise& noise) {
    const std::size_t num_texels = looks.begin.size() - 1;
    const std::size_t num_cases = surface.num_cases();
    LookGradients gradients;
    gradients.begin.assign(num_texels + 1, 0);
    for (std::size_t i = 0; i < num_texels; ++i) {
        const std::span<const LookTerm> row = looks.of(i);
        const auto num_looks = std::count_if(
            row.begin(), row.end(), [](const LookTerm& term) { return !term.is_joined; });
        gradients.begin[i + 1] = gradients.begin[i] + std::uint32_t(num_looks);
    }
    gradients.rows.resize(gradients.begin.back() * num_cases);
    parallel_for(num_texels, [&](std::size_t i) {
        for (std::size_t k = 0; k < num_cases; ++k) {
            const Reflectance& reflectance = surface.of(i, k);
            const Vec3 scale = surface.prior_stddev(i, k);
            const std::span<const LookTerm> row = looks.of(i);
            std::size_t slot = gradients.begin[i] * num_cases + k;
            for (const LookTerm* term = row.data(); term != row.data() + row.size();) {
                const LookModel look = next_look(term, row.data() + row.size(), reflectance);
                const Vec3 gradient(look.by_diffuse, look.by_specular, look.by_roughness);
                const double weight = kChannels / noise.variance(look.radiance);
                gradients.rows[slot] =
                    (std::sqrt(weight) * scale.cwiseProduct(gradient)).cast<float>();
                slot += num_cases;
            }
        }
    });
    return gradients;
}

Knowledge::Knowledge(const SupposedSurface& surface, std::size_t num_texels)
    : surface_(&surface), num_texels_(num_texels), covariances_(num_texels * surface.num_cases()) {}

double Knowledge::Covariance::add(const Vec3f& gradient) {
    // Sherman and Morrison's update; the factor by the matrix determinant lemma.
    const double d = double(gradient.x());
    const double s = double(gradient.y());
    const double r = double(gradient.z());
    const double cd = dd * d + ds * s + dr * r;
    const double cs = ds * d + ss * s + sr * r;
    const double cr = dr * d + sr * s + rr * r;
    const double growth = 1 + d * cd + s * cs + r * cr;
    const double share = 1 / growth;
    dd -= share * cd * cd;
    ds -= share * cd * cs;
    dr -= share * cd * cr;
    ss -= share * cs * cs;
    sr -= share * cs * cr;
    rr -= share * cr * cr;
    return growth;
}

double Knowledge::add_to(Covariance& covariance,
                         const LookGradients& looks,
                         std::size_t texel,
                         std::size_t which) const {
    const std::size_t num_cases = surface_->num_cases();
    double growth = 1;
    for (std::size_t look = looks.begin[texel]; look < looks.begin[texel + 1]; ++look) {
        growth *= covariance.add(looks.rows[look * num_cases + which]);
    }
    return growth;
}

double Knowledge::gain(const LookGradients& looks) const {
    PATINA_CHECK_EQ(looks.begin.size(), num_texels_ + 1);
    const std::size_t num_cases = surface_->num_cases();
    const double sum = ordered_reduce<double>(num_texels_, 0, [&](std::size_t i) {
        if (looks.begin[i] == looks.begin[i + 1]) return 0.0;
        // One logarithm for all cases: a determinant grows by less than 1e30 from a prior of 1.
        double growth = 1;
        for (std::size_t k = 0; k < num_cases; ++k) {
            Covariance covariance = covariances_[i * num_cases + k];
            growth *= add_to(covariance, looks, i, k);
        }
        return std::log(growth);
    });
    return sum / double(covariances_.size());
}

void Knowledge::add(const LookGradients& looks) {
    PATINA_CHECK_EQ(looks.begin.size(), num_texels_ + 1);
    const std::size_t num_cases = surface_->num_cases();
    parallel_for(num_texels_, [&](std::size_t i) {
        for (std::size_t k = 0; k < num_cases; ++k) {
            (void)add_to(covariances_[i * num_cases + k], looks, i, k);
        }
    });
}

double Knowledge::specular_error(std::size_t i) const {
    const std::size_t texel = i / surface_->num_cases();
    const std::size_t which = i % surface_->num_cases();
    return relative(surface_->prior_stddev(texel, which).y() * std::sqrt(covariances_[i].ss),
                    surface_->of(texel, which).specular);
}

ErrorSummary Knowledge::errors() const {
    const std::size_t num_cases = surface_->num_cases();
    std::vector<double> diffuse(covariances_.size());
    std::vector<double> specular(covariances_.size());
    std::vector<double> roughness(covariances_.size());
    parallel_for(covariances_.size(), [&](std::size_t i) {
        const Reflectance& reflectance = surface_->of(i / num_cases, i % num_cases);
        const Vec3 scale = surface_->prior_stddev(i / num_cases, i % num_cases);
        const Covariance& c = covariances_[i];
        diffuse[i] = relative(scale.x() * std::sqrt(c.dd), reflectance.diffuse.mean());
        specular[i] = specular_error(i);
        roughness[i] = relative(scale.z() * std::sqrt(c.rr), reflectance.roughness);
    });
    return {median(std::move(diffuse)), median(std::move(specular)), median(std::move(roughness))};
}

double Knowledge::share_known() const {
    const auto num_known = ordered_reduce<std::size_t>(covariances_.size(), 0, [&](std::size_t i) {
        return std::size_t(specular_error(i) <= kKnown);
    });
    return double(num_known) / double(covariances_.size());
}

double radiance_quantile(const SupposedSurface& surface,
                         std::span<const LookTable> tables,
                         double share) {
    std::vector<double> radiances;
    for (const LookTable& table : tables) {
        for (std::size_t texel = 0; texel + 1 < table.begin.size(); ++texel) {
            const LookTerm* term = table.terms.data() + table.begin[texel];
            const LookTerm* const row_end = table.terms.data() + table.begin[texel + 1];
            while (term != row_end) {
                radiances.push_back(
                    next_look(term, row_end, surface.of(texel, surface.num_cases() / 2)).radiance);
            }
        }
    }
    return radiances.empty() ? 0 : quantile(std::move(radiances), share);
}

}  // namespace patina
