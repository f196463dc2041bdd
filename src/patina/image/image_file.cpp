#include "patina/image/image_file.h"

#include "patina/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace patina {
namespace {

// A damaged header must not ask for more memory than any image needs: 178 megapixels of three
// channels [samples].
constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 29;

// ": message" in one line, or nothing.
std::string as_reason(std::string message) {
    std::replace(message.begin(), message.end(), '\n', ' ');
    while (!message.empty() && message.back() == ' ') message.pop_back();
    return message.empty() ? message : ": " + message;
}

bool same_word(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) {
        return lower(x) == lower(y);
    });
}

// "layer." of "layer.R", empty for "R".
std::string layer_of(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    return dot == std::string::npos ? std::string() : name.substr(0, dot + 1);
}

bool is_alpha(const std::string& name) {
    const std::string suffix = name.substr(layer_of(name).size());
    return same_word(suffix, "A") || same_word(suffix, "Alpha");
}

}  // namespace

void Place::fail(const std::string& problem, const std::string& expected) const {
    throw Error(path.string(), field, problem, expected);
}

void Place::fail_to_open(const std::string& message) const {
    fail("cannot be read" + as_reason(message), kKindsUnderstood);
}

void Place::fail_as_damaged(const std::string& message) const {
    fail("is damaged or truncated" + as_reason(message), "a complete image");
}

void Place::fail_for_type(const std::string& type) const {
    fail("has samples of type " + type, "unsigned integers of 8 or 16 bits, or floats");
}

void Place::fail_for_depth() const { fail("is a deep or volume image", "a flat image"); }

void Place::fail_for_crop() const {
    fail("has a data window that is not its display window", "an image without crop");
}

void check_size(std::int64_t width, std::int64_t height, std::size_t channels, const Place& place) {
    const std::uint64_t num_columns = std::uint64_t(std::max<std::int64_t>(width, 0));
    const std::uint64_t num_rows = std::uint64_t(std::max<std::int64_t>(height, 0));
    // Divided, so that nothing overflows.
    if (num_columns == 0 || num_rows == 0 || channels == 0 ||
        num_columns > kMaxSamples / channels / num_rows) {
        place.fail(fmt::format("has a size of {} x {}", width, height),
                   fmt::format("at most {} samples", kMaxSamples));
    }
}

std::vector<int> wanted_channels(const std::vector<std::string>& names, const Place& place) {
    const auto find = [&](const std::string& name) {
        const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& other) {
            return same_word(name, other);
        });
        return found == names.end() ? -1 : static_cast<int>(found - names.begin());
    };
    std::vector<std::string> layers = {""};
    for (const std::string& name : names) layers.push_back(layer_of(name));
    // "a." comes before "a.b." however their channels are called.
    std::sort(layers.begin(), layers.end());
    layers.erase(std::unique(layers.begin(), layers.end()), layers.end());
    for (const std::string& layer : layers) {
        const std::vector<int> rgb = {find(layer + "R"), find(layer + "G"), find(layer + "B")};
        if (rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0) return rgb;
    }
    const bool has_chroma = find("RY") >= 0 || find("BY") >= 0;
    if (const int luminance = find("Y"); luminance >= 0 && !has_chroma) return {luminance};
    if (names.size() == 1) return {0};
    if (names.size() == 2 && is_alpha(names[0])) return {1};
    if (names.size() == 2 && is_alpha(names[1])) return {0};
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    place.fail("has the channels " + all, "R, G and B, or Y, or a single channel");
}

}  // namespace patina
