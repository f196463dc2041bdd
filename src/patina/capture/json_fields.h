// Typed access to the fields of a JSON document, with messages that name the file and the field.
#pragma once

#include "patina/capture/json.h"

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace patina {

// Far beyond any length, focal length, intensity or radiance in any unit, and so small that its
// square is finite as a float and a ray may start that far times an image's side away
// (Embree: 1.8e18).
inline constexpr double kMaxNumber = 1e13;

// A value of a document together with where it stands. Every reader throws Error with that place
// when the value is missing or not what was asked for. The document must outlive it.
class JsonField {
  public:
    // value: null where the field is missing. place: the file. path: "" for the document itself.
    JsonField(const Json* value, std::string place, std::string path);

    [[nodiscard]] bool present() const { return value_ != nullptr; }
    [[nodiscard]] bool is_object() const { return present() && value_->kind == JsonKind::object; }
    [[nodiscard]] const std::string& path() const { return path_; }
    [[noreturn]] void fail(const std::string& problem, const std::string& expected) const;

    // The field of that name of an object; not present where the object has none.
    [[nodiscard]] JsonField operator[](const std::string& name) const;
    // Fails for the first field that is neither listed nor begins with "x-".
    void allow_only(std::initializer_list<std::string_view> names) const;

    // expected: what the message says was wanted.
    [[nodiscard]] bool boolean() const;
    [[nodiscard]] std::string text(const std::string& expected = "text") const;
    // Numbers from -kMaxNumber to kMaxNumber; those above 0 begin at 1 / kMaxNumber.
    [[nodiscard]] double number() const;
    [[nodiscard]] double number_above_zero() const;
    [[nodiscard]] double number_not_below_zero() const;
    // An integer in [low, high].
    [[nodiscard]] int integer(int low, int high) const;
    [[nodiscard]] std::vector<JsonField> list(const std::string& expected = "a list") const;
    // A list of exactly `count` numbers.
    [[nodiscard]] std::vector<double> numbers(std::size_t count) const;

    // The meaning of one of the words listed.
    template <typename Meaning>
    [[nodiscard]] Meaning word(
        std::initializer_list<std::pair<std::string_view, Meaning>> words) const {
        std::string expected;
        for (const auto& [name, meaning] : words) {
            expected += (expected.empty() ? "" : " or ") + quote(std::string(name));
        }
        const std::string given = text(expected);
        for (const auto& [name, meaning] : words) {
            if (given == name) return meaning;
        }
        fail("is " + quote(given), expected);
    }

  private:
    // Fails unless the value is there and of that kind.
    void require(JsonKind kind, const std::string& expected) const;
    // The number, once it is one, not beyond kMaxNumber and `good`; expected: of a good one.
    [[nodiscard]] double number_checked(bool (*good)(double), const std::string& expected) const;
    // "is 3", "is \"abc\"", "is an object", "is missing".
    [[nodiscard]] std::string description() const;

    const Json* value_;
    std::string place_;
    std::string path_;
};

}  // namespace patina
