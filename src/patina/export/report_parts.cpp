#include "patina/export/report_parts.h"

#include <algorithm>
#include <array>

namespace patina {
namespace {

struct KnownMethod {
    const char* method;
    const char* label;
    int color;
};
constexpr std::array<KnownMethod, 4> kMethods = {{{"direct", "Conventional I (direct)", 1},
                                                  {"diffuse", "Conventional II (diffuse)", 2},
                                                  {"photon", "The paper\u2019s (photon)", 3},
                                                  {"gather", "Ours (gather)", 4}}};
constexpr int kOtherColor = 5;

const KnownMethod* known(const std::string& method) {
    const auto found = std::find_if(
        kMethods.begin(), kMethods.end(), [&](const KnownMethod& m) { return m.method == method; });
    return found == kMethods.end() ? nullptr : &*found;
}

}  // namespace

std::string method_label(const std::string& method) {
    const KnownMethod* found = known(method);
    return found != nullptr ? found->label : method;
}

int method_color(const std::string& method) {
    const KnownMethod* found = known(method);
    return found != nullptr ? found->color : kOtherColor;
}

std::string capitalized(std::string text) {
    if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = char(text[0] - 'a' + 'A');
    return text;
}

std::string object_heading(const ObjectReport& object) {
    return "<h3>" + escape_html(capitalized(object.title)) + "</h3>\n";
}

std::string figure_name(const ReportData& data, const std::string& name) {
    return data.paper_experiments ? "The paper\u2019s " + name + ". " : "";
}

PixelMask status_mask(const ReportMaps& maps, int low, int high) {
    PixelMask mask;
    for (const float status : maps.status.data) {
        mask.push_back(std::uint8_t(status >= float(low) && status <= float(high)));
    }
    return mask;
}

const MethodReport* find_method(const ObjectReport& object, const std::string& method) {
    const auto found = std::find_if(object.methods.begin(),
                                    object.methods.end(),
                                    [&](const MethodReport& m) { return m.method == method; });
    return found == object.methods.end() ? nullptr : &*found;
}

}  // namespace patina
