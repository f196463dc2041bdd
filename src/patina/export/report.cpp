#include "patina/export/report.h"

#include "patina/base/output_file.h"
#include "patina/export/report_parts.h"

#include <fmt/format.h>

namespace patina {
namespace {

std::string fact(const std::string& name, const std::string& value_html) {
    return "<div><dt>" + escape_html(name) + "</dt><dd>" + value_html + "</dd></div>";
}

std::string header_html(const RunHeader& run) {
    std::string html =
        "<p class=\"eyebrow\">patina report</p>\n<h1>" + escape_html(run.title) + "</h1>\n";
    if (!run.summary.empty()) html += "<p class=\"lead\">" + escape_html(run.summary) + "</p>\n";
    html += "<dl class=\"facts\">";
    if (!run.command.empty())
        html += fact("Command", "<code>" + escape_html(run.command) + "</code>");
    html += fact("Version", escape_html(run.version));
    html += fact("Seed", fmt::format("{}", run.seed));
    html += "</dl>\n";
    if (run.settings.empty()) return html;
    html += "<details><summary>All settings</summary><dl class=\"facts\">";
    for (const auto& [name, value] : run.settings) html += fact(name, escape_html(value));
    return html + "</dl></details>\n";
}

}  // namespace

std::string report_page(const ReportData& data) {
    const bool paper = data.paper_experiments;
    std::vector<HtmlSection> sections;
    const auto add = [&](const char* id, const char* title, std::string body) {
        if (!body.empty()) sections.push_back({id, title, std::move(body)});
    };
    add("glance", "At a glance", glance_section(data));
    add("differences",
        paper ? "Table 1: real and synthetic images" : "Real and synthetic images",
        differences_section(data));
    add("profiles", paper ? "Figure 5: profiles of Pd" : "Profiles of Pd", profile_section(data));
    add("images", paper ? "Figure 6: what is left" : "What is left", images_section(data));
    add("lamps", paper ? "Figure 4(d): lamp positions" : "Lamp positions", selection_section(data));
    add("maps", "Maps", maps_section(data));
    add("certainty", "How sure the maps are", certainty_section(data));
    add("scale", "Absolute scale", scale_section(data));
    add("truth", "Against the truth", truth_section(data));
    add("convergence", "Convergence", convergence_section(data));
    add("times", "Time", times_section(data));
    return html_document(data.run.title, header_html(data.run), sections);
}

void write_report(const std::filesystem::path& path, const ReportData& data) {
    write_file(path, report_page(data));
}

}  // namespace patina
