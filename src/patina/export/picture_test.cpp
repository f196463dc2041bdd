#include "patina/export/picture.h"

#include "patina/export/page_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

using testing::HasSubstr;

TEST(SequentialColor, LightnessRunsLinearlyWithoutClipping) {
    for (int i = 0; i <= 100; ++i) {
        const double t = 0.01 * i;
        const Rgb color = sequential_color(t);
        // A colour outside the gamut would be clipped, and its lightness would be another.
        EXPECT_NEAR(perceived_lightness(color), 0.26 + 0.66 * t, 1e-5) << t;
    }
    EXPECT_TRUE((sequential_color(-1) == sequential_color(0)).all());
    EXPECT_TRUE((sequential_color(2) == sequential_color(1)).all());
}

TEST(DivergingColor, IsLightestInTheMiddleAndEquallyDarkAtBothEnds) {
    for (int i = 0; i <= 100; ++i) {
        const double s = 0.01 * i;
        const double above = perceived_lightness(diverging_color(s));
        const double below = perceived_lightness(diverging_color(-s));
        EXPECT_NEAR(above, 0.96 - 0.52 * s, 1e-5) << s;
        EXPECT_NEAR(below, above, 1e-5) << s;
    }
    EXPECT_GT(diverging_color(1)[0], diverging_color(1)[2]);
    EXPECT_LT(diverging_color(-1)[0], diverging_color(-1)[2]);
}

TEST(StatusColor, DiffersInLightnessBetweenAnyTwoStatesOfTheSurface) {
    for (int a = 1; a <= 3; ++a) {
        for (int b = 1; b < a; ++b) {
            EXPECT_GT(std::abs(perceived_lightness(status_color(a)) -
                               perceived_lightness(status_color(b))),
                      0.1);
        }
    }
}

TEST(LobeReasonColor, DiffersInLightnessBetweenAnyTwoReasons) {
    for (const LobeReason a : kLobeReasons) {
        for (const LobeReason b : kLobeReasons) {
            if (a >= b || a == LobeReason::off_surface) continue;
            EXPECT_GT(std::abs(perceived_lightness(lobe_reason_color(a)) -
                               perceived_lightness(lobe_reason_color(b))),
                      0.08)
                << lobe_reason_name(a) << ", " << lobe_reason_name(b);
        }
    }
}

TEST(SrgbFromLinear, HasTheKnownValues) {
    EXPECT_EQ(srgb_from_linear(-1), 0);
    EXPECT_NEAR(srgb_from_linear(0.002), 0.02584, 1e-15);
    EXPECT_NEAR(srgb_from_linear(0.214041140482232), 0.5, 1e-12);
    EXPECT_NEAR(srgb_from_linear(1), 1, 1e-15);
    EXPECT_NEAR(srgb_from_linear(9), 1, 1e-15);
}

TEST(Reduce, AveragesWhatTheMaskHolds) {
    MaskedImage source;
    source.image = Image(5, 2, 1);
    for (int x = 0; x < 5; ++x) {
        for (int y = 0; y < 2; ++y) source.image.at(x, y) = float(x + 10 * y);
    }
    source.mask = {1, 0, 0, 0, 1, 1, 0, 0, 0, 1};
    const MaskedImage reduced = reduce(source, 3);
    ASSERT_EQ(reduced.image.width, 3);
    ASSERT_EQ(reduced.image.height, 1);
    EXPECT_EQ(reduced.image.at(0, 0), 5);
    EXPECT_EQ(reduced.image.at(2, 0), 9);
    EXPECT_EQ(reduced.mask, (PixelMask{1, 0, 1}));
    EXPECT_EQ(reduce(source, 5).image.data, source.image.data);
}

TEST(ReduceLabels, TakesThemFromTheMiddle) {
    Image labels(4, 2, 1);
    labels.data = {0, 1, 2, 3, 3, 2, 1, 0};
    const Image reduced = reduce_labels(labels, 2);
    EXPECT_EQ(reduced.width, 2);
    EXPECT_EQ(reduced.height, 1);
    EXPECT_EQ(reduced.data, (std::vector<float>{2, 0}));
}

TEST(DisplayImage, AppliesWhiteCurveAndMask) {
    MaskedImage source{Image(2, 1, 1, 4.0F), {1, 0}};
    const Image shown = display_image(source, 4);
    EXPECT_EQ(shown.channels, 3);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(shown.at(0, 0, c), 1, 1e-6);
        EXPECT_EQ(shown.at(1, 0, c), float(no_value_color()[c]));
    }
}

TEST(Base64, IsThatOfTheStandard) {
    // RFC 4648, section 10.
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foob"), "Zm9vYg==");
    EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(PictureHtml, HoldsAPngAndItsSize) {
    const std::string html = picture_html(Image(3, 2, 3, 0.5F), "a \"b\"");
    EXPECT_EQ(nesting_error(html), "");
    EXPECT_THAT(html, HasSubstr("width=\"3\" height=\"2\" alt=\"a &quot;b&quot;\""));
    // The first bytes of every PNG.
    EXPECT_THAT(html, HasSubstr("data:image/png;base64,iVBORw0KGgo"));
}

TEST(ColorBar, ShowsItsEndsAndTicks) {
    const std::string svg =
        color_bar(-20, 20, "x < y", [](double v) { return v < 0 ? Rgb(0, 0, 1) : Rgb(1, 0, 0); });
    EXPECT_EQ(nesting_error(svg), "");
    for (const char* part : {"x &lt; y", "#0000ff", "#ff0000", ">\u221220<", ">20<"}) {
        EXPECT_THAT(svg, HasSubstr(part));
    }
}

}  // namespace
}  // namespace patina
