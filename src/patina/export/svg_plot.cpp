#include "patina/export/svg_plot.h"

#include "patina/export/html_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {
namespace {

constexpr double kLeft = 62;
constexpr double kRight = 14;
constexpr double kTop = 30;
constexpr double kBottom = 46;
constexpr double kPixelsPerTickX = 62;
constexpr double kPixelsPerTickY = 34;
// Room above and below the data, share of its range.
constexpr double kMargin = 0.06;
// Ticks within this share of a step of an end count as inside.
constexpr double kTickSlack = 1e-9;

// One axis, ready to place values on pixels.
struct Scale {
    AxisScale kind = AxisScale::linear;
    double low = 0;
    double high = 1;
    double pixel_low = 0;
    double pixel_high = 1;

    [[nodiscard]] bool shows(double value) const {
        return std::isfinite(value) && (kind == AxisScale::linear || value > 0);
    }
    [[nodiscard]] double pixel(double value) const {
        const double t = kind == AxisScale::linear ? (value - low) / (high - low)
                                                   : std::log(value / low) / std::log(high / low);
        return pixel_low + t * (pixel_high - pixel_low);
    }
    [[nodiscard]] std::vector<double> ticks(double pixels_per_tick) const {
        const int count = std::max(2, int(std::abs(pixel_high - pixel_low) / pixels_per_tick));
        return kind == AxisScale::linear ? linear_ticks(low, high, count)
                                         : logarithmic_ticks(low, high, count);
    }
};

// The axis's own limits, else those of the data with some room; never of width zero.
Scale make_scale(const PlotAxis& axis, const std::vector<double>& values, double margin) {
    Scale scale{axis.scale};
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const double value : values) {
        if (!scale.shows(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    if (low > high) low = high = 1;
    if (axis.scale == AxisScale::linear) {
        const double room = high > low ? margin * (high - low) : std::max(std::abs(low), 1.0) / 2;
        scale.low = axis.low.value_or(low - room);
        scale.high = axis.high.value_or(high + room);
    } else {
        const double room = high > low ? std::pow(high / low, margin) : 10;
        scale.low = axis.low.value_or(low / room);
        scale.high = axis.high.value_or(high * room);
    }
    return scale;
}

Scale scale_of(const Plot& plot, bool is_x) {
    std::vector<double> values;
    for (const PlotSeries& series : plot.series) {
        const std::vector<double>& more = is_x ? series.x : series.y;
        values.insert(values.end(), more.begin(), more.end());
    }
    Scale scale = make_scale(is_x ? plot.x_axis : plot.y_axis, values, is_x ? 0 : kMargin);
    scale.pixel_low = is_x ? kLeft : plot.height - kBottom;
    scale.pixel_high = is_x ? plot.width - kRight : kTop;
    return scale;
}

std::string text_element(
    double x, double y, const char* css_class, const char* anchor, const std::string& text) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\" text-anchor=\"{}\">{}</text>",
                       x,
                       y,
                       css_class,
                       anchor,
                       escape_html(text));
}

std::string line_element(double x1, double y1, double x2, double y2, const char* css_class) {
    return fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>",
        x1,
        y1,
        x2,
        y2,
        css_class);
}

std::string draw_axes(const Plot& plot, const Scale& x, const Scale& y) {
    std::string svg;
    const std::vector<double> y_ticks = y.ticks(kPixelsPerTickY);
    const std::vector<std::string> y_labels = tick_labels(y_ticks, y.kind);
    for (std::size_t i = 0; i < y_ticks.size(); ++i) {
        const double at = y.pixel(y_ticks[i]);
        svg += line_element(x.pixel_low, at, x.pixel_high, at, "grid");
        svg += text_element(x.pixel_low - 7, at + 4, "tick", "end", y_labels[i]);
    }
    const std::vector<double> x_ticks = x.ticks(kPixelsPerTickX);
    const std::vector<std::string> x_labels = tick_labels(x_ticks, x.kind);
    for (std::size_t i = 0; i < x_ticks.size(); ++i) {
        const double at = x.pixel(x_ticks[i]);
        svg += line_element(at, y.pixel_low, at, y.pixel_low + 4, "frame");
        svg += text_element(at, y.pixel_low + 17, "tick", "middle", x_labels[i]);
    }
    svg += line_element(x.pixel_low, y.pixel_low, x.pixel_high, y.pixel_low, "frame");
    const double middle = 0.5 * (x.pixel_low + x.pixel_high);
    svg += text_element(middle, plot.height - 8, "tick", "middle", plot.x_axis.label);
    const double y_middle = 0.5 * (y.pixel_low + y.pixel_high);
    svg += fmt::format("<g transform=\"translate(14 {:.1f}) rotate(-90)\">{}</g>",
                       y_middle,
                       text_element(0, 0, "tick", "middle", plot.y_axis.label));
    svg += text_element(x.pixel_low, 16, "title", "start", plot.title);
    return svg;
}

std::string draw_marks(const Plot& plot, const Scale& x, const Scale& y) {
    std::string svg;
    for (const PlotMark& mark : plot.marks) {
        const double at = x.pixel(mark.x);
        svg += line_element(at, y.pixel_low, at, y.pixel_high, "marker");
        svg += text_element(at + 4, y.pixel_high + 10, "tick", "start", mark.label);
    }
    return svg;
}

std::string draw_series(const PlotSeries& series, const Scale& x, const Scale& y) {
    std::string path;
    std::string markers;
    bool is_down = false;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        if (!x.shows(series.x[i]) || !y.shows(series.y[i])) {
            is_down = false;
            continue;
        }
        const double px = x.pixel(series.x[i]);
        const double py = y.pixel(series.y[i]);
        path += fmt::format("{}{:.1f} {:.1f}", is_down ? "L" : "M", px, py);
        is_down = true;
        if (series.has_markers) {
            markers += fmt::format(
                "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.8\" style=\"fill:var(--series-{})\"/>",
                px,
                py,
                series.color);
        }
    }
    if (path.empty()) return "";
    return fmt::format("<path class=\"curve{}\" style=\"stroke:var(--series-{})\" d=\"{}\"/>{}",
                       series.is_dashed ? " dashed" : "",
                       series.color,
                       path,
                       markers);
}

// Whether all ticks are powers of ten that read badly in full.
bool are_large_powers(const std::vector<double>& ticks) {
    constexpr double kPlainLow = 0.01;
    constexpr double kPlainHigh = 1000;
    return (ticks.front() < kPlainLow || ticks.back() > kPlainHigh) &&
           std::all_of(ticks.begin(), ticks.end(), [](double tick) {
               const double exponent = std::log10(tick);
               return std::abs(exponent - std::round(exponent)) < kTickSlack;
           });
}

}  // namespace

std::vector<double> linear_ticks(double low, double high, int max_count) {
    const double power = std::pow(10.0, std::floor(std::log10((high - low) / max_count)));
    std::vector<double> ticks;
    for (const double factor : {1.0, 2.0, 5.0, 10.0, 20.0}) {
        const double step = factor * power;
        const double first = std::ceil(low / step - kTickSlack);
        const double last = std::floor(high / step + kTickSlack);
        if (last - first + 1 > max_count) continue;
        // Adding 0 turns -0 into 0.
        for (double k = first; k <= last; ++k) ticks.push_back(k * step + 0.0);
        break;
    }
    return ticks;
}

std::vector<double> logarithmic_ticks(double low, double high, int max_count) {
    const int first = int(std::ceil(std::log10(low) - kTickSlack));
    const int last = int(std::floor(std::log10(high) + kTickSlack));
    std::vector<double> ticks;
    if (last - first + 1 >= 3) {
        const int stride = (last - first + max_count) / max_count;
        for (int k = first; k <= last; k += stride) ticks.push_back(std::pow(10.0, k));
        return ticks;
    }
    for (int k = first - 1; k <= last; ++k) {
        for (const double factor : {1.0, 2.0, 5.0}) {
            const double tick = factor * std::pow(10.0, k);
            if (tick >= low * (1 - kTickSlack) && tick <= high * (1 + kTickSlack)) {
                ticks.push_back(tick);
            }
        }
    }
    return ticks;
}

std::vector<std::string> tick_labels(const std::vector<double>& ticks, AxisScale kind) {
    std::vector<std::string> labels;
    if (kind == AxisScale::logarithmic && !ticks.empty() && are_large_powers(ticks)) {
        for (const double tick : ticks) {
            labels.push_back(format_power_of_ten(int(std::lround(std::log10(tick)))));
        }
        return labels;
    }
    double step = 1;
    double largest = 0;
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        largest = std::max(largest, std::abs(ticks[i]));
        if (i > 0) step = ticks[i] - ticks[i - 1];
    }
    for (const double tick : ticks) {
        if (kind == AxisScale::logarithmic || largest >= 1e5 || step < 1e-4) {
            labels.push_back(format_number(tick, 1));
        } else {
            const int decimals = std::max(0, -int(std::floor(std::log10(step) + kTickSlack)));
            const std::string text = fmt::format("{:.{}f}", std::abs(tick), decimals);
            labels.push_back(tick < 0 ? "\u2212" + text : text);
        }
    }
    return labels;
}

std::string svg_plot(const Plot& plot) {
    const Scale x = scale_of(plot, true);
    const Scale y = scale_of(plot, false);
    std::string curves;
    for (const PlotSeries& series : plot.series) curves += draw_series(series, x, y);
    if (curves.empty()) return "";
    return fmt::format(
        "<svg role=\"img\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
        "aria-label=\"{2}\">{3}{4}{5}</svg>\n",
        plot.width,
        plot.height,
        escape_html(plot.title + ": " + plot.y_axis.label + " over " + plot.x_axis.label),
        draw_axes(plot, x, y),
        draw_marks(plot, x, y),
        curves);
}

std::string plot_legend(const std::vector<PlotSeries>& series) {
    std::string html = "<ul class=\"legend\">";
    for (const PlotSeries& entry : series) {
        html += fmt::format(
            "<li><svg width=\"26\" height=\"10\" viewBox=\"0 0 26 10\" aria-hidden=\"true\">"
            "<path class=\"curve{}\" style=\"stroke:var(--series-{})\" d=\"M1 "
            "5H25\"/></svg>{}</li>",
            entry.is_dashed ? " dashed" : "",
            entry.color,
            escape_html(entry.label));
    }
    return html + "</ul>\n";
}

}  // namespace patina
