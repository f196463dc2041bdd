#include "patina/pipeline/options.h"

#include "patina/math/types.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace patina {
namespace {

using testing::HasSubstr;

std::string error_of(const Option& option, const std::string& text) {
    try {
        option.set(text);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(Options, WriteWhatTheyAreSetTo) {
    int count = 3;
    const Option option = integer_option("max_bounces", count, between(1, 10), "bounces");
    EXPECT_EQ(option.flag(), "--max-bounces");
    EXPECT_EQ(option.default_text, "3");
    option.set("10");
    EXPECT_EQ(count, 10);
    EXPECT_EQ(option.get().integer, 10);
}

TEST(Options, RejectWhatIsOutOfRange) {
    int count = 3;
    const Option option = integer_option("max_bounces", count, between(1, 10), "bounces");
    EXPECT_EQ(error_of(option, "11"),
              R"(--max-bounces: is "11" (expected a whole number, 1 to 10))");
    EXPECT_EQ(count, 3);
}

TEST(Options, RejectWhatIsNoWholeNumber) {
    int count = 3;
    const Option option = integer_option("n", count, Range{}, "a number");
    for (const char* const text : {"", "x", "1.5", "1 ", " 1", "0x10", "99999999999999"}) {
        EXPECT_THAT(error_of(option, text), HasSubstr("(expected a whole number)")) << text;
    }
}

TEST(Options, TakeNoNumberBeyondWhatJsonKeepsExactly) {
    std::uint64_t seed = 1;
    const Option option = integer_option("seed", seed, at_least(0), "a seed");
    option.set("9007199254740992");
    EXPECT_EQ(option.get().integer, 9007199254740992);
    EXPECT_THAT(error_of(option, "9007199254740994"), HasSubstr("--seed"));
}

TEST(Options, RejectNumbersThatAreNotFinite) {
    double value = 0.5;
    const Option option = number_option("value", value, at_least(0), "", "a number");
    for (const char* const text : {"nan", "inf", "1e999", "-1", ""}) {
        EXPECT_EQ(error_of(option, text),
                  "--value: is " + quote(text) + " (expected a number, 0 or more)");
    }
    EXPECT_EQ(value, 0.5);
}

TEST(Options, KeepAnOpenLimitOut) {
    double value = 0.5;
    const Option option = number_option("value", value, above(0), "m", "a length");
    EXPECT_EQ(option.range, "above 0 m");
    EXPECT_NE(error_of(option, "0"), "");
    EXPECT_EQ(error_of(option, "1e-300"), "");
}

TEST(Options, TurnDegreesIntoRadians) {
    double angle = radians(80.0);
    const Option option = angle_option("max_view_angle", angle, between(0, 90), "an angle");
    EXPECT_EQ(option.default_text, "80");
    EXPECT_EQ(option.get().number, 80);
    option.set("45");
    EXPECT_DOUBLE_EQ(angle, kPi / 4);
}

enum class Fruit { apple, pear };

TEST(Options, ChooseByName) {
    Fruit fruit = Fruit::apple;
    const Choices<Fruit> choices = {
        {"apple", Fruit::apple}, {"pear", Fruit::pear}, {"plum", std::nullopt}};
    const Option option = choice_option("fruit", fruit, choices, "what to eat");
    EXPECT_EQ(option.value_name, "apple|pear|plum");
    EXPECT_EQ(option.default_text, "apple");
    option.set("pear");
    EXPECT_EQ(fruit, Fruit::pear);
    EXPECT_EQ(option.get().text, "pear");
    EXPECT_EQ(error_of(option, "nut"), R"(--fruit: is "nut" (expected apple or pear))");
    EXPECT_EQ(error_of(option, "plum"),
              R"(--fruit: is "plum", which follows in a later version (expected apple or pear))");
    EXPECT_EQ(fruit, Fruit::pear);
}

TEST(Options, GiveTheSettingsAloneToTheResult) {
    int count = 3;
    bool flag = true;
    std::filesystem::path path = "x";
    const OptionTable table = {path_option("output", "DIR", path, "a folder"),
                               integer_option("count", count, Range{}, "a count"),
                               flag_option("literal", flag, "a flag")};
    const Json settings = settings_of(table);
    EXPECT_EQ(settings.names, (std::vector<std::string>{"count", "literal"}));
    EXPECT_EQ(settings.find("count")->integer, 3);
    EXPECT_TRUE(settings.find("literal")->boolean);
}

TEST(Options, EscapeTheBarsOfATable) {
    Fruit fruit = Fruit::apple;
    const Choices<Fruit> choices = {{"apple", Fruit::apple}, {"pear", Fruit::pear}};
    const std::string text =
        options_markdown({choice_option("fruit", fruit, choices, "what to eat")});
    EXPECT_THAT(text, HasSubstr(R"(| `--fruit apple\|pear` |  | apple | what to eat |)"));
}

}  // namespace
}  // namespace patina
