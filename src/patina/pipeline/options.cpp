#include "patina/pipeline/options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace patina {
namespace {

// Integers up to here are exact in double, and so in JSON.
constexpr double kMaxExactInteger = 9007199254740992.0;

template <typename Value>
bool parse_whole(const std::string& text, Value& value) {
    const char* const end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data(), end, value);
    return !text.empty() && code == std::errc() && stop == end;
}

[[noreturn]] void reject(const Option& option,
                         const std::string& text,
                         const std::string& expected) {
    throw Error(option.flag(), "", "is " + quote(text), expected);
}

double parse_number(const Option& option, const Range& range, const std::string& text) {
    const std::string expected = option.range.empty() ? "a number" : "a number, " + option.range;
    double value = 0;
    if (!parse_whole(text, value) || !std::isfinite(value) || !range.contains(value)) {
        reject(option, text, expected);
    }
    return value;
}

template <typename Integer>
Option make_integer_option(const std::string& name,
                           Integer& field,
                           const Range& range,
                           const std::string& help) {
    Option option;
    option.name = name;
    option.value_name = "N";
    option.range = range.text();
    option.default_text = fmt::format("{}", field);
    option.help = help;
    option.is_setting = true;
    const Option words = option;
    option.set = [&field, range, words](const std::string& text) {
        Integer value = 0;
        if (!parse_whole(text, value) || !range.contains(double(value)) ||
            double(value) > kMaxExactInteger) {
            reject(words,
                   text,
                   words.range.empty() ? "a whole number" : "a whole number, " + words.range);
        }
        field = value;
    };
    option.get = [&field]() { return Json(std::int64_t(field)); };
    return option;
}

Option number_words(const std::string& name,
                    const Range& range,
                    const std::string& unit,
                    const std::string& help) {
    Option option;
    option.name = name;
    option.value_name = "X";
    option.range = range.text();
    if (!unit.empty()) option.range += (option.range.empty() ? "" : " ") + unit;
    option.help = help;
    option.is_setting = true;
    return option;
}

// A table cell must not hold the character that separates cells.
std::string cell(std::string text) {
    for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) {
        text.insert(at, 1, '\\');
    }
    return text;
}

}  // namespace

std::string Option::flag() const {
    if (kind == OptionKind::positional) return name;
    std::string words = "--" + name;
    std::replace(words.begin(), words.end(), '_', '-');
    return words;
}

bool Range::contains(double value) const {
    return (low_is_open ? value > low : value >= low) && value <= high;
}

std::string Range::text() const {
    if (std::isinf(low) && std::isinf(high)) return "";
    if (std::isinf(high)) {
        return low_is_open ? fmt::format("above {}", low) : fmt::format("{} or more", low);
    }
    return low_is_open ? fmt::format("above {}, up to {}", low, high)
                       : fmt::format("{} to {}", low, high);
}

Option integer_option(const std::string& name,
                      int& field,
                      const Range& range,
                      const std::string& help) {
    return make_integer_option(name, field, range, help);
}

Option integer_option(const std::string& name,
                      std::uint64_t& field,
                      const Range& range,
                      const std::string& help) {
    return make_integer_option(name, field, range, help);
}

Option number_option(const std::string& name,
                     double& field,
                     const Range& range,
                     const std::string& unit,
                     const std::string& help) {
    Option option = number_words(name, range, unit, help);
    option.default_text = fmt::format("{}", field);
    const Option words = option;
    option.set = [&field, range, words](const std::string& text) {
        field = parse_number(words, range, text);
    };
    option.get = [&field]() { return Json(field); };
    return option;
}

Option number_option(const std::string& name,
                     std::optional<double>& field,
                     const Range& range,
                     const std::string& unit,
                     const std::string& default_text,
                     const std::string& help) {
    Option option = number_words(name, range, unit, help);
    option.default_text = default_text;
    const Option words = option;
    option.set = [&field, range, words](const std::string& text) {
        field = parse_number(words, range, text);
    };
    option.get = [&field]() { return field ? Json(*field) : Json(); };
    return option;
}

Option angle_option(const std::string& name,
                    double& field_rad,
                    const Range& range,
                    const std::string& help) {
    Option option = number_words(name, range, "degrees", help);
    // Nine digits hide the rounding of the conversion.
    option.default_text = fmt::format("{:.9g}", degrees(field_rad));
    const Option words = option;
    option.set = [&field_rad, range, words](const std::string& text) {
        field_rad = radians(parse_number(words, range, text));
    };
    option.get = [&field_rad]() {
        return Json(std::stod(fmt::format("{:.9g}", degrees(field_rad))));
    };
    return option;
}

Option size_option(const std::string& name,
                   int& width,
                   int& height,
                   const std::string& range,
                   const std::string& help) {
    const auto text_of = [&width, &height]() { return fmt::format("{}x{}", width, height); };
    Option option;
    option.name = name;
    option.value_name = "WxH";
    option.range = range;
    if (width > 0) option.default_text = text_of();
    option.help = help;
    option.is_setting = true;
    const Option words = option;
    option.set = [&width, &height, words](const std::string& text) {
        const std::size_t cross = std::min(text.find('x'), text.size());
        const std::string rest = cross < text.size() ? text.substr(cross + 1) : "";
        if (!parse_whole(text.substr(0, cross), width) || !parse_whole(rest, height)) {
            reject(words, text, "columns and rows such as 128x80");
        }
    };
    option.get = [text_of]() { return Json(text_of()); };
    return option;
}

Option vector_option(const std::string& name,
                     std::optional<Vec3>& field,
                     const std::string& default_text,
                     const std::string& help) {
    Option option;
    option.name = name;
    option.value_name = "X,Y,Z";
    option.default_text = default_text;
    option.help = help;
    option.is_setting = true;
    const Option words = option;
    option.set = [&field, words](const std::string& text) {
        Vec3 value = Vec3::Zero();
        std::size_t begin = 0;
        for (Eigen::Index i = 0; i < 3; ++i) {
            const std::size_t end = i < 2 ? text.find(',', begin) : text.size();
            if (end == std::string::npos ||
                !parse_whole(text.substr(begin, end - begin), value[i]) ||
                !std::isfinite(value[i])) {
                reject(words, text, "three numbers with commas between");
            }
            begin = end + 1;
        }
        field = value;
    };
    option.get = [&field]() {
        if (!field) return Json();
        Json list = Json::list();
        for (const double coordinate : *field) list.push(Json(coordinate));
        return list;
    };
    return option;
}

Option flag_option(const std::string& name, bool& field, const std::string& help) {
    Option option;
    option.name = name;
    option.kind = OptionKind::flag;
    option.help = help;
    option.is_setting = true;
    option.set = [&field](const std::string&) { field = true; };
    option.get = [&field]() { return Json(field); };
    return option;
}

Option path_option(const std::string& name,
                   const std::string& value_name,
                   std::filesystem::path& field,
                   const std::string& help) {
    Option option;
    option.name = name;
    option.value_name = value_name;
    option.default_text = field.string();
    option.help = help;
    option.set = [&field](const std::string& text) { field = text; };
    option.get = [&field]() { return Json(field.string()); };
    return option;
}

Option text_option(const std::string& name,
                   const std::string& value_name,
                   std::string& field,
                   const std::string& help) {
    Option option;
    option.name = name;
    option.value_name = value_name;
    option.default_text = field;
    option.help = help;
    option.is_setting = true;
    option.set = [&field](const std::string& text) { field = text; };
    option.get = [&field]() { return Json(field); };
    return option;
}

Option positional(const std::string& name, std::filesystem::path& field, const std::string& help) {
    Option option = path_option(name, name, field, help);
    option.kind = OptionKind::positional;
    option.is_required = true;
    return option;
}

Option positional(const std::string& name, std::string& field, const std::string& help) {
    Option option = text_option(name, name, field, help);
    option.kind = OptionKind::positional;
    option.is_required = true;
    return option;
}

std::string join_choices(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
        text += names[i];
    }
    return text;
}

Option named_option(const std::string& name,
                    const std::vector<std::string>& names,
                    const std::string& default_text,
                    const std::string& help) {
    Option option;
    option.name = name;
    for (const std::string& choice : names) {
        option.value_name += (option.value_name.empty() ? "" : "|") + choice;
    }
    option.default_text = default_text;
    option.help = help;
    option.is_setting = true;
    return option;
}

void reject_choice(const Option& option,
                   const std::string& text,
                   const std::vector<std::string>& available,
                   bool comes_later) {
    if (!comes_later) reject(option, text, join_choices(available));
    throw Error(option.flag(),
                "",
                "is " + quote(text) + ", which follows in a later version",
                join_choices(available));
}

Option with_letter(Option option, const std::string& letter) {
    option.letter = letter;
    return option;
}

Option required(Option option) {
    option.is_required = true;
    return option;
}

Option not_a_setting(Option option) {
    option.is_setting = false;
    return option;
}

Json settings_of(const OptionTable& options) {
    Json settings = Json::object();
    for (const Option& option : options) {
        if (option.is_setting) settings.set(option.name, option.get());
    }
    return settings;
}

std::string options_markdown(const OptionTable& options) {
    std::string text = "| word | values | default | meaning |\n| --- | --- | --- | --- |\n";
    for (const Option& option : options) {
        std::string words = option.flag();
        if (!option.letter.empty()) words = "-" + option.letter + ", " + words;
        if (option.kind == OptionKind::valued) words += " " + option.value_name;
        const std::string fallback = option.is_required ? "required" : option.default_text;
        text += fmt::format(
            "| `{}` | {} | {} | {} |\n", cell(words), option.range, cell(fallback), option.help);
    }
    return text;
}

}  // namespace patina
