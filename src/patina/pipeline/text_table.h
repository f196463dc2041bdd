// Plain text tables for a terminal: columns as wide as their widest cell.
#pragma once

#include <string>
#include <vector>

namespace patina {

class TextTable {
  public:
    // The head of every column; a table whose heads are all empty is printed without a head. The
    // first column is set to the left, the others to the right where their head begins with a
    // space.
    explicit TextTable(std::vector<std::string> head);

    // As many cells as the head has.
    void add(std::vector<std::string> cells);
    // One line per row, each ending in a line feed, without spaces at the end.
    [[nodiscard]] std::string text() const;

  private:
    std::vector<std::vector<std::string>> rows_;  // the first one is the head
};

}  // namespace patina
