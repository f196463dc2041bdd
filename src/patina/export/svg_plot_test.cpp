#include "patina/export/svg_plot.h"

#include "patina/export/page_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace patina {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pointwise;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t number = 0;
    for (std::size_t i = text.find(part); i != std::string::npos; i = text.find(part, i + 1)) {
        ++number;
    }
    return number;
}

void expect_ticks(const std::vector<double>& ticks, const std::vector<double>& expected) {
    EXPECT_THAT(ticks, Pointwise(DoubleNear(1e-12), expected));
}

TEST(LinearTicks, AreRoundNumbersInside) {
    expect_ticks(linear_ticks(0, 1, 6), {0, 0.2, 0.4, 0.6, 0.8, 1});
    expect_ticks(linear_ticks(0, 1, 5), {0, 0.5, 1});
    expect_ticks(linear_ticks(-3, 7, 6), {-2, 0, 2, 4, 6});
    expect_ticks(linear_ticks(0.13, 0.17, 5), {0.13, 0.14, 0.15, 0.16, 0.17});
    expect_ticks(linear_ticks(1000, 4200, 4), {1000, 2000, 3000, 4000});
}

TEST(LinearTicks, NeverExceedTheirNumberAndAreNeverFewerThanTwoOfSix) {
    for (int i = 0; i < 400; ++i) {
        const double low = 10 * std::sin(double(i));
        const double high = low + std::pow(10.0, 3 * std::sin(7.0 * i));
        const std::vector<double> ticks = linear_ticks(low, high, 6);
        EXPECT_LE(ticks.size(), 6U);
        EXPECT_GE(ticks.size(), 2U) << low << " " << high;
        for (const double tick : ticks) {
            EXPECT_GE(tick, low - 1e-8 * (high - low));
            EXPECT_LE(tick, high + 1e-8 * (high - low));
        }
    }
}

TEST(LogarithmicTicks, ArePowersOfTenOrTheirParts) {
    expect_ticks(logarithmic_ticks(1e-3, 10, 8), {1e-3, 1e-2, 1e-1, 1, 10});
    expect_ticks(logarithmic_ticks(3, 60, 8), {5, 10, 20, 50});
    const std::vector<double> wide = logarithmic_ticks(1e-12, 1, 5);
    EXPECT_LE(wide.size(), 5U);
    EXPECT_GE(wide.size(), 3U);
}

TEST(TickLabels, HaveTheDecimalsOfTheirStep) {
    EXPECT_THAT(tick_labels({0, 0.5, 1}), ElementsAre("0.0", "0.5", "1.0"));
    EXPECT_THAT(tick_labels({-20, 0, 20}), ElementsAre("\u221220", "0", "20"));
    EXPECT_THAT(tick_labels({0.13, 0.14}), ElementsAre("0.13", "0.14"));
    EXPECT_THAT(tick_labels({1e-5, 1e-4, 1e-3}, AxisScale::logarithmic),
                ElementsAre("10⁻⁵", "10⁻⁴", "10⁻³"));
    EXPECT_THAT(tick_labels({0.1, 1, 10}, AxisScale::logarithmic), ElementsAre("0.1", "1", "10"));
    EXPECT_THAT(tick_labels({0.005, 0.01, 0.02}, AxisScale::logarithmic),
                ElementsAre("0.005", "0.01", "0.02"));
    for (const double high : {0.003, 0.7, 12.0, 9000.0, 3e6}) {
        const std::vector<std::string> labels = tick_labels(linear_ticks(0, high, 6));
        EXPECT_EQ(std::set<std::string>(labels.begin(), labels.end()).size(), labels.size());
    }
}

Plot small_plot() {
    Plot plot;
    plot.title = "E < th";
    plot.x_axis = {"turn"};
    plot.y_axis = {"E"};
    plot.series = {{"photon & co", {0, 1, 2, 3}, {1, 2, kNan, 4}, 3, true, true}};
    return plot;
}

TEST(SvgPlot, BreaksCurvesWhereThereIsNoValue) {
    const std::string svg = svg_plot(small_plot());
    EXPECT_EQ(nesting_error(svg), "");
    EXPECT_THAT(svg, HasSubstr("E &lt; th"));
    EXPECT_THAT(svg, HasSubstr("class=\"curve dashed\""));
    EXPECT_EQ(count(svg, "<circle"), 3U);
    const std::string path = svg.substr(svg.find(" d=\""));
    EXPECT_EQ(count(path.substr(0, path.find('/')), "M"), 2U);
}

TEST(SvgPlot, PlacesValuesBetweenTheAxes) {
    Plot plot = small_plot();
    plot.series = {{"line", {0, 10}, {0, 1}, 1}};
    plot.y_axis.low = 0;
    plot.y_axis.high = 1;
    plot.width = 176;  // the axes are 100 pixels long
    plot.height = 176;
    EXPECT_THAT(svg_plot(plot), HasSubstr("d=\"M62.0 130.0L162.0 30.0\""));
}

TEST(SvgPlot, LogarithmicAxesLeaveOutWhatIsNotPositive) {
    Plot plot = small_plot();
    plot.y_axis.scale = AxisScale::logarithmic;
    plot.series = {{"error", {0, 1, 2}, {0, 1e-2, 1e-4}, 1, false, true}};
    EXPECT_EQ(count(svg_plot(plot), "<circle"), 2U);
    plot.series[0].y = {0, 0, -1};
    EXPECT_EQ(svg_plot(plot), "");
}

TEST(SvgPlot, ConstantDataHaveAnAxisToo) {
    Plot plot = small_plot();
    plot.series = {{"flat", {5}, {0.25}, 1, false, true}};
    const std::string svg = svg_plot(plot);
    EXPECT_EQ(count(svg, "<circle"), 1U);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(PlotLegend, NamesEveryCurve) {
    const std::string html = plot_legend(small_plot().series);
    EXPECT_EQ(nesting_error(html), "");
    EXPECT_THAT(html, HasSubstr("photon &amp; co"));
    EXPECT_THAT(html, HasSubstr("var(--series-3)"));
}

}  // namespace
}  // namespace patina
