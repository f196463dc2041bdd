#include "patina/export/picture_grid.h"

#include "patina/export/html_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patina {
namespace {

constexpr double kMapShare = 0.6;         // of the largest width of a picture
constexpr double kMinPictureWidth = 180;  // a colour bar fits into it [pixels]

// How many pixels of the map have each label.
std::vector<std::size_t> count_labels(const std::vector<ShareLabel>& labels, const Image& map) {
    std::vector<std::size_t> counts(labels.size(), 0);
    for (const float value : map.data) {
        for (std::size_t k = 0; k < labels.size(); ++k) {
            if (std::lround(value) == labels[k].value) ++counts[k];
        }
    }
    return counts;
}

}  // namespace

Color sequential(double low, double high) {
    return [=](double value) { return sequential_color((value - low) / (high - low)); };
}

std::string head_cell(std::string_view title, std::string_view note) {
    return fmt::format(
        "<div class=\"head\">{}<small>{}</small></div>", escape_html(title), escape_html(note));
}

std::string name_cell(std::string_view name, std::string_view note) {
    return fmt::format(
        "<div class=\"name\">{}<small>{}</small></div>", escape_html(name), escape_html(note));
}

int map_width(int max_picture_width) { return std::max(1, int(kMapShare * max_picture_width)); }

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

std::string share_bars(const std::vector<ShareLabel>& labels,
                       const std::vector<LabelledMap>& maps) {
    std::vector<std::vector<std::size_t>> counts;
    std::vector<bool> is_shown(labels.size(), false);
    for (const LabelledMap& map : maps) {
        counts.push_back(count_labels(labels, *map.map));
        for (std::size_t k = 0; k < labels.size(); ++k) {
            if (counts.back()[k] > 0) is_shown[k] = true;
        }
    }
    std::vector<std::size_t> totals;
    for (const auto& of_map : counts) {
        totals.push_back(std::accumulate(of_map.begin(), of_map.end(), std::size_t(0)));
    }
    HtmlTable table;
    table.columns = {""};
    table.rows = {{{"texels on the surface"}}};
    std::string bars;
    for (std::size_t m = 0; m < maps.size(); ++m) {
        if (totals[m] == 0) continue;
        table.columns.push_back(maps[m].name);
        table.rows.front().cells.push_back(format_number(double(totals[m])));
        std::string bar;
        for (std::size_t k = 0; k < labels.size(); ++k) {
            if (counts[m][k] == 0) continue;
            bar += fmt::format("<i style=\"width:{:.2f}%;background:{}\"></i>",
                               100 * double(counts[m][k]) / double(totals[m]),
                               css_color(labels[k].color));
        }
        bars += "<div class=\"stack\">" + bar + "</div>";
    }
    if (bars.empty()) return "";
    std::string legend = "<ul class=\"legend\">";
    for (std::size_t k = 0; k < labels.size(); ++k) {
        if (!is_shown[k]) continue;
        legend += fmt::format("<li><span class=\"swatch\" style=\"background:{}\"></span>{}</li>",
                              css_color(labels[k].color),
                              escape_html(labels[k].words));
        std::vector<std::string> cells = {labels[k].words};
        for (std::size_t m = 0; m < maps.size(); ++m) {
            if (totals[m] == 0) continue;
            cells.push_back(format_percent(double(counts[m][k]) / double(totals[m])));
        }
        table.rows.push_back({std::move(cells)});
    }
    return legend + "</ul>" + bars + html_table(table);
}

}  // namespace patina
