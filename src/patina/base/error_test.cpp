#include "patina/base/error.h"

#include <gtest/gtest.h>

#include <string>

namespace patina {
namespace {

TEST(Error, SaysWhereWhatAndWhatWasExpected) {
    EXPECT_EQ(std::string(Error("a.json", "b[1].c", "is 3", "a text").what()),
              "a.json: b[1].c: is 3 (expected a text)");
    EXPECT_EQ(std::string(Error("a.json", "", "is empty", "").what()), "a.json: is empty");
}

TEST(Error, IsOneLineWhateverTheFileHolds) {
    EXPECT_EQ(std::string(Error("a\nb", "c\r", "has '\x1b[31m\x7f'", "\xc3\xa9\t").what()),
              "a?b: c?: has '?[31m?' (expected \xc3\xa9?)");
}

}  // namespace
}  // namespace patina
