#include "patina/export/paper_table.h"

#include <array>

namespace patina {
namespace {

struct PaperRow {
    const char* object;
    const char* method;
    PaperDifference difference;
};
constexpr std::array<PaperRow, 4> kPaperTable1 = {{{"B", "diffuse", {8.7, 493.3}},
                                                   {"B", "photon", {0.51, 3.2}},
                                                   {"C", "diffuse", {13.3, 375.2}},
                                                   {"C", "photon", {0.92, 9.8}}}};

}  // namespace

std::optional<PaperDifference> paper_table_1(const std::string& object, const std::string& method) {
    for (const PaperRow& row : kPaperTable1) {
        if (row.object == object && row.method == method) return row.difference;
    }
    return std::nullopt;
}

}  // namespace patina
