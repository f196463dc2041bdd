#include "patina/pipeline/text_table.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(TextTable, SetsNumbersToTheRight) {
    TextTable table({"name", " count"});
    table.add({"a", "1"});
    table.add({"longer", "100"});
    EXPECT_EQ(table.text(),
              "name     count\n"
              "a            1\n"
              "longer     100\n");
}

TEST(TextTable, PrintsNoEmptyHead) {
    TextTable table({"", ""});
    table.add({"name", "vase"});
    table.add({"texels", ""});
    EXPECT_EQ(table.text(),
              "name    vase\n"
              "texels\n");
}

}  // namespace
}  // namespace patina
