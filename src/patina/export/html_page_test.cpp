#include "patina/export/html_page.h"

#include "patina/export/page_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace patina {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(NestingError, SeesWhatIsNotClosed) {
    EXPECT_EQ(nesting_error("<!DOCTYPE html><p a=\"1 > 0\">x<br><b>y</b><line x=\"1\"/></p>"), "");
    EXPECT_NE(nesting_error("<p><b></p></b>"), "");
    EXPECT_NE(nesting_error("<p>"), "");
    EXPECT_NE(nesting_error("</p>"), "");
    EXPECT_NE(nesting_error("<p"), "");
    EXPECT_NE(nesting_error("<p title=\"<b>\"></p>"), "");
}

TEST(EscapeHtml, LeavesNoMarkup) {
    EXPECT_EQ(escape_html("<a href=\"x\">R&D's</a>"),
              "&lt;a href=&quot;x&quot;&gt;R&amp;D&#39;s&lt;/a&gt;");
    EXPECT_EQ(escape_html("σ plain"), "σ plain");
}

TEST(FormatNumber, RoundsToSignificantDigits) {
    EXPECT_EQ(format_number(0), "0");
    EXPECT_EQ(format_number(0.51234), "0.512");
    EXPECT_EQ(format_number(12.345), "12.3");
    EXPECT_EQ(format_number(-0.0123456), "\u22120.0123");
    EXPECT_EQ(format_number(9.999), "10.0");
    EXPECT_EQ(format_number(12345.6), "12\u202f346");
    EXPECT_EQ(format_number(2000000), "2\u202f000\u202f000");
    EXPECT_EQ(format_number(1234), "1234");
    EXPECT_EQ(format_number(0.000123456), "1.23×10⁻⁴");
    EXPECT_EQ(format_number(2.5e12, 2), "2.5×10¹²");
    EXPECT_EQ(format_number(0.25, 1), "0.2");
    EXPECT_EQ(format_number(std::numeric_limits<double>::infinity()), "\u2013");
    EXPECT_EQ(format_number(std::numeric_limits<double>::quiet_NaN()), "\u2013");
}

TEST(FormatPercent, HasOneDecimalAndASignOnRequest) {
    EXPECT_EQ(format_percent(0.1234), "12.3\u202f%");
    EXPECT_EQ(format_percent(0.1234, true), "+12.3\u202f%");
    EXPECT_EQ(format_percent(-0.5), "\u221250.0\u202f%");
}

TEST(FormatSeconds, TurnsToMinutes) {
    EXPECT_EQ(format_seconds(0.4231), "0.423\u202fs");
    EXPECT_EQ(format_seconds(59.94), "59.9\u202fs");
    EXPECT_EQ(format_seconds(200.2), "3\u202fmin 20\u202fs");
}

TEST(HtmlTable, EscapesItsCellsAndSpansItsHeadings) {
    HtmlTable table;
    table.groups = {{"", 1}, {"A & B", 2}};
    table.columns = {"name", "<x>", "y"};
    table.rows = {{{"part"}, true}, {{"<script>", "1", "2"}, false, true}};
    const std::string html = html_table(table);
    EXPECT_EQ(nesting_error(html), "");
    EXPECT_THAT(html, HasSubstr("A &amp; B"));
    EXPECT_THAT(html, HasSubstr("&lt;script&gt;"));
    EXPECT_THAT(html, Not(HasSubstr("<script>")));
    EXPECT_THAT(html, HasSubstr("<th colspan=\"3\" scope=\"rowgroup\">part</th>"));
    EXPECT_THAT(html, HasSubstr("<td class=\"start\">1</td><td>2</td>"));
}

TEST(HtmlDocument, LinksToEachSection) {
    const std::string html = html_document(
        "A & B", "<h1>A</h1>", {{"one", "First", "<p>1</p>"}, {"two", "Second", "<p>2</p>"}});
    EXPECT_EQ(nesting_error(html), "");
    EXPECT_THAT(html, HasSubstr("<title>A &amp; B</title>"));
    EXPECT_THAT(html, HasSubstr("<a href=\"#two\">Second</a>"));
    EXPECT_THAT(html, HasSubstr("<section id=\"two\">"));
    EXPECT_THAT(html, HasSubstr("prefers-color-scheme: dark"));
}

}  // namespace
}  // namespace patina
