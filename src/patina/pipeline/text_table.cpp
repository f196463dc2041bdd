#include "patina/pipeline/text_table.h"

#include "patina/base/check.h"

#include <algorithm>

namespace patina {

TextTable::TextTable(std::vector<std::string> head) { rows_.push_back(std::move(head)); }

void TextTable::add(std::vector<std::string> cells) {
    PATINA_CHECK_EQ(cells.size(), rows_.front().size());
    rows_.push_back(std::move(cells));
}

std::string TextTable::text() const {
    const std::vector<std::string>& head = rows_.front();
    std::vector<std::size_t> widths(head.size(), 0);
    for (const auto& row : rows_) {
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    const bool has_head = std::any_of(
        head.begin(), head.end(), [](const std::string& cell) { return !cell.empty(); });
    std::string text;
    for (std::size_t r = has_head ? 0 : 1; r < rows_.size(); ++r) {
        std::string line;
        for (std::size_t i = 0; i < head.size(); ++i) {
            const std::string padding(widths[i] - rows_[r][i].size(), ' ');
            const bool to_the_right = !head[i].empty() && head[i].front() == ' ';
            line += to_the_right ? padding + rows_[r][i] : rows_[r][i] + padding;
            line += "  ";
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text;
}

}  // namespace patina
