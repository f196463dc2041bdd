// What the sections of the report share: names and colours of methods, and the sections themselves.
#pragma once

#include "patina/export/html_page.h"
#include "patina/export/picture.h"
#include "patina/export/report.h"

#include <string>

namespace patina {

// "Conventional II (diffuse)"; a method that we do not know goes by its own name.
[[nodiscard]] std::string method_label(const std::string& method);
// --series-N of the style sheet, the same for a method everywhere.
[[nodiscard]] int method_color(const std::string& method);

// With a capital first letter (ASCII).
[[nodiscard]] std::string capitalized(std::string text);
// The heading of an object's part of a section.
[[nodiscard]] std::string object_heading(const ObjectReport& object);

// How a caption begins: "The paper's Figure 6. " in a report on the paper's experiments, else "".
[[nodiscard]] std::string figure_name(const ReportData& data, const std::string& name);

// Pixels of these status values; empty (all) when the maps have no status.
[[nodiscard]] PixelMask status_mask(const ReportMaps& maps, int low, int high);

// The method of that name; null where there is none.
[[nodiscard]] const MethodReport* find_method(const ObjectReport& object,
                                              const std::string& method);

// The sections, each empty when no object has the data for it.
[[nodiscard]] std::string glance_section(const ReportData& data);
[[nodiscard]] std::string differences_section(const ReportData& data);
[[nodiscard]] std::string truth_section(const ReportData& data);
[[nodiscard]] std::string profile_section(const ReportData& data);
[[nodiscard]] std::string images_section(const ReportData& data);
[[nodiscard]] std::string selection_section(const ReportData& data);
[[nodiscard]] std::string maps_section(const ReportData& data);
[[nodiscard]] std::string certainty_section(const ReportData& data);
[[nodiscard]] std::string scale_section(const ReportData& data);
[[nodiscard]] std::string convergence_section(const ReportData& data);
[[nodiscard]] std::string times_section(const ReportData& data);

}  // namespace patina
