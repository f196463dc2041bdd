// Wavefront OBJ: positions, texture coordinates, normals and faces. Materials, groups and curves
// are passed over.
#include "patina/base/output_file.h"
#include "patina/scene/mesh_io.h"
#include "patina/scene/polygon_soup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <string_view>

namespace patina {
namespace {

constexpr std::string_view kSpaces = " \t\r";
// Statements that say nothing about where the surface is.
constexpr std::array<std::string_view, 13> kPassedOver = {
    "o", "g", "s", "l", "p", "vp", "mg", "usemtl", "mtllib", "usemap", "maplib", "lod", "bevel"};

// Cuts the next word off the front of text; empty at its end.
std::string_view take_word(std::string_view& text) {
    text.remove_prefix(std::min(text.find_first_not_of(kSpaces), text.size()));
    const std::string_view word = text.substr(0, text.find_first_of(kSpaces));
    text.remove_prefix(word.size());
    return word;
}

class ObjParser {
  public:
    explicit ObjParser(const MeshPlace& place) : place_(place) {}

    PolygonSoup parse(std::string_view contents) {
        while (!contents.empty()) {
            const std::size_t end = std::min(contents.find('\n'), contents.size());
            ++line_number_;
            parse_line(contents.substr(0, end));
            contents.remove_prefix(std::min(end + 1, contents.size()));
        }
        return std::move(soup_);
    }

  private:
    [[noreturn]] void fail(const std::string& problem, const std::string& expected) const {
        place_.fail(fmt::format("line {} {}", line_number_, problem), expected);
    }

    void parse_line(std::string_view line) {
        line = line.substr(0, line.find('#'));
        const std::string_view keyword = take_word(line);
        if (keyword.empty()) return;
        if (keyword == "v") {
            const auto [x, y, z] = numbers<3>(line, 3);
            soup_.positions.emplace_back(x, y, z);
        } else if (keyword == "vt") {
            const auto [u, v] = numbers<2>(line, 1);
            soup_.uvs.emplace_back(u, v);
        } else if (keyword == "vn") {
            const auto [x, y, z] = numbers<3>(line, 3);
            soup_.normals.emplace_back(x, y, z);
        } else if (keyword == "f") {
            parse_face(line);
        } else if (std::find(kPassedOver.begin(), kPassedOver.end(), keyword) ==
                   kPassedOver.end()) {
            fail(fmt::format("begins with '{}'", keyword), "a statement of a polygon mesh");
        }
    }

    // The first numbers of a line; those that are left out, of which only `required` may not, are
    // 0.
    template <std::size_t Count>
    std::array<float, Count> numbers(std::string_view line, std::size_t required) const {
        std::array<float, Count> values{};
        for (std::size_t i = 0; i < Count; ++i) {
            const std::string_view word = take_word(line);
            if (word.empty() && i >= required) break;
            const char* const end = word.data() + word.size();
            // Over- and underflow leave the value alone: read wide, then round.
            double value = 0;
            const auto [stop, code] = std::from_chars(word.data(), end, value);
            if (code != std::errc() || stop != end || word.empty()) {
                fail(fmt::format("has '{}'", word), fmt::format("{} numbers", required));
            }
            values[i] = static_cast<float>(value);
        }
        return values;
    }

    void parse_face(std::string_view line) {
        for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
            soup_.corners.push_back(parse_corner(word));
        }
        soup_.polygon_ends.push_back(soup_.corners.size());
    }

    // "v", "v/vt", "v//vn" or "v/vt/vn".
    PolygonCorner parse_corner(std::string_view word) const {
        std::array<std::string_view, 3> parts;
        std::string_view rest = word;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const std::size_t slash = std::min(rest.find('/'), rest.size());
            parts[i] = rest.substr(0, slash);
            rest.remove_prefix(std::min(slash + 1, rest.size()));
        }
        if (!rest.empty()) fail(fmt::format("has the corner '{}'", word), "v/vt/vn");
        PolygonCorner corner;
        corner.position = index(parts[0], soup_.positions.size(), word);
        if (!parts[1].empty()) corner.uv = index(parts[1], soup_.uvs.size(), word);
        if (!parts[2].empty()) corner.normal = index(parts[2], soup_.normals.size(), word);
        return corner;
    }

    // From 1, or from the end where negative.
    std::uint32_t index(std::string_view text, std::size_t count, std::string_view word) const {
        long long value = 0;
        const auto [stop, code] = std::from_chars(text.data(), text.data() + text.size(), value);
        const auto signed_count = static_cast<long long>(count);
        const bool valid = code == std::errc() && stop == text.data() + text.size() && value != 0 &&
                           value >= -signed_count && value < static_cast<long long>(kNoIndex);
        if (!valid) {
            fail(fmt::format("has the corner '{}'", word),
                 fmt::format("indices from 1, or from -{} to -1", count));
        }
        return static_cast<std::uint32_t>(value > 0 ? value - 1 : signed_count + value);
    }

    const MeshPlace& place_;
    PolygonSoup soup_;
    int line_number_ = 0;
};

}  // namespace

PolygonSoup parse_obj(const std::string& contents, const MeshPlace& place) {
    return ObjParser(place).parse(contents);
}

void write_obj(const std::filesystem::path& path, const Mesh& mesh) {
    fmt::memory_buffer buffer;
    const auto out = std::back_inserter(buffer);
    for (const Vec3f& p : mesh.positions) fmt::format_to(out, "v {} {} {}\n", p.x(), p.y(), p.z());
    for (const Vec2f& uv : mesh.uvs) fmt::format_to(out, "vt {} {}\n", uv.x(), uv.y());
    for (const Vec3f& n : mesh.normals) {
        fmt::format_to(out, "vn {} {} {}\n", n.x(), n.y(), n.z());
    }
    for (const Triangle& t : mesh.triangles) {
        fmt::format_to(out, "f");
        for (const std::uint32_t vertex : t) {
            const std::uint32_t index = vertex + 1;
            if (mesh.uvs.empty() && mesh.normals.empty()) {
                fmt::format_to(out, " {}", index);
            } else if (mesh.normals.empty()) {
                fmt::format_to(out, " {}/{}", index, index);
            } else if (mesh.uvs.empty()) {
                fmt::format_to(out, " {}//{}", index, index);
            } else {
                fmt::format_to(out, " {}/{}/{}", index, index, index);
            }
        }
        fmt::format_to(out, "\n");
    }
    write_file(path, fmt::to_string(buffer));
}

}  // namespace patina
