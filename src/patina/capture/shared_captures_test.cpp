// Loads real captures that are too big for the project.
#include "patina/capture/capture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace patina {
namespace {

namespace fs = std::filesystem;

fs::path shared_captures() {
    const char* const folder = std::getenv("PATINA_SHARED");
    const fs::path beside = fs::path(__FILE__).parent_path() / "../../../../shared";
    return (folder == nullptr ? beside : fs::path(folder)) / "captures";
}

double usable_share(const RadianceImage& image) {
    const auto unusable = std::count(image.usable.begin(), image.usable.end(), 0);
    return 1 - double(unusable) / double(image.usable.size());
}

struct Expected {
    const char* name;
    std::size_t num_shots;
    std::size_t num_heldout;
};

class SharedCapture : public ::testing::TestWithParam<Expected> {};

TEST_P(SharedCapture, LoadsWhole) {
    const fs::path folder = shared_captures() / GetParam().name;
    if (!fs::exists(folder)) GTEST_SKIP() << "set PATINA_SHARED to the folder of captures/";
    const Capture capture = load_capture(folder);
    const std::vector<Shot>& shots = capture.description.shots;
    EXPECT_EQ(shots.size(), GetParam().num_shots);
    EXPECT_EQ(std::size_t(std::count_if(
                  shots.begin(), shots.end(), [](const Shot& shot) { return shot.heldout; })),
              GetParam().num_heldout);
    EXPECT_FALSE(capture.atlas.texels.empty());
    for (std::size_t i = 0; i < shots.size(); ++i) {
        const RadianceImage image = load_radiance(capture.description, i);
        EXPECT_GT(usable_share(image), 0.5) << "shot " << i;
        EXPECT_EQ(image.variance.data.size(), image.radiance.data.size()) << "shot " << i;
    }
    if (!capture.description.truth) return;
    EXPECT_FALSE(load_truth(capture.description).diffuse.empty());
}

INSTANTIATE_TEST_SUITE_P(OfTheSharedFolder,
                         SharedCapture,
                         ::testing::Values(Expected{"channel", 20, 4},
                                           Expected{"real_cat", 20, 3},
                                           Expected{"real_ball", 24, 4},
                                           Expected{"real_box", 9, 2}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace patina
