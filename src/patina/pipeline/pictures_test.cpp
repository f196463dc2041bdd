#include "patina/pipeline/pictures.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(Pictures, ShowDifferencesUpToATenthOfWhite) {
    Image real(2, 1, 3, 1.0f);
    Image synthetic(2, 1, 3, 1.1f);
    synthetic.at(0, 0, 1) = 1.5f;
    const Image picture = difference_picture(real, synthetic, std::vector<std::uint8_t>{1, 0}, 2.0);
    EXPECT_NEAR(picture.at(0, 0, 0), 0.5, 1e-6);
    EXPECT_EQ(picture.at(0, 0, 1), 1.0f);
    EXPECT_EQ(picture.at(1, 0, 0), 0.0f);
}

TEST(Pictures, LieInTheContactSheetOnce) {
    const std::vector<Image> pictures(5, Image(20, 10, 3, 1.0f));
    const Image sheet = contact_sheet(pictures, 10);
    // Reduced by two, each covers 10 x 5 pixels.
    int num_white = 0;
    for (const float value : sheet.data) num_white += value == 1.0f ? 1 : 0;
    EXPECT_EQ(num_white, 3 * 5 * 10 * 5);
}

}  // namespace
}  // namespace patina
