// The blocks that pages are built from: escaped text, rounded numbers, tables, figures, and the
// document with its styles inside. No network, no scripts.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace patina {

// Text for HTML and SVG, also inside quoted attributes.
[[nodiscard]] std::string escape_html(std::string_view text);

// Rounded to so many significant digits, whole numbers in full with thin spaces between thousands,
// powers of ten below 0.001 and from 10 million on; an en dash for what is not finite. digits:
// >= 1.
[[nodiscard]] std::string format_number(double value, int digits = 3);
// "10⁻⁴".
[[nodiscard]] std::string format_power_of_ten(int exponent);
// A share as per cent with one decimal and a sign where asked for: "12.3 %".
[[nodiscard]] std::string format_percent(double share, bool with_sign = false);
// Wall time: "0.42 s", "12.3 s", "3 min 20 s".
[[nodiscard]] std::string format_seconds(double seconds);

// A table of plain text; everything is escaped. The first column is left-aligned, others right.
struct HtmlTable {
    struct Row {
        std::vector<std::string> cells;  // as many as columns; of a heading only the first
        bool is_heading = false;         // spans the table
        bool is_strong = false;          // the row that the reader should look at first
    };
    std::vector<std::pair<std::string, int>> groups;  // title and columns spanned, above columns
    std::vector<std::string> columns;
    std::vector<Row> rows;
};
[[nodiscard]] std::string html_table(const HtmlTable& table);

// body: HTML. caption: plain text that says what to see.
[[nodiscard]] std::string html_figure(const std::string& body, std::string_view caption);

// id: for links, of letters, digits and hyphens. body: HTML.
struct HtmlSection {
    std::string id;
    std::string title;
    std::string body;
};

// The document: header (HTML), a line of links to the sections, the sections.
[[nodiscard]] std::string html_document(std::string_view title,
                                        const std::string& header,
                                        const std::vector<HtmlSection>& sections);

}  // namespace patina
