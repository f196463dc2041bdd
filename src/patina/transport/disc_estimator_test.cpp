#include "patina/transport/disc_estimator.h"

#include <gtest/gtest.h>

#include "support/lit_scene.h"
#include "support/scenes.h"
#include <algorithm>
#include <array>
#include <cmath>

namespace patina {
namespace {

// --- The concave corner --------------------------------------------------------------------------
//
// Two plates at a right angle along the y axis, photons of one density on both. Lengths are in
// units of the radius that holds k photons far from the corner; brightness in units of the plate
// z = 0 that is looked at.

constexpr int kNeighbors = 150;
constexpr double kDensity = kNeighbors / kPi;  // photons per area
constexpr std::array<double, 6> kDistances = {0, 0.1, 0.25, 0.5, 0.75, 1};
constexpr std::size_t kNumPhotonSets = 400;
// No ball about the queries reaches further: to hold less than k photons beyond a radius of 2 is a
// deviation by more than 15 standard errors, even where half of the disc is missing.
constexpr double kReach = 2;

struct Photons {
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;
    std::vector<Rgbf> powers;
};

// A Poisson process on a rectangle.
void scatter(Rng& rng, const Vec3& corner, const Vec3& u, const Vec3& v, double power, Photons& p) {
    const double rate = kDensity * u.cross(v).norm();  // per unit of the position along u
    const Vec3 normal = u.cross(v).normalized();
    for (double s = -std::log1p(-rng.uniform()) / rate; s < 1;
         s -= std::log1p(-rng.uniform()) / rate) {
        p.positions.emplace_back((corner + s * u + rng.uniform() * v).cast<float>());
        p.normals.emplace_back(normal.cast<float>());
        p.powers.emplace_back(Rgbf::Constant(float(power / kDensity)));
    }
}

struct CornerCase {
    double other_brightness;
    bool normal_filter;
    std::array<double, 6> table;  // docs/theory.md, two decimals
};

// Areas of both plates in the ball of radius r about the point at distance d from the edge.
std::array<double, 2> areas_in_ball(double r, double d) {
    if (r <= d) return {kPi * r * r, 0};
    const double cosine = d / r;
    const double segment = r * r * (std::acos(cosine) - cosine * std::sqrt(1 - cosine * cosine));
    return {kPi * r * r - segment, kPi * (r * r - d * d) / 2};
}

// Mean of the disc estimate: the number of photons expected in the ball of the k-th neighbour has
// the Gamma distribution of shape k; the k - 1 others are spread uniformly inside the ball, and the
// k-th has the brightness of its rim; integrated over the radius.
double expected_ratio(const CornerCase& corner, double d) {
    constexpr int kNumSteps = 4000;
    const auto masses = [&](double r) {
        const auto [own, other] = areas_in_ball(r, d);
        return std::array<double, 2>{kDensity * own, corner.normal_filter ? 0.0 : kDensity * other};
    };
    double mean = 0;
    std::array<double, 2> before = {0, 0};
    for (int i = 1; i <= kNumSteps; ++i) {
        const double r = kReach * i / kNumSteps;
        const std::array<double, 2> after = masses(r);
        const double step_own = after[0] - before[0];
        const double step_other = after[1] - before[1];
        const double own = 0.5 * (after[0] + before[0]);
        const double other = 0.5 * (after[1] + before[1]);
        const double mass = own + other;
        const double density =
            std::exp((kNeighbors - 1) * std::log(mass) - mass - std::lgamma(double(kNeighbors)));
        const double inside = (kNeighbors - 1) * (own + corner.other_brightness * other) / mass *
                              (step_own + step_other);
        const double rim = step_own + corner.other_brightness * step_other;
        const double middle = r - 0.5 * kReach / kNumSteps;
        mean += density * (inside + rim) * (kNeighbors - 1) / kNeighbors /
                (kDensity * kPi * middle * middle);
        before = after;
    }
    return mean;
}

class ConcaveCorner : public testing::TestWithParam<CornerCase> {};

TEST_P(ConcaveCorner, BiasesTheDiscByTheSurfaceInItsBall) {
    const CornerCase& corner = GetParam();
    DiscOptions options;
    options.neighbors = kNeighbors;
    options.normal_filter = corner.normal_filter;
    std::vector<Vec3f> positions;
    for (const double d : kDistances) positions.emplace_back(float(d), 0.0F, 0.0F);
    const std::vector<Vec3f> normals(positions.size(), Vec3f::UnitZ());
    std::vector<std::vector<double>> ratios(kDistances.size(), std::vector<double>(kNumPhotonSets));
    for (std::size_t set = 0; set < kNumPhotonSets; ++set) {
        Rng rng(1, Pass::tests, set);
        Photons photons;
        scatter(rng, {0, -kReach, 0}, {1 + kReach, 0, 0}, {0, 2 * kReach, 0}, 1, photons);
        scatter(rng,
                {0, -kReach, 0},
                {0, 2 * kReach, 0},
                {0, 0, kReach},
                corner.other_brightness,
                photons);
        const std::vector<Rgbf> irradiance = disc_irradiance(
            {photons.positions, photons.powers, photons.normals}, {positions, normals}, options);
        for (std::size_t i = 0; i < irradiance.size(); ++i) ratios[i][set] = irradiance[i][0];
    }
    for (std::size_t i = 0; i < kDistances.size(); ++i) {
        const double expected = expected_ratio(corner, kDistances[i]);
        // A standard error of 1 / sqrt(150 x 400) = 0.4 % or less.
        EXPECT_TRUE(agrees(estimate_of(ratios[i]), expected)) << "at " << kDistances[i];
        EXPECT_NEAR(expected, corner.table[i], 0.005) << "at " << kDistances[i];
    }
}

INSTANTIATE_TEST_SUITE_P(
    Discs,
    ConcaveCorner,
    testing::Values(CornerCase{1, false, {1.00, 1.06, 1.13, 1.18, 1.13, 1.01}},
                    CornerCase{0.3, false, {0.65, 0.71, 0.81, 0.93, 1.00, 1.00}},
                    CornerCase{1, true, {0.50, 0.55, 0.63, 0.77, 0.92, 1.00}}));

TEST(ConcaveCorner, LeavesTheRatioEstimatorUnbiased) {
    // The same photons, located to texels of an eighth, in kernels of unit radius.
    constexpr int kTexelsPerUnit = 8;
    constexpr int kLength = 3;
    constexpr double kTexel = 1.0 / kTexelsPerUnit;
    Mesh mesh = rectangle({0, -2, 0}, {kLength, 0, 0}, {0, 4, 0}, {{0, 0}, {0.5, 1}});
    append(mesh, rectangle({0, -2, 0}, {0, 4, 0}, {0, 0, kLength}, {{0.5, 0}, {1, 1}}));
    // The first chart has 3 x 4 units in 24 x 32 cells, the second 4 x 3 in as many.
    const TexelAtlas atlas = build_atlas(mesh, 2 * kLength * kTexelsPerUnit, 4 * kTexelsPerUnit);
    RatioKernelOptions options;
    options.arrivals = 1e-9;
    options.min_radius = options.max_radius = kTexelsPerUnit;
    options.max_texels = 1 << 20;
    const std::vector<double> ones(atlas.texels.size(), 1.0);
    const RatioKernel kernel = build_ratio_kernel(atlas, ones, options);
    constexpr double kOtherBrightness = 0.3;
    for (const double d : kDistances) {
        const int column = std::min(int(d * kTexelsPerUnit), kLength * kTexelsPerUnit - 1);
        const TexelId texel =
            atlas.cell_texel[std::size_t(2 * kTexelsPerUnit * atlas.width + column)];
        ASSERT_NE(texel, kNoTexel);
        ASSERT_NEAR(atlas.texels[texel].point.position.x(), (column + 0.5) * kTexel, 1e-5);
        std::vector<double> ratios(kNumPhotonSets, 0.0);
        for (std::size_t set = 0; set < kNumPhotonSets; ++set) {
            Rng rng(2, Pass::tests, set);
            for (std::size_t k = kernel.begin[texel]; k < kernel.begin[texel + 1]; ++k) {
                const Texel& y = atlas.texels[kernel.texel[k]];
                const double power = (y.point.normal.z() > 0.5 ? 1 : kOtherBrightness) / kDensity;
                const double mean_count = kDensity * y.area;
                for (double s = -std::log1p(-rng.uniform()); s < mean_count;
                     s -= std::log1p(-rng.uniform())) {
                    ratios[set] += double(kernel.weight[k]) * power;
                }
            }
        }
        // The kernel's effective number of photons is (sum w)^2 / sum w^2 = 3/4 of those in the
        // disc, so the standard error is 1 / sqrt(0.75 x 75 x 400) = 0.7 % or less.
        EXPECT_TRUE(agrees(estimate_of(ratios), 1.0)) << "at " << d;
    }
}

// --- Plain planes and odd input ------------------------------------------------------------------

TEST(DiscEstimator, EqualsItsDefinitionOnAFewPhotons) {
    Rng rng(3, Pass::tests, 0);
    Photons photons;
    for (int i = 0; i < 60; ++i) {
        photons.positions.emplace_back(float(rng.uniform()), float(rng.uniform()), 0.0F);
        photons.powers.emplace_back(Rgbf(1, 2, 3) * float(rng.uniform()));
    }
    const std::vector<Vec3f> queries = {{0.5F, 0.5F, 0}, {0, 0, 0}, {1, 0.3F, 0.2F}};
    for (const bool correct_count : {true, false}) {
        DiscOptions options;
        options.neighbors = 7;
        options.correct_count = correct_count;
        const std::vector<Rgbf> irradiance =
            disc_irradiance({photons.positions, photons.powers, {}}, {queries, {}}, options);
        for (std::size_t q = 0; q < queries.size(); ++q) {
            std::vector<std::pair<float, std::size_t>> nearest;
            for (std::size_t i = 0; i < photons.positions.size(); ++i) {
                nearest.emplace_back((photons.positions[i] - queries[q]).squaredNorm(), i);
            }
            std::sort(nearest.begin(), nearest.end());
            Rgb power = Rgb::Zero();
            for (std::size_t i = 0; i < 7; ++i) {
                power += photons.powers[nearest[i].second].cast<double>();
            }
            const Rgb expected =
                power * (correct_count ? 6.0 / 7 : 1.0) / (kPi * double(nearest[6].first));
            // Single precision: squared distances round by 2e-7.
            EXPECT_LT((irradiance[q].cast<double>() / expected - 1).abs().maxCoeff(), 1e-6);
        }
    }
}

TEST(DiscEstimator, TakesAllPhotonsWhereThereAreFewerThanK) {
    const std::vector<Vec3f> positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
    const std::vector<Rgbf> powers(3, Rgbf::Ones());
    const std::vector<Vec3f> query = {Vec3f::Zero()};
    const std::vector<Rgbf> irradiance = disc_irradiance({positions, powers, {}}, {query, {}}, {});
    EXPECT_NEAR(double(irradiance[0][0]), 2 / (4 * kPi), 1e-7);
}

TEST(DiscEstimator, IsZeroWithoutPhotons) {
    const std::vector<Vec3f> query = {Vec3f::Zero()};
    const std::vector<Vec3f> position = {Vec3f::UnitX()};
    const std::vector<Rgbf> power = {Rgbf::Ones()};
    EXPECT_TRUE((disc_irradiance({}, {query, {}}, {})[0] == 0).all());
    EXPECT_TRUE((disc_irradiance({position, power, {}}, {query, {}}, {})[0] == 0).all());
}

TEST(DiscEstimator, GivesEachHalfOfTracedPhotonsTheWholePower) {
    // Photons on a plane in two halves; the mean of the halves is the irradiance.
    const Mesh mesh = rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    const TexelAtlas atlas = build_atlas(mesh, 5, 5);
    constexpr std::size_t kNumPhotons = 20'000;
    PhotonPaths paths;
    for (std::size_t i = 0; i < kNumPhotons; ++i) {
        Rng rng(4, Pass::tests, i);
        paths.arrival_position.emplace_back(float(rng.uniform()), float(rng.uniform()), 0.0F);
        paths.arrival_half.push_back(i % 2);
    }
    const std::vector<Rgbf> power(kNumPhotons, Rgbf::Constant(3.0F / kNumPhotons));
    DiscOptions options;
    options.neighbors = 1000;
    const std::vector<IndirectIrradiance> irradiance =
        disc_indirect_irradiance(paths, power, atlas, options);
    const std::size_t middle = 12;
    for (const Rgbf& half : irradiance[middle].halves) {
        // k = 500 photons: a standard error of 1 / sqrt(500), as (k-1) / Gamma(k) has.
        EXPECT_NEAR(double(half[0]), 3, 3 * normal_threshold() / std::sqrt(498.0));
    }
}

}  // namespace
}  // namespace patina
