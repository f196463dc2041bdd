#include "patina/pipeline/truth_comparison.h"

#include <gtest/gtest.h>

#include <limits>

namespace patina {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

Image map_of(const std::vector<float>& values, int channels = 1) {
    Image image(int(values.size()), 1, channels);
    for (std::size_t i = 0; i < image.data.size(); ++i) {
        image.data[i] = values[i / std::size_t(channels)];
    }
    return image;
}

// Four texels: measured, diffuse measured, filled, off the surface.
struct Scene {
    ReflectanceMaps maps{map_of({0.6f, 0.5f, 0.9f, 0.0f}, 3),
                         map_of({1.2f, 9.0f, 9.0f, 0.0f}),
                         map_of({0.1f, 0.2f, 0.2f, 0.0f}),
                         map_of({0.05f, 0.2f, kInfinite, 0.0f}, 3),
                         map_of({0.2f, kInfinite, kInfinite, 0.0f}),
                         map_of({0.01f, kInfinite, kInfinite, 0.0f}),
                         map_of({1, 2, 3, 0})};
    TruthMaps truth{map_of({0.5f, 0.5f, 0.1f, 0.1f}, 3),
                    map_of({1.0f, 1.0f, 1.0f, 1.0f}),
                    map_of({0.1f, 0.1f, 0.1f, 0.1f}),
                    Image()};
};

TEST(TruthComparison, TakesDiffuseFromStatusOneAndTwo) {
    const Scene scene;
    const auto diffuse = compare_with_truth(scene.maps, scene.truth).diffuse;
    ASSERT_TRUE(diffuse.has_value());
    EXPECT_EQ(diffuse->num_texels, 2U);
    EXPECT_NEAR(diffuse->mean_relative_error, 0.1, 1e-6);
    EXPECT_NEAR(diffuse->median_absolute_relative_error, 0.1, 1e-6);
    EXPECT_NEAR(diffuse->rmse, 0.1 / std::sqrt(2.0), 1e-6);
}

TEST(TruthComparison, CountsTruthInsideTheIntervals) {
    const Scene scene;
    // Pd of the first texel is 2 standard errors off, of the second none.
    const auto diffuse = compare_with_truth(scene.maps, scene.truth).diffuse;
    EXPECT_EQ(diffuse->coverage68, 0.5);
    EXPECT_EQ(diffuse->coverage95, 0.5);
    // Ps of the only texel is one standard error off, just outside 68 %.
    const auto specular = compare_with_truth(scene.maps, scene.truth).specular;
    EXPECT_EQ(specular->coverage68, 0.0);
    EXPECT_EQ(specular->coverage95, 1.0);
}

TEST(TruthComparison, RanksErrorsPredictedAndMade) {
    const Scene scene;
    // The texel of the larger standard error is the better one.
    const auto diffuse = compare_with_truth(scene.maps, scene.truth).diffuse;
    EXPECT_NEAR(diffuse->error_rank_correlation, -1, 1e-12);
}

TEST(TruthComparison, TakesTheLobeFromStatusOne) {
    const Scene scene;
    const Comparison::Truth truth = compare_with_truth(scene.maps, scene.truth);
    EXPECT_EQ(truth.specular->num_texels, 1U);
    EXPECT_NEAR(truth.specular->mean_relative_error, 0.2, 1e-6);
    EXPECT_EQ(truth.roughness->num_texels, 1U);
    EXPECT_EQ(truth.roughness->rmse, 0.0);
}

TEST(TruthComparison, LeavesOutWhatTheMaskExcludes) {
    Scene scene;
    scene.truth.mask = map_of({0, 1, 1, 1});
    const Comparison::Truth truth = compare_with_truth(scene.maps, scene.truth);
    EXPECT_EQ(truth.diffuse->num_texels, 1U);
    EXPECT_EQ(truth.diffuse->rmse, 0.0);
    EXPECT_FALSE(truth.specular.has_value());
}

}  // namespace
}  // namespace patina
