// The Stanford polygon format: ascii and binary of both byte orders.
#include "patina/base/output_file.h"
#include "patina/scene/mesh_io.h"
#include "patina/scene/polygon_soup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <optional>
#include <string_view>

namespace patina {
namespace {

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyType {
    std::size_t size = 0;  // [bytes]
    bool is_float = false;
    bool is_signed = false;
};

struct PlyProperty {
    std::string_view name;
    PlyType type;
    std::optional<PlyType> list_count;  // of lists: the type of their length
};

struct PlyElement {
    std::string_view name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;

    // Position of the first property that has one of these names.
    [[nodiscard]] std::optional<std::size_t> find(
        std::initializer_list<std::string_view> names) const {
        for (const std::string_view wanted : names) {
            for (std::size_t i = 0; i < properties.size(); ++i) {
                if (properties[i].name == wanted) return i;
            }
        }
        return std::nullopt;
    }
};

std::string_view take_until(std::string_view& text, std::string_view separators) {
    const std::size_t end = std::min(text.find_first_of(separators), text.size());
    const std::string_view piece = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return piece;
}

std::string_view take_word(std::string_view& text) {
    constexpr std::string_view kSpaces = " \t\r\n";
    text.remove_prefix(std::min(text.find_first_not_of(kSpaces), text.size()));
    return take_until(text, kSpaces);
}

class PlyParser {
  public:
    PlyParser(std::string_view contents, const MeshPlace& place) : rest_(contents), place_(place) {}

    PolygonSoup parse() {
        parse_header();
        for (const PlyElement& element : elements_) {
            // Every row takes at least one byte, so that a damaged count cannot ask for endless
            // work.
            if (element.count > rest_.size() || (element.count > 0 && element.properties.empty())) {
                fail_truncated(element);
            }
            if (element.name == "vertex") {
                read_vertices(element);
            } else if (element.name == "face") {
                read_faces(element);
            } else {
                for (std::size_t i = 0; i < element.count; ++i) read_row(element);
            }
        }
        return std::move(soup_);
    }

  private:
    [[noreturn]] void fail_header(std::string_view line) const {
        place_.fail(fmt::format("has the header line '{}'", line), "a PLY header");
    }
    [[noreturn]] void fail_truncated(const PlyElement& element) const {
        place_.fail("is damaged or truncated",
                    fmt::format("{} rows of element '{}'", element.count, element.name));
    }

    static std::optional<PlyType> type_of(std::string_view name) {
        if (name == "char" || name == "int8") return PlyType{1, false, true};
        if (name == "uchar" || name == "uint8") return PlyType{1, false, false};
        if (name == "short" || name == "int16") return PlyType{2, false, true};
        if (name == "ushort" || name == "uint16") return PlyType{2, false, false};
        if (name == "int" || name == "int32") return PlyType{4, false, true};
        if (name == "uint" || name == "uint32") return PlyType{4, false, false};
        if (name == "float" || name == "float32") return PlyType{4, true, true};
        if (name == "double" || name == "float64") return PlyType{8, true, true};
        return std::nullopt;
    }

    void parse_header() {
        std::string_view magic = take_until(rest_, "\n");
        if (take_word(magic) != "ply") fail_header("");
        bool has_format = false;
        while (!rest_.empty()) {
            const std::string_view line = take_until(rest_, "\n");
            std::string_view words = line;
            const std::string_view keyword = take_word(words);
            if (keyword == "end_header" && has_format) return;
            if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) continue;
            if (keyword == "format") {
                has_format = parse_format(take_word(words));
                if (!has_format) fail_header(line);
            } else if (keyword == "element") {
                parse_element(words, line);
            } else if (keyword == "property") {
                parse_property(words, line);
            } else {
                fail_header(line);
            }
        }
        place_.fail("ends within its header", "end_header");
    }

    bool parse_format(std::string_view name) {
        if (name == "ascii") {
            format_ = PlyFormat::ascii;
        } else if (name == "binary_little_endian") {
            format_ = PlyFormat::little_endian;
        } else if (name == "binary_big_endian") {
            format_ = PlyFormat::big_endian;
        } else {
            return false;
        }
        return true;
    }

    void parse_element(std::string_view words, std::string_view line) {
        PlyElement element;
        element.name = take_word(words);
        const std::string_view count = take_word(words);
        const auto [stop, code] =
            std::from_chars(count.data(), count.data() + count.size(), element.count);
        if (code != std::errc() || stop != count.data() + count.size()) fail_header(line);
        elements_.push_back(std::move(element));
    }

    void parse_property(std::string_view words, std::string_view line) {
        std::string_view type_name = take_word(words);
        PlyProperty property;
        if (type_name == "list") {
            property.list_count = type_of(take_word(words));
            if (!property.list_count || property.list_count->is_float) fail_header(line);
            type_name = take_word(words);
        }
        const std::optional<PlyType> type = type_of(type_name);
        property.name = take_word(words);
        if (!type || property.name.empty() || elements_.empty()) fail_header(line);
        property.type = *type;
        elements_.back().properties.push_back(property);
    }

    double read_number(const PlyType& type, const PlyElement& element) {
        return format_ == PlyFormat::ascii ? read_ascii(element) : read_binary(type, element);
    }

    double read_ascii(const PlyElement& element) {
        const std::string_view word = take_word(rest_);
        double value = 0;
        const auto [stop, code] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (code != std::errc() || stop != word.data() + word.size()) fail_truncated(element);
        return value;
    }

    double read_binary(const PlyType& type, const PlyElement& element) {
        if (rest_.size() < type.size) fail_truncated(element);
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < type.size; ++i) {
            const std::size_t from_low =
                format_ == PlyFormat::little_endian ? type.size - 1 - i : i;
            bits = (bits << 8) | static_cast<unsigned char>(rest_[from_low]);
        }
        rest_.remove_prefix(type.size);
        if (type.is_float) {
            return type.size == 4 ? double(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
                                  : std::bit_cast<double>(bits);
        }
        const std::uint64_t sign = std::uint64_t{1} << (8 * type.size - 1);
        const double value = static_cast<double>(bits);
        return type.is_signed && (bits & sign) != 0 ? value - 2 * static_cast<double>(sign) : value;
    }

    // One row: values_[i] are the numbers of property i.
    void read_row(const PlyElement& element) {
        values_.resize(element.properties.size());
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            const PlyProperty& property = element.properties[i];
            std::size_t count = 1;
            if (property.list_count) {
                const double stated = read_number(*property.list_count, element);
                // Every entry takes at least one byte.
                if (!(stated >= 0 && stated <= double(rest_.size()))) fail_truncated(element);
                count = static_cast<std::size_t>(stated);
            }
            values_[i].clear();
            for (std::size_t k = 0; k < count; ++k) {
                values_[i].push_back(read_number(property.type, element));
            }
        }
    }

    // The numbers at these properties of the row, which must not be lists.
    template <typename Vector>
    Vector pick(const std::array<std::optional<std::size_t>, Vector::RowsAtCompileTime>& columns) {
        Vector result;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const std::vector<double>& numbers = values_[*columns[i]];
            if (numbers.size() != 1) place_.fail("has a list as a coordinate", "single numbers");
            result[static_cast<Eigen::Index>(i)] = static_cast<float>(numbers[0]);
        }
        return result;
    }

    void read_vertices(const PlyElement& element) {
        const std::array position = {element.find({"x"}), element.find({"y"}), element.find({"z"})};
        const std::array normal = {
            element.find({"nx"}), element.find({"ny"}), element.find({"nz"})};
        const std::array uv = {element.find({"s", "u", "texture_u"}),
                               element.find({"t", "v", "texture_v"})};
        if (!position[0] || !position[1] || !position[2]) {
            place_.fail("has no vertex positions", "vertex properties x, y and z");
        }
        has_vertex_normals_ = normal[0] && normal[1] && normal[2];
        has_vertex_uvs_ = uv[0] && uv[1];
        for (std::size_t i = 0; i < element.count; ++i) {
            read_row(element);
            soup_.positions.push_back(pick<Vec3f>(position));
            if (has_vertex_normals_) soup_.normals.push_back(pick<Vec3f>(normal));
            if (has_vertex_uvs_) soup_.uvs.push_back(pick<Vec2f>(uv));
        }
    }

    void read_faces(const PlyElement& element) {
        const auto indices = element.find({"vertex_indices", "vertex_index"});
        const auto texcoord = element.find({"texcoord"});
        if (!indices) place_.fail("has faces without vertices", "a list vertex_indices");
        for (std::size_t i = 0; i < element.count; ++i) {
            read_row(element);
            add_face(values_[*indices], texcoord ? &values_[*texcoord] : nullptr);
        }
    }

    // texcoord: u and v of each corner, or null.
    void add_face(const std::vector<double>& indices, const std::vector<double>* texcoord) {
        const bool has_texcoord = texcoord != nullptr && !texcoord->empty();
        if (has_texcoord && texcoord->size() != 2 * indices.size()) {
            place_.fail(fmt::format("a face has {} texture numbers", texcoord->size()),
                        fmt::format("{}", 2 * indices.size()));
        }
        for (std::size_t k = 0; k < indices.size(); ++k) {
            if (!(indices[k] >= 0 && indices[k] < double(kNoIndex))) {
                place_.fail(fmt::format("a face uses vertex {}", indices[k]), "an index from 0");
            }
            const auto vertex = static_cast<std::uint32_t>(indices[k]);
            PolygonCorner corner{vertex, kNoIndex, kNoIndex};
            if (has_vertex_normals_) corner.normal = vertex;
            if (has_texcoord) {
                corner.uv = static_cast<std::uint32_t>(soup_.uvs.size());
                soup_.uvs.emplace_back(static_cast<float>((*texcoord)[2 * k]),
                                       static_cast<float>((*texcoord)[2 * k + 1]));
            } else if (has_vertex_uvs_) {
                corner.uv = vertex;
            }
            soup_.corners.push_back(corner);
        }
        soup_.polygon_ends.push_back(soup_.corners.size());
    }

    std::string_view rest_;
    const MeshPlace& place_;
    PlyFormat format_ = PlyFormat::ascii;
    std::vector<PlyElement> elements_;
    std::vector<std::vector<double>> values_;
    PolygonSoup soup_;
    bool has_vertex_normals_ = false;
    bool has_vertex_uvs_ = false;
};

void append_u32(std::string& out, std::uint32_t value) {
    std::array<char, 4> bytes;
    for (std::size_t k = 0; k < bytes.size(); ++k) {
        bytes[k] = static_cast<char>((value >> (8 * k)) & 0xffu);
    }
    out.append(bytes.data(), bytes.size());
}

template <typename Vector>
void append_floats(std::string& out, const Vector& values) {
    for (const float value : values) append_u32(out, std::bit_cast<std::uint32_t>(value));
}

}  // namespace

PolygonSoup parse_ply(const std::string& contents, const MeshPlace& place) {
    return PlyParser(contents, place).parse();
}

void write_ply(const std::filesystem::path& path, const Mesh& mesh) {
    std::string out = "ply\nformat binary_little_endian 1.0\n";
    out += fmt::format("element vertex {}\n", mesh.positions.size());
    out += "property float x\nproperty float y\nproperty float z\n";
    if (!mesh.normals.empty()) out += "property float nx\nproperty float ny\nproperty float nz\n";
    if (!mesh.uvs.empty()) out += "property float s\nproperty float t\n";
    out += fmt::format("element face {}\n", mesh.triangles.size());
    out += "property list uchar int vertex_indices\nend_header\n";
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        append_floats(out, mesh.positions[i]);
        if (!mesh.normals.empty()) append_floats(out, mesh.normals[i]);
        if (!mesh.uvs.empty()) append_floats(out, mesh.uvs[i]);
    }
    for (const Triangle& t : mesh.triangles) {
        out.push_back(3);
        for (const std::uint32_t vertex : t) append_u32(out, vertex);
    }
    write_file(path, out);
}

}  // namespace patina
