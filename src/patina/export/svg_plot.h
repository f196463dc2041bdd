// Line charts as inline SVG. Colours and fonts come from the page's style sheet (html_style.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace patina {

enum class AxisScale { linear, logarithmic };

// Values at multiples of 1, 2 or 5 times a power of ten inside [low, high], at most max_count
// (>= 2) of them, ascending. low < high.
[[nodiscard]] std::vector<double> linear_ticks(double low, double high, int max_count);
// Powers of ten inside [low, high], thinned out to at most max_count; 2 and 5 times them where
// fewer than three powers lie inside. 0 < low < high.
[[nodiscard]] std::vector<double> logarithmic_ticks(double low, double high, int max_count);

// The ticks as text, with the decimals that their step needs; no two are alike.
[[nodiscard]] std::vector<std::string> tick_labels(const std::vector<double>& ticks,
                                                   AxisScale kind = AxisScale::linear);

struct PlotAxis {
    std::string label;  // with its unit in square brackets
    AxisScale scale = AxisScale::linear;
    std::optional<double> low = {};  // default: from the data
    std::optional<double> high = {};
};

// A curve; breaks where a value is not finite, or not positive on a logarithmic axis.
struct PlotSeries {
    std::string label;
    std::vector<double> x;
    std::vector<double> y;  // as many as x
    int color = 0;          // --series-N of the style sheet, 0 to 6
    bool is_dashed = false;
    bool has_markers = false;
};

// A line across the plot at x.
struct PlotMark {
    double x = 0;
    std::string label;
};

struct Plot {
    std::string title;
    PlotAxis x_axis;
    PlotAxis y_axis;
    std::vector<PlotSeries> series;
    std::vector<PlotMark> marks;
    double width = 460;   // [pixels]
    double height = 280;  // [pixels]
};

// The plot without its legend; empty when there is nothing to draw.
[[nodiscard]] std::string svg_plot(const Plot& plot);

// One line of samples of the curves and their labels, for any number of plots with the same series.
[[nodiscard]] std::string plot_legend(const std::vector<PlotSeries>& series);

}  // namespace patina
