#include "patina/export/html_page.h"

#include "patina/export/html_style.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace patina {
namespace {

constexpr const char* kThinSpace = "\u202f";
constexpr const char* kMinus = "\u2212";
constexpr const char* kMissing = "\u2013";
constexpr double kSmallest = 1e-3;
constexpr double kLargest = 1e7;
// Tables of more columns are set closer.
constexpr std::size_t kMaxWideColumns = 10;

// digits: of a whole number without sign.
std::string group_thousands(const std::string& digits) {
    if (digits.size() <= 4) return digits;
    std::string text;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) text += kThinSpace;
        text += digits[i];
    }
    return text;
}

// Of a magnitude in [kSmallest, kLargest).
std::string format_plain(double magnitude, int digits) {
    // Of the rounded value: 9.999 is 10.0 in three digits.
    const std::string rounded = fmt::format("{:.{}e}", magnitude, digits - 1);
    const int exponent = std::atoi(rounded.c_str() + rounded.find('e') + 1);
    const int decimals = std::max(0, digits - 1 - exponent);
    const std::string text = fmt::format("{:.{}f}", magnitude, decimals);
    return decimals == 0 ? group_thousands(text) : text;
}

std::string format_power(double magnitude, int digits) {
    const std::string text = fmt::format("{:.{}e}", magnitude, digits - 1);
    const std::size_t e = text.find('e');
    return text.substr(0, e) + "×" + format_power_of_ten(std::atoi(text.c_str() + e + 1));
}

std::string table_head(const HtmlTable& table) {
    std::string html = "<thead>";
    if (!table.groups.empty()) {
        html += "<tr class=\"groups\">";
        for (const auto& [title, span] : table.groups) {
            html += fmt::format(
                "<th colspan=\"{}\" scope=\"colgroup\">{}</th>", span, escape_html(title));
        }
        html += "</tr>";
    }
    html += "<tr>";
    for (const std::string& column : table.columns) {
        html += "<th scope=\"col\">" + escape_html(column) + "</th>";
    }
    return html + "</tr></thead>";
}

// Whether each column is the first of a group, which a line sets apart.
std::vector<bool> group_starts(const HtmlTable& table) {
    std::vector<bool> starts(table.columns.size(), false);
    std::size_t column = 0;
    for (const auto& [title, span] : table.groups) {
        if (column > 0 && column < starts.size()) starts[column] = true;
        column += std::size_t(span);
    }
    return starts;
}

std::string table_row(const HtmlTable::Row& row, const std::vector<bool>& starts_group) {
    if (row.is_heading) {
        return fmt::format(
            "<tr class=\"heading\"><th colspan=\"{}\" scope=\"rowgroup\">{}</th></tr>",
            starts_group.size(),
            escape_html(row.cells.front()));
    }
    std::string html = row.is_strong ? "<tr class=\"strong\">" : "<tr>";
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
        const std::string text = escape_html(row.cells[i]);
        if (i == 0) {
            html += "<th scope=\"row\">" + text + "</th>";
        } else {
            html += (starts_group[i] ? "<td class=\"start\">" : "<td>") + text + "</td>";
        }
    }
    return html + "</tr>";
}

}  // namespace

std::string escape_html(std::string_view text) {
    std::string escaped;
    for (const char c : text) {
        switch (c) {
            case '&':
                escaped += "&amp;";
                break;
            case '<':
                escaped += "&lt;";
                break;
            case '>':
                escaped += "&gt;";
                break;
            case '"':
                escaped += "&quot;";
                break;
            case '\'':
                escaped += "&#39;";
                break;
            default:
                escaped += c;
        }
    }
    return escaped;
}

std::string format_number(double value, int digits) {
    if (!std::isfinite(value)) return kMissing;
    const double magnitude = std::abs(value);
    const bool plain = magnitude == 0 || (magnitude >= kSmallest && magnitude < kLargest);
    const std::string text = magnitude == 0 ? "0"
                             : plain        ? format_plain(magnitude, digits)
                                            : format_power(magnitude, digits);
    return value < 0 ? kMinus + text : text;
}

std::string format_power_of_ten(int exponent) {
    static constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = "10";
    for (const char c : std::to_string(exponent)) text += c == '-' ? "⁻" : kDigits[c - '0'];
    return text;
}

std::string format_percent(double share, bool with_sign) {
    if (!std::isfinite(share)) return kMissing;
    const std::string text = fmt::format("{:.1f}{}%", std::abs(100 * share), kThinSpace);
    if (share < 0) return kMinus + text;
    return with_sign ? "+" + text : text;
}

std::string format_seconds(double seconds) {
    if (seconds < 60) return format_number(seconds) + kThinSpace + "s";
    const long whole = std::lround(seconds);
    return fmt::format("{0}{2}min {1}{2}s", whole / 60, whole % 60, kThinSpace);
}

std::string html_table(const HtmlTable& table) {
    const char* begin =
        table.columns.size() > kMaxWideColumns ? "<table class=\"dense\">" : "<table>";
    std::string html = "<div class=\"scroll\">" + (begin + table_head(table)) + "<tbody>";
    const std::vector<bool> starts_group = group_starts(table);
    for (const HtmlTable::Row& row : table.rows) html += table_row(row, starts_group);
    return html + "</tbody></table></div>\n";
}

std::string html_figure(const std::string& body, std::string_view caption) {
    return "<figure>" + body + "<figcaption>" + escape_html(caption) + "</figcaption></figure>\n";
}

std::string html_document(std::string_view title,
                          const std::string& header,
                          const std::vector<HtmlSection>& sections) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
        escape_html(title) + "</title>\n<style>" + kPageStyle + "</style>\n</head>\n<body>\n" +
        "<header>" + header + "</header>\n";
    if (sections.size() > 1) {
        html += "<nav aria-label=\"Sections\">";
        for (const HtmlSection& section : sections) {
            html += fmt::format("<a href=\"#{}\">{}</a> ", section.id, escape_html(section.title));
        }
        html += "</nav>\n";
    }
    html += "<main>\n";
    for (const HtmlSection& section : sections) {
        html += fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n",
                            section.id,
                            escape_html(section.title),
                            section.body);
    }
    return html + "</main>\n</body>\n</html>\n";
}

}  // namespace patina
