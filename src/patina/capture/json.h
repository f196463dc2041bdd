// A JSON document in memory: fields keep their order, a name given twice is an error.
//
// nlohmann-json is the parser, and stays inside json.cpp.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace patina {

enum class JsonKind { null, boolean, integer, number, text, list, object };

// One value. Which members mean something depends on kind.
struct Json {
    Json() = default;
    explicit Json(bool value) : kind(JsonKind::boolean), boolean(value) {}
    explicit Json(int value) : Json(std::int64_t(value)) {}
    explicit Json(std::int64_t value)
        : kind(JsonKind::integer), integer(value), number(double(value)) {}
    explicit Json(double value) : kind(JsonKind::number), number(value) {}
    explicit Json(std::string value) : kind(JsonKind::text), text(std::move(value)) {}
    explicit Json(const char* value) : Json(std::string(value)) {}

    [[nodiscard]] static Json list();
    [[nodiscard]] static Json object();

    // Appends to a list.
    void push(Json value);
    // Appends a field to an object; the caller gives each name once.
    void set(const std::string& name, Json value);
    // The field of that name of an object, or null.
    [[nodiscard]] const Json* find(const std::string& name) const;

    JsonKind kind = JsonKind::null;
    bool boolean = false;
    std::int64_t integer = 0;
    double number = 0;  // of integers too
    std::string text;
    std::vector<std::string> names;  // of an object's fields; items[i] is the value of names[i]
    std::vector<Json> items;         // of a list or an object
};

// Parses UTF-8 text. place: the file, for messages. Throws Error for a syntax error (its FIELD is
// "line L, column C"), a number beyond the range of double, a name given twice, too deep nesting.
[[nodiscard]] Json parse_json(const std::string& text, const std::string& place);

// The document as text: one field a line, two spaces per level, lists of plain values on one line,
// numbers with the fewest digits that read back to the same double, a line feed at the end. The
// same value gives the same bytes. Numbers must be finite.
[[nodiscard]] std::string to_text(const Json& value);

// Text in quotation marks with JSON's escapes: always one line.
[[nodiscard]] std::string quote(const std::string& text);

// "lights[2].intensity" from "lights[2]" and "intensity"; path may be empty.
[[nodiscard]] std::string field_path(const std::string& path, const std::string& name);
// "lights[2]" from "lights" and 2.
[[nodiscard]] std::string item_path(const std::string& path, std::size_t index);

}  // namespace patina
