// What tests of pages look for.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace patina {

// What is wrong with the nesting of the tags, and the first place where; empty: every element is
// closed in its order. Understands what our pages use: void elements, self-closed SVG elements,
// quoted attributes, style sheets.
[[nodiscard]] inline std::string nesting_error(std::string_view html) {
    constexpr std::string_view kVoid[] = {"meta", "img", "br", "!DOCTYPE"};
    std::vector<std::string> open;
    for (std::size_t i = html.find('<'); i != std::string_view::npos; i = html.find('<', i + 1)) {
        const bool closes = html.substr(i + 1, 1) == "/";
        const std::size_t begin = i + (closes ? 2 : 1);
        std::size_t end = begin;
        bool in_quotes = false;
        while (end < html.size() && (in_quotes || html[end] != '>')) {
            if (html[end] == '"') in_quotes = !in_quotes;
            if (html[end] == '<') return "'<' inside a tag: " + std::string(html.substr(i, 60));
            ++end;
        }
        if (end == html.size()) return "a tag without end: " + std::string(html.substr(i, 60));
        const std::string_view tag = html.substr(begin, end - begin);
        const std::string name(tag.substr(0, tag.find_first_of(" /\n")));
        if (closes) {
            if (open.empty() || open.back() != name) {
                return "</" + name + "> closes " + (open.empty() ? "nothing" : open.back());
            }
            open.pop_back();
        } else {
            bool is_void = !tag.empty() && tag.back() == '/';
            for (const std::string_view v : kVoid) is_void = is_void || v == name;
            if (!is_void) open.push_back(name);
        }
        i = end;
        if (name == "style" && !closes) i = html.find("</style>", end) - 1;
    }
    return open.empty() ? "" : "<" + open.back() + "> is never closed";
}

}  // namespace patina
