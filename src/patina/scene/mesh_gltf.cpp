// glTF 2.0, text and binary, through tinygltf, which only this file includes.
#include "patina/base/output_file.h"
#include "patina/scene/polygon_soup.h"

#include <fmt/format.h>

#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <tiny_gltf.h>

namespace patina {
namespace {

namespace fs = std::filesystem;
using Affine = Eigen::Affine3d;

// Brackets of JSON within each other; far more than glTF and its extensions need.
constexpr std::size_t kMaxDepth = 256;

// Extensions a file may require that do not change where the surface is.
bool is_harmless(std::string_view extension) {
    return extension.starts_with("KHR_materials_") || extension.starts_with("KHR_texture_") ||
           extension == "KHR_mesh_quantization" || extension == "KHR_lights_punctual";
}

class GltfParser {
  public:
    GltfParser(const tinygltf::Model& model, const MeshPlace& place)
        : model_(model), place_(place), visited_(model.nodes.size(), false) {}

    PolygonSoup parse() {
        for (const std::string& extension : model_.extensionsRequired) {
            if (!is_harmless(extension)) {
                place_.fail("requires the extension " + extension, "plain glTF 2.0 geometry");
            }
        }
        if (model_.scenes.empty()) place_.fail("has no scene", "a scene with a mesh");
        const int scene = std::max(model_.defaultScene, 0);
        add_nodes(at(model_.scenes, scene, "scene").nodes);
        return std::move(soup_);
    }

  private:
    template <typename Item>
    const Item& at(const std::vector<Item>& items, int index, const char* what) const {
        if (index < 0 || std::size_t(index) >= items.size()) {
            place_.fail(fmt::format("uses {} {}", what, index),
                        fmt::format("indices from 0 to below {}", items.size()));
        }
        return items[std::size_t(index)];
    }

    static Affine transform_of(const tinygltf::Node& node) {
        Affine transform = Affine::Identity();
        if (node.matrix.size() == 16) {
            transform.matrix() = Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
            return transform;
        }
        if (node.translation.size() == 3) transform.translate(Vec3(node.translation.data()));
        if (node.rotation.size() == 4) {
            const auto& q = node.rotation;
            transform.rotate(Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized());
        }
        if (node.scale.size() == 3) transform.scale(Vec3(node.scale.data()));
        return transform;
    }

    struct PendingNode {
        int index;
        Affine world_from_parent;
    };

    // Parents before their children, children in their order; by hand, as a file may nest its nodes
    // deeper than the stack reaches.
    void add_nodes(const std::vector<int>& roots) {
        std::vector<PendingNode> pending;
        const auto push = [&pending](const std::vector<int>& nodes, const Affine& transform) {
            for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
                pending.push_back({*node, transform});
            }
        };
        push(roots, Affine::Identity());
        while (!pending.empty()) {
            const auto [index, world_from_parent] = pending.back();
            pending.pop_back();
            const tinygltf::Node& node = at(model_.nodes, index, "node");
            if (visited_[std::size_t(index)]) {
                place_.fail(fmt::format("uses node {} twice", index), "nodes that form a tree");
            }
            visited_[std::size_t(index)] = true;
            const Affine world_from_node = world_from_parent * transform_of(node);
            if (node.mesh >= 0) {
                for (const auto& primitive : at(model_.meshes, node.mesh, "mesh").primitives) {
                    add_primitive(primitive, world_from_node);
                }
            }
            push(node.children, world_from_node);
        }
    }

    // One component as glTF stores it; integers count from 0 to 1 (or -1 to 1) where normalised.
    double component(const unsigned char* bytes, const tinygltf::Accessor& accessor) const {
        const auto load = [&]<typename Number>(Number number) {
            std::memcpy(&number, bytes, sizeof number);
            if constexpr (std::is_integral_v<Number>) {
                if (accessor.normalized) {
                    return std::max(double(number) / std::numeric_limits<Number>::max(), -1.0);
                }
            }
            return double(number);
        };
        switch (accessor.componentType) {
            case TINYGLTF_COMPONENT_TYPE_BYTE:
                return load(std::int8_t{});
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return load(std::uint8_t{});
            case TINYGLTF_COMPONENT_TYPE_SHORT:
                return load(std::int16_t{});
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                return load(std::uint16_t{});
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
                return load(std::uint32_t{});
            default:
                return load(float{});
        }
    }

    // accessor.count rows of `columns` numbers each, bounds checked against the buffer.
    std::vector<double> read_accessor(int index, int columns) const {
        const tinygltf::Accessor& accessor = at(model_.accessors, index, "accessor");
        if (accessor.sparse.isSparse) place_.fail("has sparse accessors", "dense ones");
        if (tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type)) != columns) {
            place_.fail(fmt::format("accessor {} has the wrong type", index),
                        fmt::format("{} components", columns));
        }
        const auto& view = at(model_.bufferViews, accessor.bufferView, "bufferView");
        const auto& buffer = at(model_.buffers, view.buffer, "buffer").data;
        const int component_size =
            tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType));
        const int stride = accessor.ByteStride(view);
        const std::size_t row_size =
            std::size_t(std::max(component_size, 0)) * std::size_t(columns);
        const std::size_t begin = view.byteOffset + accessor.byteOffset;
        const bool fits =
            component_size > 0 && stride > 0 && begin <= buffer.size() &&
            accessor.count <= buffer.size() &&
            (accessor.count == 0 ||
             (accessor.count - 1) * std::size_t(stride) + row_size <= buffer.size() - begin);
        if (!fits)
            place_.fail(fmt::format("accessor {} leaves its buffer", index), "complete data");
        std::vector<double> values;
        values.reserve(accessor.count * std::size_t(columns));
        for (std::size_t row = 0; row < accessor.count; ++row) {
            const unsigned char* bytes = buffer.data() + begin + row * std::size_t(stride);
            for (int k = 0; k < columns; ++k) {
                values.push_back(component(bytes + k * component_size, accessor));
            }
        }
        return values;
    }

    std::vector<std::uint32_t> read_indices(const tinygltf::Primitive& primitive,
                                            std::size_t num_vertices) const {
        std::vector<std::uint32_t> indices;
        if (primitive.indices < 0) {
            for (std::uint32_t i = 0; i < num_vertices; ++i) indices.push_back(i);
            return indices;
        }
        for (const double value : read_accessor(primitive.indices, 1)) {
            if (!(value >= 0 && value < double(num_vertices))) {
                place_.fail(fmt::format("a face uses vertex {}", value),
                            fmt::format("indices from 0 to below {}", num_vertices));
            }
            indices.push_back(static_cast<std::uint32_t>(value));
        }
        return indices;
    }

    std::vector<double> read_attribute(const tinygltf::Primitive& primitive,
                                       const char* name,
                                       int columns,
                                       std::size_t num_vertices) const {
        const auto found = primitive.attributes.find(name);
        if (found == primitive.attributes.end()) return {};
        std::vector<double> values = read_accessor(found->second, columns);
        if (values.size() != num_vertices * std::size_t(columns)) {
            place_.fail(fmt::format("{} has another length than POSITION", name),
                        "the same length");
        }
        return values;
    }

    void add_primitive(const tinygltf::Primitive& primitive, const Affine& world_from_node) {
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) place_.fail("has no POSITION", "positions");
        const std::vector<double> positions = read_accessor(position->second, 3);
        const std::size_t count = positions.size() / 3;
        const std::vector<double> normals = read_attribute(primitive, "NORMAL", 3, count);
        const std::vector<double> uvs = read_attribute(primitive, "TEXCOORD_0", 2, count);
        const std::vector<std::uint32_t> indices = read_indices(primitive, count);

        const Mat3 linear = world_from_node.linear();
        const bool mirrored = linear.determinant() < 0;
        // Cofactors turn normals also where the transform is flat, up to the sign of a mirror.
        Mat3 cofactors;
        cofactors << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)),
            linear.col(0).cross(linear.col(1));
        if (mirrored) cofactors = -cofactors;

        const auto first_position = static_cast<std::uint32_t>(soup_.positions.size());
        const auto first_normal = static_cast<std::uint32_t>(soup_.normals.size());
        const auto first_uv = static_cast<std::uint32_t>(soup_.uvs.size());
        for (std::size_t i = 0; i < count; ++i) {
            soup_.positions.push_back((world_from_node * Vec3(&positions[3 * i])).cast<float>());
            if (!normals.empty()) {
                soup_.normals.push_back((cofactors * Vec3(&normals[3 * i])).cast<float>());
            }
            // v runs down in glTF.
            if (!uvs.empty())
                soup_.uvs.push_back(Vec2(uvs[2 * i], 1 - uvs[2 * i + 1]).cast<float>());
        }
        for (std::array<std::uint32_t, 3> t : triangles_of(primitive.mode, indices)) {
            if (mirrored) std::swap(t[1], t[2]);
            for (const std::uint32_t vertex : t) {
                soup_.corners.push_back({first_position + vertex,
                                         uvs.empty() ? kNoIndex : first_uv + vertex,
                                         normals.empty() ? kNoIndex : first_normal + vertex});
            }
            soup_.polygon_ends.push_back(soup_.corners.size());
        }
    }

    std::vector<std::array<std::uint32_t, 3>> triangles_of(
        int mode, const std::vector<std::uint32_t>& indices) const {
        std::vector<std::array<std::uint32_t, 3>> triangles;
        // tinygltf leaves -1 where the file says nothing, which means triangles.
        if (mode == TINYGLTF_MODE_TRIANGLES || mode < 0) {
            if (indices.size() % 3 != 0) {
                place_.fail(fmt::format("has {} triangle corners", indices.size()),
                            "a multiple of 3");
            }
            for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
                triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
            }
        } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            for (std::size_t i = 0; i + 2 < indices.size(); ++i) {
                const std::size_t odd = i % 2;
                triangles.push_back({indices[i], indices[i + 1 + odd], indices[i + 2 - odd]});
            }
        } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
            for (std::size_t i = 1; i + 1 < indices.size(); ++i) {
                triangles.push_back({indices[0], indices[i], indices[i + 1]});
            }
        } else {
            place_.fail("has points or lines", "triangles");
        }
        return triangles;
    }

    const tinygltf::Model& model_;
    const MeshPlace& place_;
    std::vector<bool> visited_;
    PolygonSoup soup_;
};

std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

// Textures are of no interest, and may be missing.
bool skip_image(tinygltf::Image*,
                const int,
                std::string*,
                std::string*,
                int,
                int,
                const unsigned char*,
                int,
                void*) {
    return true;
}

// How a glTF reaches the files beside it, the .bin of its buffers: user_data is the mesh's folder,
// which no path may leave (tinygltf itself would look in the working folder, too).
bool lies_beside(const std::string& path, void* user_data) {
    const auto& folder = *static_cast<const fs::path*>(user_data);
    std::error_code code;
    const fs::path file = fs::canonical(path, code);
    if (code || !fs::is_regular_file(file, code)) return false;
    const fs::path root = fs::canonical(folder, code);
    return std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first == root.end();
}

bool read_beside(std::vector<unsigned char>* out, std::string*, const std::string& path, void*) {
    const std::string contents = read_file(path);
    out->assign(contents.begin(), contents.end());
    return true;
}

std::string keep_path(const std::string& path, void*) { return path; }

// The JSON of a text or binary glTF: all of the first, the first chunk of the second.
std::string_view json_of(std::string_view contents) {
    constexpr std::size_t kLengthBegin = 12;  // after magic, version and length of the whole
    constexpr std::size_t kJsonBegin = 20;    // after length and type of the chunk
    if (!contents.starts_with("glTF") || contents.size() < kJsonBegin) return contents;
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < sizeof length; ++i) {
        const auto byte = static_cast<unsigned char>(contents[kLengthBegin + i]);
        length |= std::uint32_t{byte} << (8 * i);
    }
    return contents.substr(kJsonBegin, length);
}

// Whether lists and objects of a JSON text lie in each other more than kMaxDepth times: tinygltf
// copies free-form parts of the document by recursion.
bool is_nested_too_deeply(std::string_view json) {
    std::size_t depth = 0;
    bool in_text = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (in_text && c == '\\') {
            ++i;
        } else if (c == '"') {
            in_text = !in_text;
        } else if (!in_text && (c == '[' || c == '{')) {
            if (++depth > kMaxDepth) return true;
        } else if (!in_text && (c == ']' || c == '}') && depth > 0) {
            --depth;
        }
    }
    return false;
}

// False, with the problem, where the file is damaged; tinygltf lets some faults out as exceptions.
bool load_model(tinygltf::TinyGLTF& loader,
                const std::string& contents,
                const fs::path& folder,
                tinygltf::Model& model,
                std::string& problem) {
    std::string warning;
    const auto size = static_cast<unsigned int>(contents.size());
    const auto* const bytes = reinterpret_cast<const unsigned char*>(contents.data());
    try {
        return contents.starts_with("glTF")
                   ? loader.LoadBinaryFromMemory(
                         &model, &problem, &warning, bytes, size, folder.string())
                   : loader.LoadASCIIFromString(
                         &model, &problem, &warning, contents.data(), size, folder.string());
    } catch (const std::logic_error& error) {
        problem = error.what();
    } catch (const nlohmann::json::exception& error) {
        problem = error.what();
    }
    return false;
}

}  // namespace

PolygonSoup parse_gltf(const std::string& contents, const MeshPlace& place) {
    if (is_nested_too_deeply(json_of(contents))) {
        place.fail("is nested too deeply", fmt::format("{} levels", kMaxDepth));
    }
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(skip_image, nullptr);
    fs::path folder = fs::absolute(place.path).parent_path();
    loader.SetFsCallbacks({lies_beside, keep_path, read_beside, nullptr, &folder});
    tinygltf::Model model;
    std::string problem;
    if (!load_model(loader, contents, folder, model, problem)) {
        place.fail("cannot be read: " + one_line(problem), "a complete glTF 2.0 file");
    }
    return GltfParser(model, place).parse();
}

}  // namespace patina
