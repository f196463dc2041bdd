// The sections of the report on how sure the maps are: standard errors, what could be measured and
// why not, and the absolute scale.
#include "patina/export/picture_grid.h"
#include "patina/export/report_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace patina {
namespace {

// Where the colours of relative errors end: the same for all objects, so that they compare.
constexpr double kDiffuseLimit = 0.1;
constexpr double kLobeLimit = 0.5;

// Mean of the first channels of the error over that of the value; +infinity where the value is 0.
Image relative(const Image& error, const Image& value, int channels) {
    Image result(error.width, error.height, 1);
    for (int y = 0; y < result.height; ++y) {
        for (int x = 0; x < result.width; ++x) {
            float errors = 0;
            float values = 0;
            for (int c = 0; c < channels; ++c) {
                errors += error.at(x, y, c);
                values += value.at(x, y, c);
            }
            result.at(x, y) = values > 0 ? errors / values : std::numeric_limits<float>::infinity();
        }
    }
    return result;
}

Image channel_of(const Image& image, int channel) {
    Image result(image.width, image.height, 1);
    for (int y = 0; y < result.height; ++y) {
        for (int x = 0; x < result.width; ++x) result.at(x, y) = image.at(x, y, channel);
    }
    return result;
}

bool has_certainty(const MethodReport& method) {
    const CertaintyMaps& maps = method.certainty;
    return !maps.diffuse_stderr.empty() && !maps.specular_stderr.empty() &&
           !maps.roughness_stderr.empty() && !maps.measurability.empty() && !maps.reason.empty();
}

// The last method that says how sure it is; null where none does.
const MethodReport* certain_method(const ObjectReport& object) {
    const auto found = std::find_if(object.methods.rbegin(), object.methods.rend(), has_certainty);
    return found == object.methods.rend() ? nullptr : &*found;
}

std::string reason_bars(const ObjectReport& object) {
    std::vector<ShareLabel> labels;
    for (const LobeReason reason : kLobeReasons) {
        if (reason == LobeReason::off_surface) continue;
        labels.push_back({int(reason), lobe_reason_words(reason), lobe_reason_color(reason)});
    }
    std::vector<LabelledMap> maps;
    for (const MethodReport& method : object.methods) {
        maps.push_back({method_label(method.method), &method.certainty.reason});
    }
    return share_bars(labels, maps);
}

std::string certainty_figure(const ReportData& data, const ObjectReport& object) {
    const MethodReport* const method = certain_method(object);
    if (method == nullptr) return "";
    const CertaintyMaps& maps = method->certainty;
    const int width = map_width(data.max_picture_width);
    const PixelMask surface = status_mask(method->maps, 1, 3);
    const auto cell = [&](const Image& image, double limit, const std::string& what) {
        return picture_html(colored_image(reduce({image, surface}, width), sequential(0, limit)),
                            what + " of " + object.title);
    };
    const auto bar = [](double limit, const std::string& label) {
        return "<div>" + color_bar(0, 100 * limit, label, sequential(0, 100 * limit)) + "</div>";
    };
    const auto reason_color = [](double value) {
        return lobe_reason_color(LobeReason(int(std::lround(value))));
    };
    std::string cells = "<div></div>" + bar(kDiffuseLimit, "Pd [%]") + bar(kLobeLimit, "Ps [%]") +
                        bar(kLobeLimit, "σ [%]");
    cells += name_cell("Standard error", "relative to the map");
    cells += cell(relative(maps.diffuse_stderr, method->maps.diffuse, 3), kDiffuseLimit, "sd(Pd)");
    cells += cell(relative(maps.specular_stderr, method->maps.specular, 1), kLobeLimit, "sd(Ps)");
    cells +=
        cell(relative(maps.roughness_stderr, method->maps.roughness, 1), kLobeLimit, "sd(sigma)");
    cells += name_cell("Measurable", "error that the looks allow");
    cells += cell(channel_of(maps.measurability, 0), kDiffuseLimit, "measurability of Pd");
    cells += cell(channel_of(maps.measurability, 1), kLobeLimit, "measurability of Ps");
    cells += cell(channel_of(maps.measurability, 2), kLobeLimit, "measurability of sigma");
    cells += name_cell("Lobe", "why it is measured or not: legend below");
    cells += picture_html(colored_image({reduce_labels(maps.reason, width), {}}, reason_color),
                          "reasons of " + object.title);
    const std::string misfit =
        method->lobe_misfit > 1
            ? " Lobes are of another shape than the model's: left-out looks into the highlights "
              "differ more from their prediction than errors say, and those of Ps and \u03c3 are "
              "enlarged " +
                  format_number(method->lobe_misfit, 2) + " times."
            : "";
    return html_figure(
        picture_grid(3, maps.reason, kMaxMapHeight, cells) + reason_bars(object),
        "Maps of " + method_label(method->method) +
            ". Standard errors hold everything that is reckoned with, also that of filled lobes. "
            "Measurable: from the geometry and the noise of the looks alone, Ps with \u03c3 given, "
            "\u03c3 with nothing given; the lightest colour stands for all that is worse. Shares "
            "of the reasons for every method." +
            misfit);
}

}  // namespace

std::string certainty_section(const ReportData& data) {
    std::string html;
    for (const ObjectReport& object : data.objects) {
        const std::string figure = certainty_figure(data, object);
        if (!figure.empty()) html += object_heading(object) + figure;
    }
    return html;
}

std::string scale_section(const ReportData& data) {
    HtmlTable table;
    table.columns = {"Object", "method", "lamps over stated", "standard error", "told"};
    for (const ObjectReport& object : data.objects) {
        for (const MethodReport& method : object.methods) {
            if (!method.scale) continue;
            const ScaleEstimate& scale = *method.scale;
            table.rows.push_back(
                {{capitalized(object.title),
                  method_label(method.method),
                  format_number(scale.told ? scale.factor : scale.best_factor, 4),
                  std::isfinite(scale.standard_error) ? format_percent(scale.standard_error)
                                                      : "\u2013",
                  scale.told ? "yes" : "no: " + scale.reason}});
        }
    }
    if (table.rows.empty()) return "";
    return html_figure(html_table(table),
                       "How strong the lamps are, told from the bounced light, and its relative "
                       "standard error, which those of Pd and Ps include. Where it is not told, Pd "
                       "and Ps are known up to one common factor.");
}

}  // namespace patina
