// The sections of the report that are pictures: Figure 6, and the maps.
#include "patina/export/report_parts.h"
#include "patina/math/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace patina {
namespace {

constexpr double kWhiteLevel = 255;
// Colour bars end at this quantile of what they show, so that a few texels do not set them.
constexpr double kRangeShare = 0.98;
// Differences below this many levels are not stretched to full colour.
constexpr double kMinDifferenceLimit = 2;
// Maps are drawn at this share of the largest width of a picture: there are many side by side.
constexpr double kMapShare = 0.6;
constexpr double kPdErrorLimit = 0.25;
// On the page [pixels]. A colour bar fits into the smallest width.
constexpr double kMaxImageHeight = 300;
constexpr double kMaxMapHeight = 200;
constexpr double kMinPictureWidth = 180;

using Color = std::function<Rgb(double)>;

Color sequential(double low, double high) {
    return [=](double value) { return sequential_color((value - low) / (high - low)); };
}

Color diverging(double limit) {
    return [=](double value) { return diverging_color(value / limit); };
}

Rgb grey(double value) { return Rgb::Constant(srgb_from_linear(value)); }

std::string head_cell(std::string_view title, std::string_view note) {
    return fmt::format(
        "<div class=\"head\">{}<small>{}</small></div>", escape_html(title), escape_html(note));
}

std::string name_cell(std::string_view name, std::string_view note = "") {
    return fmt::format(
        "<div class=\"name\">{}<small>{}</small></div>", escape_html(name), escape_html(note));
}

// A column of names and columns of pictures of this shape, none higher than max_height [pixels].
std::string picture_grid(int columns,
                         const Image& shape,
                         double max_height,
                         const std::string& cells) {
    return fmt::format(
        "<div class=\"pictures\" style=\"grid-template-columns:8.5rem "
        "repeat({},minmax(0,{:.0f}px))\">{}</div>\n",
        columns,
        std::max(kMinPictureWidth, max_height * shape.width / shape.height),
        cells);
}

// The largest value that a colour bar shows: a quantile over the mask's pixels, never 0.
double upper_range(const Image& image, const PixelMask& mask) {
    std::vector<double> values;
    for (std::size_t i = 0; i < image.data.size() / std::size_t(image.channels); ++i) {
        const double value = double(image.data[i * std::size_t(image.channels)]);
        if ((mask.empty() || mask[i] != 0) && std::isfinite(value)) {
            values.push_back(std::abs(value));
        }
    }
    const double high = values.empty() ? 0 : quantile(std::move(values), kRangeShare);
    return high > 0 ? high : 1;
}

bool same_size(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height;
}

// The mask where it belongs to images of this size, else all pixels.
PixelMask mask_for(const Image& image, const ReportMaps& maps, int low, int high) {
    return same_size(image, maps.status) ? status_mask(maps, low, high) : PixelMask();
}

// Mean over the channels of synthetic - real [levels].
Image level_difference(const Image& synthetic, const Image& real, double white) {
    Image difference(real.width, real.height, 1);
    const auto channels = std::size_t(real.channels);
    for (std::size_t i = 0; i < difference.data.size(); ++i) {
        double sum = 0;
        for (std::size_t c = 0; c < channels; ++c) {
            sum += double(synthetic.data[i * channels + c]) - double(real.data[i * channels + c]);
        }
        difference.data[i] = float(sum / double(channels) / white * kWhiteLevel);
    }
    return difference;
}

bool has_synthetic(const ObjectReport& object, const MethodReport& method) {
    return !method.synthetic.empty() && same_size(method.synthetic, object.real) &&
           method.synthetic.channels == object.real.channels;
}

std::string images_figure(const ReportData& data, const ObjectReport& object) {
    struct Row {
        const MethodReport* method;
        MaskedImage difference;
    };
    std::vector<Row> rows;
    double limit = kMinDifferenceLimit;
    for (const MethodReport& method : object.methods) {
        if (!has_synthetic(object, method)) continue;
        Row row{&method, {level_difference(method.synthetic, object.real, object.white), {}}};
        row.difference.mask = mask_for(object.real, method.maps, 1, 2);
        limit = std::max(limit, upper_range(row.difference.image, row.difference.mask));
        rows.push_back(std::move(row));
    }
    if (rows.empty()) return "";

    const int width = data.max_picture_width;
    const Color color = diverging(limit);
    const auto shown = [&](const Image& image, const MethodReport& method) {
        const PixelMask mask = mask_for(image, method.maps, 1, 3);
        return display_image(reduce({image, mask}, width), object.white);
    };
    std::string cells =
        name_cell("Real", object.real_title) +
        picture_html(shown(object.real, *rows.front().method), "real image of " + object.title) +
        "<div>" + color_bar(-limit, limit, "synthetic \u2212 real [levels]", color) + "</div>";
    for (const Row& row : rows) {
        const std::string label = method_label(row.method->method);
        cells += name_cell(label, "synthetic, and its difference from the real image");
        cells += picture_html(shown(row.method->synthetic, *row.method),
                              "synthetic image of " + object.title + ", " + label);
        cells += picture_html(colored_image(reduce(row.difference, width), color),
                              "difference of " + object.title + ", " + label);
    }
    return html_figure(picture_grid(2, object.real, kMaxImageHeight, cells),
                       figure_name(data, "Figure 6") +
                           "Blue where the synthetic image is too dark, red-brown where it is too "
                           "bright, one scale for all methods; grey where Pd is not measured. Look "
                           "at the creases: what is left there is bounced light that a method "
                           "does not know of. Images are shown with the sRGB curve.");
}

// Estimate over truth minus 1, mean over the channels.
Image relative_error(const Image& estimate, const Image& truth) {
    Image error(truth.width, truth.height, 1);
    for (std::size_t i = 0; i < error.data.size(); ++i) {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto of_truth = double(truth.data[3 * i + c]);
            if (of_truth > 0) sum += double(estimate.data[3 * i + c]) / of_truth - 1;
        }
        error.data[i] = float(sum / 3);
    }
    return error;
}

// What the pictures of one object's maps have in common.
struct MapScales {
    int width = 0;
    double specular_high = 1;
    double roughness_high = 1;
    const Image* truth_diffuse = nullptr;  // for the error of Pd; null: unknown
    std::string object;
};

std::string map_cell(const Image& image,
                     const PixelMask& mask,
                     const MapScales& scales,
                     const Color& color,
                     const std::string& what) {
    if (image.empty()) return "<div></div>";
    return picture_html(colored_image(reduce({image, mask}, scales.width), color),
                        what + " of " + scales.object);
}

std::string status_cell(const ReportMaps& maps, const MapScales& scales) {
    if (maps.status.empty()) return "<div></div>";
    const auto color = [](double status) { return status_color(int(std::lround(status))); };
    return picture_html(colored_image({reduce_labels(maps.status, scales.width), {}}, color),
                        "status of " + scales.object);
}

std::string map_row(const std::string& label,
                    const ReportMaps& maps,
                    const MapScales& scales,
                    bool is_truth) {
    const PixelMask mask = status_mask(maps, 1, 3);
    std::string cells = name_cell(label);
    cells += maps.diffuse.empty()
                 ? "<div></div>"
                 : picture_html(display_image(reduce({maps.diffuse, mask}, scales.width), 1),
                                "Pd of " + scales.object);
    if (scales.truth_diffuse != nullptr) {
        const bool known = !is_truth && same_size(maps.diffuse, *scales.truth_diffuse);
        cells += map_cell(known ? relative_error(maps.diffuse, *scales.truth_diffuse) : Image(),
                          status_mask(maps, 1, 2),
                          scales,
                          diverging(kPdErrorLimit),
                          "error of Pd");
    }
    cells += map_cell(maps.specular, mask, scales, sequential(0, scales.specular_high), "Ps");
    cells += map_cell(maps.roughness, mask, scales, sequential(0, scales.roughness_high), "sigma");
    return cells + (is_truth ? "<div></div>" : status_cell(maps, scales));
}

// Shares of the texels on the surface by status, as a bar and in numbers.
std::string status_bars(const ObjectReport& object) {
    static constexpr std::array<const char*, 4> kNames = {
        "", "all measured", "Pd measured, lobe filled", "never usefully observed"};
    HtmlTable table;
    table.columns = {"Texels", "on the surface", kNames[1], kNames[2], kNames[3]};
    std::string bars;
    for (const MethodReport& method : object.methods) {
        std::array<std::size_t, 4> counts = {};
        for (const float status : method.maps.status.data) {
            ++counts[std::size_t(std::clamp(int(std::lround(status)), 0, 3))];
        }
        const std::size_t total = counts[1] + counts[2] + counts[3];
        if (total == 0) continue;
        std::vector<std::string> cells = {method_label(method.method),
                                          format_number(double(total))};
        std::string bar;
        for (std::size_t k = 1; k < counts.size(); ++k) {
            const double share = double(counts[k]) / double(total);
            cells.push_back(format_percent(share));
            bar += fmt::format("<i style=\"width:{:.2f}%;background:{}\"></i>",
                               100 * share,
                               css_color(status_color(int(k))));
        }
        bars += "<div class=\"stack\">" + bar + "</div>";
        table.rows.push_back({std::move(cells)});
    }
    if (table.rows.empty()) return "";
    std::string legend = "<ul class=\"legend\">";
    for (std::size_t k = 1; k < kNames.size(); ++k) {
        legend += fmt::format("<li><span class=\"swatch\" style=\"background:{}\"></span>{}</li>",
                              css_color(status_color(int(k))),
                              kNames[k]);
    }
    return legend + "</ul>" + bars + html_table(table);
}

std::string maps_figure(const ReportData& data, const ObjectReport& object) {
    const bool any = std::any_of(object.methods.begin(),
                                 object.methods.end(),
                                 [](const MethodReport& m) { return !m.maps.diffuse.empty(); });
    if (!any) return "";
    const ReportMaps& reference = object.truth ? *object.truth : object.methods.back().maps;
    const PixelMask mask = status_mask(reference, 1, 3);
    MapScales scales;
    scales.width = std::max(1, int(kMapShare * data.max_picture_width));
    scales.object = object.title;
    if (!reference.specular.empty()) scales.specular_high = upper_range(reference.specular, mask);
    if (!reference.roughness.empty()) {
        scales.roughness_high = upper_range(reference.roughness, mask);
    }
    if (object.truth && !object.truth->diffuse.empty()) {
        scales.truth_diffuse = &object.truth->diffuse;
    }

    std::string cells = "<div></div><div>" + color_bar(0, 1, "Pd [-]", grey) + "</div>";
    if (scales.truth_diffuse != nullptr) {
        cells += "<div>" +
                 color_bar(-100 * kPdErrorLimit,
                           100 * kPdErrorLimit,
                           "error of Pd [%]",
                           diverging(100 * kPdErrorLimit)) +
                 "</div>";
    }
    cells += "<div>" +
             color_bar(0, scales.specular_high, "Ps [-]", sequential(0, scales.specular_high)) +
             "</div><div>" +
             color_bar(0, scales.roughness_high, "σ [rad]", sequential(0, scales.roughness_high)) +
             "</div>" + head_cell("Status", "legend below");
    if (object.truth) cells += map_row("Truth", *object.truth, scales, true);
    for (const MethodReport& method : object.methods) {
        cells += map_row(method_label(method.method), method.maps, scales, false);
    }
    const int columns = scales.truth_diffuse != nullptr ? 5 : 4;
    return html_figure(
        picture_grid(columns, reference.diffuse, kMaxMapHeight, cells) + status_bars(object),
        "Maps in the texel domain; grey is off the surface. Pd is shown as a colour with the sRGB "
        "curve, white is 1. Where the lobe is not measured, Ps and \u03c3 are filled from "
        "around.");
}

}  // namespace

std::string images_section(const ReportData& data) {
    std::string html;
    for (const ObjectReport& object : data.objects) {
        if (object.real.empty()) continue;
        const std::string figure = images_figure(data, object);
        if (!figure.empty()) html += object_heading(object) + figure;
    }
    return html;
}

std::string maps_section(const ReportData& data) {
    std::string html;
    for (const ObjectReport& object : data.objects) {
        const std::string figure = maps_figure(data, object);
        if (!figure.empty()) html += object_heading(object) + figure;
    }
    return html;
}

}  // namespace patina
