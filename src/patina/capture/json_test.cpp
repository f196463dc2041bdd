#include "patina/capture/json.h"

#include "patina/base/error.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace patina {
namespace {

std::string parse_and_write(const std::string& text) { return to_text(parse_json(text, "f.json")); }

TEST(Json, KeepsTheOrderOfFields) {
    EXPECT_EQ(parse_and_write(R"({"b": 1, "a": {"d": [], "c": [1, "x", null, true]}})"),
              "{\n  \"b\": 1,\n  \"a\": {\n    \"d\": [],\n    \"c\": [1, \"x\", null, true]\n  "
              "}\n}\n");
}

TEST(Json, WritesListsOfObjectsOverSeveralLines) {
    EXPECT_EQ(parse_and_write(R"([{"a": 1}, {}])"), "[\n  {\n    \"a\": 1\n  },\n  {}\n]\n");
}

TEST(Json, ReadsBackEveryDouble) {
    for (const double value : {0.1,
                               1.0 / 3,
                               -2.5e-300,
                               std::numeric_limits<double>::max(),
                               std::numeric_limits<double>::denorm_min(),
                               123456789.123456789}) {
        EXPECT_EQ(parse_json(to_text(Json(value)), "f.json").number, value);
    }
}

TEST(Json, TellsIntegersFromNumbers) {
    EXPECT_EQ(parse_json("4", "f.json").kind, JsonKind::integer);
    EXPECT_EQ(parse_json("4.0", "f.json").kind, JsonKind::number);
    EXPECT_EQ(parse_json("18446744073709551615", "f.json").kind, JsonKind::number);
}

TEST(Json, EscapesTextOnOneLine) {
    const std::string text = "a\"b\\c\nd\te\x01";
    EXPECT_EQ(quote(text), R"("a\"b\\c\nd\u0009e\u0001")");
    EXPECT_EQ(parse_json(quote(text), "f.json").text, text);
}

TEST(Json, QuotesNamesThatWouldBlurAPath) {
    EXPECT_EQ(field_path("lights[2]", "intensity"), "lights[2].intensity");
    EXPECT_EQ(field_path("", "x y\n"), R"(["x y\n"])");
}

TEST(Json, RefusesBrokenUtf8) {
    EXPECT_THROW(static_cast<void>(parse_json("\"\xff\"", "f.json")), Error);
}

}  // namespace
}  // namespace patina
