// Methods gather and photon compute the same light in different ways, so their maps are the same
// within what each states of its errors.
#include <gtest/gtest.h>

#include "simulated_capture.h"
#include <cmath>
#include <string>
#include <vector>

namespace patina {
namespace {

// Differences over the standard error of a difference.
struct Scores {
    double beyond = 0;  // |z| > 1.96
    double count = 0;

    void add(double a, double b, double error_a, double error_b) {
        const double deviation = std::hypot(error_a, error_b);
        if (!std::isfinite(deviation)) return;
        beyond += std::abs(a - b) > 1.96 * deviation;
        count += 1;
    }
};

struct Case {
    const char* name;
    ObjectKind kind;
    std::vector<std::size_t> lamps;
};

class Agreement : public testing::TestWithParam<Case> {};

TEST_P(Agreement, OfGatherAndPhotonOverTexels) {
    ScanOptions scan;
    scan.columns = 64;
    scan.rows = 40;
    scan.samples_per_pixel = 64;
    scan.heldout_sample_factor = 1;
    const SimulatedCapture capture(GetParam().kind, GetParam().lamps, scan);
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
    // Errors stated as independent, while both methods see the same sensor noise, leave less than
    // 5 % beyond 1.96. Neighbours share their errors, say ten to a patch, and a false alarm of one
    // in a thousand is at 3.1 standard deviations of the share.
    for (const Scores* scores : {&diffuse, &specular, &roughness}) {
        ASSERT_GT(scores->count, 100);
        const double chance = 3.1 * std::sqrt(0.05 * 0.95 / (scores->count / 10));
        EXPECT_LE(scores->beyond / scores->count, 0.05 + chance);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Objects,
    Agreement,
    testing::Values(Case{"A", ObjectKind::a, {25, 55, 9, 39, 6, 36, 5, 35, 14, 44, 29, 59, 10}},
                    Case{"B", ObjectKind::b, {2, 5, 9, 15, 18, 25, 32, 35, 39, 48, 52, 55}},
                    Case{"C", ObjectKind::c, {2, 5, 9, 15, 18, 25, 32, 35, 39, 48, 52, 55}}),
    [](const testing::TestParamInfo<Case>& object) { return std::string(object.param.name); });

}  // namespace
}  // namespace patina
