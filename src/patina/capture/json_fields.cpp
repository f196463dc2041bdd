#include "patina/capture/json_fields.h"

#include "patina/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

JsonField::JsonField(const Json* value, std::string place, std::string path)
    : value_(value), place_(std::move(place)), path_(std::move(path)) {}

void JsonField::fail(const std::string& problem, const std::string& expected) const {
    throw Error(place_, path_, problem, expected);
}

std::string JsonField::description() const {
    if (!present()) return "is missing";
    switch (value_->kind) {
        case JsonKind::null:
            return "is null";
        case JsonKind::boolean:
            return value_->boolean ? "is true" : "is false";
        case JsonKind::integer:
            return fmt::format("is {}", value_->integer);
        case JsonKind::number:
            return fmt::format("is {}", value_->number);
        case JsonKind::text:
            return "is " + quote(value_->text);
        case JsonKind::list:
            return fmt::format("is a list of {}", value_->items.size());
        case JsonKind::object:
            break;
    }
    return "is an object";
}

void JsonField::require(JsonKind kind, const std::string& expected) const {
    if (!present() || value_->kind != kind) fail(description(), expected);
}

JsonField JsonField::operator[](const std::string& name) const {
    require(JsonKind::object, "an object");
    return {value_->find(name), place_, field_path(path_, name)};
}

void JsonField::allow_only(std::initializer_list<std::string_view> names) const {
    require(JsonKind::object, "an object");
    for (const std::string& name : value_->names) {
        const bool known = std::find(names.begin(), names.end(), name) != names.end();
        if (known || name.starts_with("x-")) continue;
        std::string expected = "one of";
        for (const std::string_view allowed : names) {
            expected += (allowed == *names.begin() ? " " : ", ") + std::string(allowed);
        }
        throw Error(place_, field_path(path_, name), "is not a field here", expected);
    }
}

bool JsonField::boolean() const {
    require(JsonKind::boolean, "true or false");
    return value_->boolean;
}

std::string JsonField::text(const std::string& expected) const {
    require(JsonKind::text, expected);
    return value_->text;
}

double JsonField::number_checked(bool (*good)(double), const std::string& expected) const {
    const bool numeric =
        present() && (value_->kind == JsonKind::integer || value_->kind == JsonKind::number);
    if (!numeric || !good(value_->number)) fail(description(), expected);
    if (std::abs(value_->number) > kMaxNumber) {
        fail(description(), fmt::format("at most {:g} in size", kMaxNumber));
    }
    return value_->number;
}

double JsonField::number() const {
    return number_checked([](double) { return true; }, "a number");
}

double JsonField::number_above_zero() const {
    const double value = number_checked([](double v) { return v > 0; }, "a number above 0");
    if (value < 1 / kMaxNumber) fail(description(), fmt::format("at least {:g}", 1 / kMaxNumber));
    return value;
}

double JsonField::number_not_below_zero() const {
    return number_checked([](double value) { return value >= 0; }, "a number of at least 0");
}

int JsonField::integer(int low, int high) const {
    const std::string expected =
        low == high ? std::to_string(low) : fmt::format("an integer from {} to {}", low, high);
    require(JsonKind::integer, expected);
    if (value_->integer < low || value_->integer > high) fail(description(), expected);
    return int(value_->integer);
}

std::vector<JsonField> JsonField::list(const std::string& expected) const {
    require(JsonKind::list, expected);
    std::vector<JsonField> fields;
    fields.reserve(value_->items.size());
    for (std::size_t i = 0; i < value_->items.size(); ++i) {
        fields.emplace_back(&value_->items[i], place_, item_path(path_, i));
    }
    return fields;
}

std::vector<double> JsonField::numbers(std::size_t count) const {
    const std::string expected = fmt::format("a list of {} numbers", count);
    const std::vector<JsonField> fields = list(expected);
    if (fields.size() != count) fail(description(), expected);
    std::vector<double> values;
    values.reserve(count);
    for (const JsonField& field : fields) values.push_back(field.number());
    return values;
}

}  // namespace patina
