// Options declared once: the parser, --help, docs/commands.md and the settings in result.json all
// come from the same table.
#pragma once

#include "patina/base/error.h"
#include "patina/capture/json.h"
#include "patina/math/types.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patina {

enum class OptionKind { positional, valued, flag };

// One word of a command. set and get are bound to the field that holds the value; it must outlive
// the option.
struct Option {
    // In snake_case, which is its name in JSON; on the command line photons is --photons and
    // max_bounces is --max-bounces. Positional words are in capitals.
    std::string name;
    std::string letter;  // "o" of -o; empty: none
    OptionKind kind = OptionKind::valued;
    std::string value_name;    // what the help calls the value: N, DIR, ratio|disc
    std::string range;         // with its unit: "0 to 90 degrees"; empty: anything
    std::string default_text;  // empty: none
    std::string help;          // without a full stop
    bool is_required = false;
    bool is_setting = false;                      // the bytes of the result depend on it
    std::function<void(const std::string&)> set;  // throws Error naming the option
    std::function<Json()> get;

    // "--max-bounces"; the name itself for positional words.
    [[nodiscard]] std::string flag() const;
};

using OptionTable = std::vector<Option>;

// Inclusive limits of a number, in the unit of the command line.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_is_open = false;  // low itself is not allowed

    [[nodiscard]] bool contains(double value) const;
    // "2 to 100", "1 or more", "above 0"; empty when everything is allowed.
    [[nodiscard]] std::string text() const;
};
[[nodiscard]] constexpr Range at_least(double low) {
    return {low, std::numeric_limits<double>::infinity(), false};
}
[[nodiscard]] constexpr Range above(double low) {
    return {low, std::numeric_limits<double>::infinity(), true};
}
[[nodiscard]] constexpr Range between(double low, double high) { return {low, high, false}; }

// Each makes an option whose default is what the field holds now. Settings by default, as most
// options decide the result's bytes; not_a_setting() takes that back.
[[nodiscard]] Option integer_option(const std::string& name,
                                    int& field,
                                    const Range& range,
                                    const std::string& help);
[[nodiscard]] Option integer_option(const std::string& name,
                                    std::uint64_t& field,
                                    const Range& range,
                                    const std::string& help);
// unit: "rad", "pixels"; becomes part of the range's text; empty for numbers without unit.
[[nodiscard]] Option number_option(const std::string& name,
                                   double& field,
                                   const Range& range,
                                   const std::string& unit,
                                   const std::string& help);
// Nothing unless given; what then holds is said in default_text.
[[nodiscard]] Option number_option(const std::string& name,
                                   std::optional<double>& field,
                                   const Range& range,
                                   const std::string& unit,
                                   const std::string& default_text,
                                   const std::string& help);
// Degrees on the command line and in JSON, radians in the field. range: degrees.
[[nodiscard]] Option angle_option(const std::string& name,
                                  double& field_rad,
                                  const Range& range,
                                  const std::string& help);
// "WxH" in two fields; both 0: none. range: said in the help, checked by the command.
[[nodiscard]] Option size_option(const std::string& name,
                                 int& width,
                                 int& height,
                                 const std::string& range,
                                 const std::string& help);
// "X,Y,Z". Nothing unless given; what then holds is said in default_text.
[[nodiscard]] Option vector_option(const std::string& name,
                                   std::optional<Vec3>& field,
                                   const std::string& default_text,
                                   const std::string& help);
[[nodiscard]] Option flag_option(const std::string& name, bool& field, const std::string& help);
[[nodiscard]] Option path_option(const std::string& name,
                                 const std::string& value_name,
                                 std::filesystem::path& field,
                                 const std::string& help);
[[nodiscard]] Option text_option(const std::string& name,
                                 const std::string& value_name,
                                 std::string& field,
                                 const std::string& help);
// A word that stands by its place; always required.
[[nodiscard]] Option positional(const std::string& name,
                                std::filesystem::path& field,
                                const std::string& help);
[[nodiscard]] Option positional(const std::string& name,
                                std::string& field,
                                const std::string& help);

// The choices of an enumeration by name; without an enumerator: known, but not there yet.
template <typename Enum>
using Choices = std::vector<std::pair<std::string, std::optional<Enum>>>;

// "direct, diffuse or photon"; the parts of choice_option() that do not depend on the type.
[[nodiscard]] std::string join_choices(const std::vector<std::string>& names);
[[nodiscard]] Option named_option(const std::string& name,
                                  const std::vector<std::string>& names,
                                  const std::string& default_text,
                                  const std::string& help);
[[noreturn]] void reject_choice(const Option& option,
                                const std::string& text,
                                const std::vector<std::string>& available,
                                bool comes_later);

template <typename Enum>
[[nodiscard]] std::string choice_name(const Choices<Enum>& choices, Enum value) {
    for (const auto& [name, choice] : choices) {
        if (choice == value) return name;
    }
    return "";
}

template <typename Enum>
[[nodiscard]] Option choice_option(const std::string& name,
                                   Enum& field,
                                   const Choices<Enum>& choices,
                                   const std::string& help) {
    std::vector<std::string> names;
    std::vector<std::string> available;
    for (const auto& [choice_text, choice] : choices) {
        names.push_back(choice_text);
        if (choice) available.push_back(choice_text);
    }
    Option option = named_option(name, names, choice_name(choices, field), help);
    const Option words = option;
    option.set = [&field, choices, available, words](const std::string& text) {
        const auto found = std::find_if(
            choices.begin(), choices.end(), [&](const auto& entry) { return entry.first == text; });
        if (found == choices.end()) reject_choice(words, text, available, false);
        if (!found->second) reject_choice(words, text, available, true);
        field = *found->second;
    };
    option.get = [&field, choices]() { return Json(choice_name(choices, field)); };
    return option;
}

// The same option with one property changed, for tables.
[[nodiscard]] Option with_letter(Option option, const std::string& letter);
[[nodiscard]] Option required(Option option);
[[nodiscard]] Option not_a_setting(Option option);

// The values of those options that are settings, as one JSON object in the order of the table.
[[nodiscard]] Json settings_of(const OptionTable& options);

// Rows of a Markdown table: name, values, default, help.
[[nodiscard]] std::string options_markdown(const OptionTable& options);

}  // namespace patina
