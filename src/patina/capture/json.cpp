#include "patina/capture/json.h"

#include "patina/base/check.h"
#include "patina/base/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {
namespace {

// Far deeper than any document of ours; bounds the stack that a hostile file can use.
constexpr std::size_t kMaxDepth = 64;

// Builds a Json from the events of nlohmann's parser. Its own document type keeps the last of two
// fields of one name, which would hide a mistake.
class Builder : public nlohmann::json_sax<nlohmann::json> {
  public:
    Builder(const std::string& text, std::string place) : text_(text), place_(std::move(place)) {}

    [[nodiscard]] Json take() { return std::move(root_); }

    bool null() override { return add(Json()); }
    bool boolean(bool value) override { return add(Json(value)); }
    bool number_integer(number_integer_t value) override { return add(Json(value)); }
    bool number_unsigned(number_unsigned_t value) override {
        const bool fits = value <= number_unsigned_t(std::numeric_limits<std::int64_t>::max());
        return add(fits ? Json(std::int64_t(value)) : Json(double(value)));
    }
    bool number_float(number_float_t value, const string_t&) override { return add(Json(value)); }
    bool string(string_t& value) override { return add(Json(std::move(value))); }
    bool binary(binary_t&) override { return false; }
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::list()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override {
        Level& level = levels_.back();
        if (level.container->find(name) != nullptr) {
            throw Error(place_, field_path(level.path, name), "is given twice", "one field");
        }
        level.name = name;
        return true;
    }

    bool parse_error(std::size_t position,
                     const std::string&,
                     const nlohmann::detail::exception& exception) override {
        throw Error(place_, line_and_column(position), detail_of(exception.what()), "JSON");
    }

  private:
    struct Level {
        Json* container;
        std::string path;
        std::string name;  // of the field that comes next, in an object
    };

    [[nodiscard]] Json* place_value(Json value) {
        if (levels_.empty()) {
            root_ = std::move(value);
            return &root_;
        }
        Level& level = levels_.back();
        if (level.container->kind == JsonKind::object) {
            level.container->set(level.name, std::move(value));
        } else {
            level.container->push(std::move(value));
        }
        return &level.container->items.back();
    }

    bool add(Json value) {
        static_cast<void>(place_value(std::move(value)));
        return true;
    }

    bool open(Json container) {
        std::string path;
        if (!levels_.empty()) {
            const Level& parent = levels_.back();
            path = parent.container->kind == JsonKind::object
                       ? field_path(parent.path, parent.name)
                       : item_path(parent.path, parent.container->items.size());
        }
        if (levels_.size() == kMaxDepth) {
            throw Error(place_, "", "is nested too deeply", fmt::format("{} levels", kMaxDepth));
        }
        Json* const placed = place_value(std::move(container));
        levels_.push_back({placed, path, ""});
        return true;
    }

    bool close() {
        levels_.pop_back();
        return true;
    }

    // position: how many bytes were read, the offending one included.
    [[nodiscard]] std::string line_and_column(std::size_t position) const {
        const std::size_t end = std::min(position == 0 ? 0 : position - 1, text_.size());
        const std::string before = text_.substr(0, end);
        const std::size_t line_start = before.rfind('\n');
        const std::size_t column =
            line_start == std::string::npos ? end + 1 : before.size() - line_start;
        const auto num_lines = std::count(before.begin(), before.end(), '\n') + 1;
        return fmt::format("line {}, column {}", num_lines, column);
    }

    // The part of nlohmann's message that says what is wrong, without its own prefix and position.
    [[nodiscard]] static std::string detail_of(const std::string& message) {
        const std::size_t dash = message.find(" - ");
        const std::size_t bracket = message.find("] ");
        if (dash != std::string::npos) return message.substr(dash + 3);
        return bracket == std::string::npos ? message : message.substr(bracket + 2);
    }

    const std::string& text_;
    std::string place_;
    Json root_;
    std::vector<Level> levels_;
};

bool is_plain(const Json& value) {
    return value.kind != JsonKind::list && value.kind != JsonKind::object;
}

std::string number_text(double value) {
    PATINA_CHECK(std::isfinite(value));
    return fmt::format("{}", value);
}

void append_text(const Json& value, std::size_t depth, std::string& out);

void append_items(const Json& value, std::size_t depth, std::string& out) {
    const bool object = value.kind == JsonKind::object;
    const bool one_line = !object && std::all_of(value.items.begin(), value.items.end(), is_plain);
    const std::string inner = one_line ? "" : "\n" + std::string(2 * (depth + 1), ' ');
    const std::string outer = one_line ? "" : "\n" + std::string(2 * depth, ' ');
    out += object ? "{" : "[";
    for (std::size_t i = 0; i < value.items.size(); ++i) {
        if (i > 0) out += one_line ? ", " : ",";
        out += inner;
        if (object) out += quote(value.names[i]) + ": ";
        append_text(value.items[i], depth + 1, out);
    }
    if (!value.items.empty()) out += outer;
    out += object ? "}" : "]";
}

void append_text(const Json& value, std::size_t depth, std::string& out) {
    switch (value.kind) {
        case JsonKind::null:
            out += "null";
            break;
        case JsonKind::boolean:
            out += value.boolean ? "true" : "false";
            break;
        case JsonKind::integer:
            out += std::to_string(value.integer);
            break;
        case JsonKind::number:
            out += number_text(value.number);
            break;
        case JsonKind::text:
            out += quote(value.text);
            break;
        case JsonKind::list:
        case JsonKind::object:
            append_items(value, depth, out);
            break;
    }
}

}  // namespace

Json Json::list() {
    Json value;
    value.kind = JsonKind::list;
    return value;
}

Json Json::object() {
    Json value;
    value.kind = JsonKind::object;
    return value;
}

void Json::push(Json value) {
    PATINA_CHECK(kind == JsonKind::list);
    items.push_back(std::move(value));
}

void Json::set(const std::string& name, Json value) {
    PATINA_CHECK(kind == JsonKind::object);
    names.push_back(name);
    items.push_back(std::move(value));
}

const Json* Json::find(const std::string& name) const {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? nullptr : &items[std::size_t(found - names.begin())];
}

Json parse_json(const std::string& text, const std::string& place) {
    Builder builder(text, place);
    nlohmann::json::sax_parse(text, &builder);
    return builder.take();
}

std::string to_text(const Json& value) {
    std::string out;
    append_text(value, 0, out);
    return out + "\n";
}

std::string quote(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            out += '\\';
            out += c;
        } else if (c == '\n') {
            out += "\\n";
        } else if (code < 0x20 || code == 0x7f) {
            out += fmt::format("\\u{:04x}", code);
        } else {
            out += c;
        }
    }
    return out + "\"";
}

std::string field_path(const std::string& path, const std::string& name) {
    const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return c > ' ' && c < 0x7f && c != '.' && c != '"';
    });
    if (!plain) return path + "[" + quote(name) + "]";
    return path.empty() ? name : path + "." + name;
}

std::string item_path(const std::string& path, std::size_t index) {
    return fmt::format("{}[{}]", path, index);
}

}  // namespace patina
