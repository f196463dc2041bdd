// The sections of the report that are pictures: Figure 6, and the maps.
#include "patina/export/picture_grid.h"
#include "patina/export/report_parts.h"
#include "patina/math/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

constexpr double kWhiteLevel = 255;
// Colour bars end at this quantile of what they show, so that a few texels do not set them.
constexpr double kRangeShare = 0.98;
// Differences below this many levels are not stretched to full colour.
constexpr double kMinDifferenceLimit = 2;
constexpr double kPdErrorLimit = 0.25;
// On the page [pixels].
constexpr double kMaxImageHeight = 300;

Color diverging(double limit) {
    return [=](double value) { return diverging_color(value / limit); };
}

Rgb grey(double value) { return Rgb::Constant(srgb_from_linear(value)); }

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
    const std::vector<ShareLabel> labels = {{1, "all measured", status_color(1)},
                                            {2, "Pd measured, lobe filled", status_color(2)},
                                            {3, "never usefully observed", status_color(3)}};
    std::vector<LabelledMap> maps;
    for (const MethodReport& method : object.methods) {
        maps.push_back({method_label(method.method), &method.maps.status});
    }
    return share_bars(labels, maps);
}

std::string maps_figure(const ReportData& data, const ObjectReport& object) {
    const bool any = std::any_of(object.methods.begin(),
                                 object.methods.end(),
                                 [](const MethodReport& m) { return !m.maps.diffuse.empty(); });
    if (!any) return "";
    const ReportMaps& reference = object.truth ? *object.truth : object.methods.back().maps;
    const PixelMask mask = status_mask(reference, 1, 3);
    MapScales scales;
    scales.width = map_width(data.max_picture_width);
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
