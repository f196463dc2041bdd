// Methods gather and photon compute the same light in different ways, so their maps are the same
// within what each states of its errors, and so is the light that each found under its maps and the
// path tracer's.
#include "support/agreement.h"

#include <gtest/gtest.h>

#include "simulated_capture.h"
#include <cmath>
#include <string>
#include <vector>

namespace patina {
namespace {

// What docs/uncertainty.md states of the indirect light: a bias of so much of it.
constexpr double kStatedBias = 0.02;
// Neighbours share their errors, say so many to a patch.
constexpr double kPatch = 10;

// Less than 5 % beyond 1.96. A false alarm of one in a thousand is at 3.1 standard deviations of
// the share.
void expect_agreement(const Scores& scores) {
    ASSERT_GT(scores.count, 100);
    const double chance = 3.1 * std::sqrt(0.05 * 0.95 / (scores.count / kPatch));
    EXPECT_LE(scores.beyond / scores.count, 0.05 + chance);
}

// The stated bias, and four standard deviations of chance: one false alarm in 16 000. The halves of
// neighbours share rays or photons, so that their variances count tenfold.
void expect_same_light(const LightSum& found, const LightSum& traced) {
    EXPECT_NEAR(
        found.value,
        traced.value,
        kStatedBias * traced.value + 4 * std::sqrt(kPatch * found.variance + traced.variance));
}

struct Case {
    const char* name;
    ObjectKind kind;
    std::vector<std::size_t> lamps;
};

const Case kPlates = {"A", ObjectKind::a, {25, 55, 9, 39, 6, 36, 5, 35, 14, 44, 29, 59, 10}};

ScanOptions small_scan() {
    ScanOptions scan;
    scan.columns = 64;
    scan.rows = 40;
    scan.samples_per_pixel = 64;
    scan.heldout_sample_factor = 1;
    return scan;
}

class Agreement : public testing::TestWithParam<Case> {};

TEST_P(Agreement, OfGatherAndPhotonOverTexels) {
    const SimulatedCapture capture(GetParam().kind, GetParam().lamps, small_scan());
    EstimateOptions options;
    options.max_iterations = 20;
    options.tolerance = 1e-3;
    options.method = Method::gather;
    const Estimate gather = capture.estimate(options);
    options.method = Method::photon;
    options.photons.photons = 50'000;
    const Estimate photon = capture.estimate(options);
    Scores diffuse;
    Scores specular;
    Scores roughness;
    for (std::size_t i = 0; i < gather.maps.size(); ++i) {
        if (gather.status[i] != TexelStatus::measured ||
            photon.status[i] != TexelStatus::measured) {
            continue;
        }
        const Reflectance& a = gather.maps[i];
        const Reflectance& b = photon.maps[i];
        const Reflectance& error_a = gather.errors[i];
        const Reflectance& error_b = photon.errors[i];
        for (int c = 0; c < 3; ++c) {
            diffuse.add(a.diffuse[c], b.diffuse[c], error_a.diffuse[c], error_b.diffuse[c]);
        }
        specular.add(a.specular, b.specular, error_a.specular, error_b.specular);
        roughness.add(a.roughness, b.roughness, error_a.roughness, error_b.roughness);
    }
    // Errors are stated as independent, while both methods see the same sensor noise.
    for (const Scores* scores : {&diffuse, &specular, &roughness}) {
        expect_agreement(*scores);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Objects,
    Agreement,
    testing::Values(kPlates,
                    Case{"B", ObjectKind::b, {2, 5, 9, 15, 18, 25, 32, 35, 39, 48, 52, 55}},
                    Case{"C", ObjectKind::c, {2, 5, 9, 15, 18, 25, 32, 35, 39, 48, 52, 55}}),
    [](const testing::TestParamInfo<Case>& object) { return std::string(object.param.name); });

// On the plates alone. On B and C at this size it does not hold (B: gather 0.93 and photon 0.77 of
// the path tracer's light); at 512 x 256 texels it does: docs/theory.md.
TEST(AgreementUnderFinalMaps, OfBothWithThePathTracer) {
    const SimulatedCapture capture(kPlates.kind, kPlates.lamps, small_scan());
    EstimateOptions options;
    options.method = Method::gather;
    const Estimate estimate = capture.estimate(options);
    PathTracerCheck check(capture.capture(), estimate.maps, 1);
    const LightSum traced = check.traced();
    expect_same_light(check.found(options), traced);
    options.method = Method::photon;
    options.photons.photons = 100'000;
    expect_same_light(check.found(options), traced);
}

struct Lobe {
    double sigma = 0;
    double albedo = 0;  // 2 sigma^2 Ps
};

class AgreementUnderLobes : public testing::TestWithParam<Lobe> {};

TEST_P(AgreementUnderLobes, OfGatherWithThePathTracer) {
    const SimulatedCapture capture(kPlates.kind, kPlates.lamps, small_scan());
    const auto [sigma, albedo] = GetParam();
    const std::vector<Reflectance> maps(capture.capture().atlas.texels.size(),
                                        {Rgb::Constant(0.4), albedo / (2 * square(sigma)), sigma});
    EstimateOptions options;
    options.method = Method::gather;
    PathTracerCheck check(capture.capture(), maps, 1);
    expect_same_light(check.found(options), check.traced());
}

// What narrow lobes send on goes by photons; what strong ones send on of indirect light, over
// second rays: spread evenly, it would be 17 % too much.
INSTANTIATE_TEST_SUITE_P(NarrowAndStrong,
                         AgreementUnderLobes,
                         testing::Values(Lobe{0.05, 0.1}, Lobe{0.2, 0.3}));

}  // namespace
}  // namespace patina
