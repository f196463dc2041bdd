#include "patina/capture/capture.h"
#include "patina/capture/capture_fixture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace patina {
namespace {

// Values of up to 1 that are stored as float and divided or raised once in double and rounded once.
constexpr double kRounding = 1e-6;

RadianceImage radiance_of(CaptureFixture& fixture,
                          const std::string& radiometry,
                          const std::string& shot) {
    fixture.change({{R"({"response": "linear"})", radiometry},
                    {R"("image": "image.exr")", shot},
                    {R"(, "exposure": 1)", ""}});
    return load_radiance(read_capture_description(fixture.folder()), 0);
}

// An image of the fixture's size whose first pixel has these values.
Image image_with(float r, float g, float b, float rest = 0.25F) {
    Image image(4, 3, 3, rest);
    image.at(0, 0, 0) = r;
    image.at(0, 0, 1) = g;
    image.at(0, 0, 2) = b;
    return image;
}

TEST(Radiometry, DividesByTheExposure) {
    CaptureFixture fixture;
    const RadianceImage image =
        radiance_of(fixture, R"({"response": "linear"})", R"("image": "image.exr", "exposure": 4)");
    EXPECT_FLOAT_EQ(image.radiance.at(3, 2, 1), 0.0625F);
    EXPECT_TRUE(image.variance.empty());
}

TEST(Radiometry, UndoesGammaOfIntegerImages) {
    CaptureFixture fixture;
    write_png(fixture.folder() / "image.png", image_with(51.0F / 255, 102.0F / 255, 0));
    const RadianceImage image =
        radiance_of(fixture, R"({"response": {"gamma": 2.2}})", R"("image": "image.png")");
    EXPECT_NEAR(image.radiance.at(0, 0, 0), std::pow(0.2, 2.2), kRounding);
    EXPECT_NEAR(image.radiance.at(0, 0, 1), std::pow(0.4, 2.2), kRounding);
    EXPECT_EQ(image.radiance.at(0, 0, 2), 0);
}

TEST(Radiometry, UndoesSrgbOfIntegerImages) {
    CaptureFixture fixture;
    write_png(fixture.folder() / "image.png", image_with(5.0F / 255, 0.5F, 0), 8);
    const RadianceImage image =
        radiance_of(fixture, R"({"response": "srgb"})", R"("image": "image.png")");
    EXPECT_NEAR(image.radiance.at(0, 0, 0), 5.0 / 255 / 12.92, kRounding);
    EXPECT_NEAR(
        image.radiance.at(0, 0, 1), std::pow((128.0 / 255 + 0.055) / 1.055, 2.4), kRounding);
}

TEST(Radiometry, LeavesFloatImagesAsTheyAre) {
    CaptureFixture fixture;
    const RadianceImage image =
        radiance_of(fixture, R"({"response": {"gamma": 2.2}})", R"("image": "image.exr")");
    EXPECT_EQ(image.radiance.at(0, 0, 0), 0.25F);
}

TEST(Radiometry, ReadsIntegersOf16Bits) {
    CaptureFixture fixture;
    write_png(fixture.folder() / "image.png", image_with(1234.0F / 65535, 0, 0), 16);
    const RadianceImage image =
        radiance_of(fixture, R"({"response": "linear"})", R"("image": "image.png")");
    EXPECT_FLOAT_EQ(image.radiance.at(0, 0, 0), 1234.0F / 65535);
}

TEST(Radiometry, TakesTheDarkFrameOffAfterTheResponse) {
    CaptureFixture fixture;
    write_png(fixture.folder() / "image.png", image_with(102.0F / 255, 0.2F, 0.2F));
    write_png(fixture.folder() / "dark.png", image_with(51.0F / 255, 0.4F, 0.2F));
    const RadianceImage image =
        radiance_of(fixture,
                    R"({"response": {"gamma": 2}})",
                    R"("image": "image.png", "dark": "dark.png", "exposure": 0.5)");
    EXPECT_NEAR(image.radiance.at(0, 0, 0), (0.16 - 0.04) / 0.5, kRounding);
    // Negative values are kept.
    EXPECT_NEAR(image.radiance.at(0, 0, 1), (0.04 - 0.16) / 0.5, kRounding);
    EXPECT_EQ(image.usable[0], 1);
}

TEST(Radiometry, LeavesOutWhiteOfIntegerImagesByDefault) {
    CaptureFixture fixture;
    write_png(fixture.folder() / "image.png", image_with(0.1F, 1, 0.1F));
    const RadianceImage image =
        radiance_of(fixture, R"({"response": "linear"})", R"("image": "image.png")");
    EXPECT_EQ(image.usable[0], 0);
    EXPECT_EQ(image.usable[1], 1);
}

TEST(Radiometry, KnowsNoSaturationOfFloatImagesByDefault) {
    CaptureFixture fixture;
    write_exr(fixture.folder() / "bright.exr", image_with(50, 1, 1));
    const RadianceImage image =
        radiance_of(fixture, R"({"response": "linear"})", R"("image": "bright.exr")");
    EXPECT_EQ(image.usable[0], 1);
    EXPECT_EQ(image.radiance.at(0, 0, 0), 50);
}

TEST(Radiometry, JudgesSaturationBeforeTheDarkFrame) {
    CaptureFixture fixture;
    write_exr(fixture.folder() / "bright.exr", image_with(0, 0, 0.7F));
    write_exr(fixture.folder() / "dark.exr", Image(4, 3, 3, 0.2F));
    const RadianceImage image = radiance_of(fixture,
                                            R"({"response": "linear", "saturation": 0.7})",
                                            R"("image": "bright.exr", "dark": "dark.exr")");
    EXPECT_EQ(image.usable[0], 0);
    EXPECT_EQ(image.usable[1], 1);
}

TEST(Radiometry, LeavesOutWhatIsNotFinite) {
    CaptureFixture fixture;
    Image values = image_with(std::nanf(""), 1, 1);
    values.at(1, 0, 2) = std::numeric_limits<float>::infinity();
    write_exr(fixture.folder() / "holes.exr", values);
    const RadianceImage image =
        radiance_of(fixture, R"({"response": "linear"})", R"("image": "holes.exr")");
    EXPECT_EQ(image.usable[0], 0);
    EXPECT_EQ(image.usable[1], 0);
    EXPECT_EQ(image.usable[2], 1);
    EXPECT_EQ(image.radiance.at(0, 0, 0), 0);
    EXPECT_EQ(image.radiance.at(1, 0, 2), 0);
}

TEST(Radiometry, LeavesOutWhatIsBeyondMeasure) {
    CaptureFixture fixture;
    write_exr(fixture.folder() / "image.exr", image_with(0, -2e13F, 0));
    const RadianceImage image =
        radiance_of(fixture, R"({"response": "linear"})", R"("image": "image.exr")");
    EXPECT_EQ(image.usable[0], 0);
    EXPECT_EQ(image.radiance.at(0, 0, 1), 0);
    EXPECT_EQ(image.usable[1], 1);
}

TEST(Radiometry, LeavesOutWhoseVarianceIsBeyondMeasure) {
    CaptureFixture fixture;
    const RadianceImage image =
        radiance_of(fixture,
                    R"({"response": "linear", "noise": {"read": 1e12, "gain": 0}})",
                    R"("image": "image.exr", "exposure": 2e-10)");
    EXPECT_EQ(image.usable[0], 0);
    EXPECT_EQ(image.variance.at(0, 0, 0), 0);
}

TEST(Radiometry, LeavesOutWhatTheMaskMarks) {
    CaptureFixture fixture;
    Image mask(4, 3, 1, 1);
    mask.at(1, 0) = 128.0F / 255;
    mask.at(2, 0) = 127.0F / 255;
    write_png(fixture.folder() / "mask.png", mask);
    const RadianceImage image = radiance_of(
        fixture, R"({"response": "linear"})", R"("image": "image.exr", "mask": "mask.png")");
    EXPECT_EQ(image.usable[0], 1);
    EXPECT_EQ(image.usable[1], 1);
    EXPECT_EQ(image.usable[2], 0);
}

TEST(Radiometry, ExpandsGreyImages) {
    CaptureFixture fixture;
    write_exr(fixture.folder() / "grey.exr", Image(4, 3, 1, 0.5F));
    const RadianceImage image =
        radiance_of(fixture, R"({"response": "linear"})", R"("image": "grey.exr")");
    ASSERT_EQ(image.radiance.channels, 3);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(image.radiance.at(2, 1, c), 0.5F);
}

TEST(Radiometry, GivesTheVarianceOfTheRadiance) {
    CaptureFixture fixture;
    write_exr(fixture.folder() / "signed.exr", image_with(0.5F, -0.5F, 0));
    const RadianceImage image =
        radiance_of(fixture,
                    R"({"response": "linear", "noise": {"read": 0.1, "gain": 0.02}})",
                    R"("image": "signed.exr", "exposure": 2)");
    EXPECT_NEAR(image.variance.at(0, 0, 0), (0.01 + 0.02 * 0.5) / 4, kRounding);
    EXPECT_NEAR(image.variance.at(0, 0, 1), 0.01 / 4, kRounding);
    EXPECT_NEAR(image.variance.at(0, 0, 2), 0.01 / 4, kRounding);
}

TEST(Truth, IsGreyWhereItHasThreeChannelsAndIgnoredWhereItIsNotFinite) {
    CaptureFixture fixture;
    Image specular(4, 4, 3, 0.25F);
    specular.at(1, 2, 0) = 0.5F;
    specular.at(1, 2, 1) = 0.75F;
    write_exr(fixture.folder() / "specular.exr", specular);
    Image roughness(4, 4, 1, 0.25F);
    roughness.at(3, 3) = std::nanf("");
    write_exr(fixture.folder() / "roughness.exr", roughness);
    fixture.change({{R"("radiometry")",
                     R"("truth": {"diffuse": "grid.exr", "specular": "specular.exr",
                                  "roughness": "roughness.exr"}, "radiometry")"}});
    const TruthMaps maps = load_truth(read_capture_description(fixture.folder()));
    EXPECT_EQ(maps.diffuse.channels, 3);
    EXPECT_EQ(maps.specular.at(1, 2), 0.5F);
    EXPECT_EQ(maps.mask.at(0, 0), 1);
    EXPECT_EQ(maps.mask.at(3, 3), 0);
}

}  // namespace
}  // namespace patina
