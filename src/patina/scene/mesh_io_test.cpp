#include "patina/scene/mesh_io.h"

#include "patina/base/error.h"
#include "patina/base/output_file.h"
#include "patina/base/test_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstring>

namespace patina {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

double total_area(const Mesh& mesh) {
    double sum = 0;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) sum += triangle_area(mesh, t);
    return sum;
}

Mesh read_text(const TestFolder& folder, const std::string& name, const std::string& contents) {
    write_file(folder / name, contents);
    return read_mesh(folder / name, "geometry.mesh");
}

void expect_error(const std::string& name,
                  const std::string& contents,
                  const std::string& message) {
    const TestFolder folder;
    EXPECT_THAT([&] { (void)read_text(folder, name, contents); },
                testing::ThrowsMessage<Error>(
                    testing::AllOf(HasSubstr(name + ": geometry.mesh: "), HasSubstr(message))));
}

// A square of two triangles with normals and uvs.
Mesh square_mesh() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0.1f}, {1, 0, 0.2f}, {1, 1, 0.3f}, {0, 1, -1e-20f}};
    mesh.normals.assign(4, Vec3f(0, 0, 1));
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1.0f / 3}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

class WrittenMesh : public testing::TestWithParam<const char*> {
  protected:
    static void write(const fs::path& path, const Mesh& mesh) {
        path.extension() == ".ply" ? write_ply(path, mesh) : write_obj(path, mesh);
    }
};

TEST_P(WrittenMesh, ReadsBackExactly) {
    const TestFolder folder;
    const Mesh mesh = square_mesh();
    write(folder / GetParam(), mesh);
    const Mesh read = read_mesh(folder / GetParam());
    EXPECT_EQ(read.positions, mesh.positions);
    EXPECT_EQ(read.normals, mesh.normals);
    EXPECT_EQ(read.uvs, mesh.uvs);
    EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST_P(WrittenMesh, MayLackNormalsAndUvs) {
    const TestFolder folder;
    Mesh mesh = square_mesh();
    mesh.normals.clear();
    mesh.uvs.clear();
    write(folder / GetParam(), mesh);
    const Mesh read = read_mesh(folder / GetParam());
    EXPECT_TRUE(read.uvs.empty());
    EXPECT_THAT(read.normals, testing::Each(Vec3f(0, 0, 0)));
    EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST_P(WrittenMesh, IsTheSameBytesEveryTime) {
    const TestFolder folder;
    write(folder / GetParam(), square_mesh());
    const std::string first = read_file(folder / GetParam());
    write(folder / GetParam(), square_mesh());
    EXPECT_EQ(read_file(folder / GetParam()), first);
}

INSTANTIATE_TEST_SUITE_P(Formats, WrittenMesh, testing::Values("a.ply", "a.obj"));

TEST(ReadMesh, RefusesMissingEmptyAndForeignFiles) {
    const TestFolder folder;
    EXPECT_THAT([&] { (void)read_mesh(folder / "none.obj", "geometry.mesh"); },
                testing::ThrowsMessage<Error>(HasSubstr("geometry.mesh: does not exist")));
    expect_error("a.ply", "", "is empty");
    expect_error("a.stl", "solid", "is of a kind not understood (expected .obj, .ply");
}

TEST(ReadObj, SplitsVerticesTriangulatesAndCountsFromTheEnd) {
    const TestFolder folder;
    const Mesh mesh = read_text(folder,
                                "a.obj",
                                "# comment\nmtllib none.mtl\no thing\n"
                                "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\n"
                                "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.5\n"
                                "f 1/1 2/2 3/3 4/4\r\n"
                                "f 2/5 5/2 -3/-3\n");
    EXPECT_EQ(mesh.triangles.size(), 3u);
    // Vertex 2 has two uvs; vertices 1, 3, 4 and 5 one each.
    EXPECT_EQ(mesh.positions.size(), 6u);
    EXPECT_NEAR(total_area(mesh), 1.5, 1e-6);
}

TEST(ReadObj, TriangulatesPolygonsThatAreNotConvex) {
    const TestFolder folder;
    // An arrow head of area 2 - 1 whose first corner is the notch's neighbour.
    const Mesh mesh = read_text(folder, "a.obj", "v 0 0 0\nv 1 1 0\nv 2 0 0\nv 1 2 0\nf 1 2 3 4\n");
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_NEAR(total_area(mesh), 1, 1e-6);
    for (std::uint32_t t = 0; t < 2; ++t) {
        EXPECT_EQ(surface_point(mesh, t, Vec2f(0, 0)).geometric_normal, Vec3(0, 0, 1));
    }
}

TEST(ReadObj, NamesLineAndFault) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    expect_error("a.obj", vertices, "has no faces");
    expect_error("a.obj", "v 0 0\n", "line 1 has '' (expected 3 numbers)");
    expect_error("a.obj", vertices + "v 1 2 x\n", "line 4 has 'x'");
    expect_error("a.obj", vertices + "f 1 2\n", "a face has 2 corners");
    expect_error("a.obj", vertices + "f 1 2 4\n", "a face uses vertex 3 (expected indices from 0");
    expect_error("a.obj", vertices + "f 1 2 0\n", "line 4 has the corner '0'");
    expect_error("a.obj", vertices + "f 1 2 -4\n", "line 4 has the corner '-4'");
    expect_error("a.obj", vertices + "f 1/1 2/2 3/3\n", "a face uses texture coordinate 0");
    expect_error("a.obj", vertices + "v nan 0 0\nf 1 2 3\n", "vertex 3 is not finite");
    expect_error("a.obj", vertices + "\x01\x02\n", "line 4 begins with");
    expect_error("a.obj",
                 vertices + "vt 0 0\nf 1/1 2/1 3/1\nf 1 2 3\n",
                 "only some faces have texture coordinates");
}

TEST(ReadObj, RefusesPolygonsOfEndlessWork) {
    std::string ring;
    std::string face = "f";
    for (int i = 1; i <= 1025; ++i) {
        ring += fmt::format("v {} {} 0\n", std::cos(0.006 * i), std::sin(0.006 * i));
        face += fmt::format(" {}", i);
    }
    expect_error("a.obj", ring + face + "\n", "a face has 1025 corners (expected from 3 to 1024)");
}

TEST(ReadPly, ReadsAsciiWithOtherPropertiesAndElements) {
    const TestFolder folder;
    const Mesh mesh = read_text(folder,
                                "a.ply",
                                "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\n"
                                "element camera 1\r\nproperty float fov\r\n"
                                "element vertex 4\r\nproperty double x\r\nproperty double y\r\n"
                                "property double z\r\nproperty uchar red\r\n"
                                "property float texture_u\r\nproperty float texture_v\r\n"
                                "element face 1\r\nproperty uchar flags\r\n"
                                "property list uchar int vertex_index\r\nend_header\r\n"
                                "45\r\n0 0 0 9 0 0\r\n1 0 0 9 1 0\r\n1 1 0 9 1 1\r\n0 1 0 9 0 1\r\n"
                                "7 4 0 1 2 3\r\n");
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.uvs.size(), 4u);
    EXPECT_NEAR(total_area(mesh), 1, 1e-6);
}

TEST(ReadPly, TakesTexcoordListsOfFaces) {
    const TestFolder folder;
    const Mesh mesh = read_text(folder,
                                "a.ply",
                                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                "property float y\nproperty float z\nelement face 2\n"
                                "property list uchar int vertex_indices\n"
                                "property list uchar float texcoord\nend_header\n"
                                "0 0 0\n1 0 0\n0 1 0\n"
                                "3 0 1 2 6 0 0 1 0 0 1\n3 0 2 1 6 0 0 0 1 0.5 0.5\n");
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.positions.size(), 4u);  // vertex 1 has two uvs
}

std::string big_endian(const std::string& little, std::size_t size) {
    std::string result = little;
    for (std::size_t i = 0; i + size <= result.size(); i += size) {
        std::reverse(result.begin() + std::ptrdiff_t(i), result.begin() + std::ptrdiff_t(i + size));
    }
    return result;
}

TEST(ReadPly, ReadsEitherByteOrder) {
    const TestFolder folder;
    write_ply(folder / "little.ply", square_mesh());
    std::string contents = read_file(folder / "little.ply");
    const std::string mark = "end_header\n";
    const std::size_t data = contents.find(mark) + mark.size();
    constexpr std::size_t kVertexBytes = 4 * 8 * 4;  // 4 vertices of 8 floats
    std::string out = contents.substr(0, data);
    out.replace(out.find("little"), 6, "big");
    out += big_endian(contents.substr(data, kVertexBytes), 4);
    for (std::size_t face = data + kVertexBytes; face < contents.size(); face += 13) {
        out += contents[face] + big_endian(contents.substr(face + 1, 12), 4);
    }
    const Mesh mesh = read_text(folder, "big.ply", out);
    EXPECT_EQ(mesh.positions, square_mesh().positions);
    EXPECT_EQ(mesh.uvs, square_mesh().uvs);
    EXPECT_EQ(mesh.triangles, square_mesh().triangles);
}

TEST(ReadPly, IsAnErrorWhereverItIsCut) {
    const TestFolder folder;
    write_ply(folder / "a.ply", square_mesh());
    const std::string contents = read_file(folder / "a.ply");
    for (std::size_t size = 0; size < contents.size(); ++size) {
        write_file(folder / "cut.ply", contents.substr(0, size));
        EXPECT_THROW((void)read_mesh(folder / "cut.ply"), Error) << size;
    }
}

TEST(ReadPly, NamesTheFault) {
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    expect_error("a.ply", "plyx\n", "has the header line");
    expect_error("a.ply", "ply\nformat ascii 1.0\nelement vertex many\n", "'element vertex many'");
    expect_error("a.ply", "ply\nformat ascii 1.0\n", "ends within its header");
    expect_error("a.ply", head + "0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", "vertex 2 is not finite");
    expect_error("a.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a face uses vertex 3");
    expect_error("a.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "a face uses vertex -1");
    expect_error("a.ply", head + "0 0 0\n1 0 0\n", "is damaged or truncated");
    expect_error(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 999999999999\nproperty float x\nend_header\n",
        "is damaged or truncated");
}

// A triangle (0,0,0), (1,0,0), (0,1,0) with uvs, then its indices; 3 * 12 + 3 * 8 + 3 * 2 bytes.
std::string triangle_buffer(std::uint16_t last_index = 2) {
    const std::array<float, 15> floats = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25f, 0.25f, 1, 0, 0, 1};
    const std::array<std::uint16_t, 3> indices = {0, 1, last_index};
    std::string bytes(sizeof floats + sizeof indices, '\0');
    std::memcpy(bytes.data(), floats.data(), sizeof floats);
    std::memcpy(bytes.data() + sizeof floats, indices.data(), sizeof indices);
    return bytes;
}

// node: further members of the only node.
std::string triangle_gltf(const std::string& node, const std::string& extra = "") {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" +
           node + R"(}],"buffers":[{"uri":"a.bin","byteLength":66}],"bufferViews":[
        {"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},
        {"buffer":0,"byteOffset":60,"byteLength":6}],"accessors":[
        {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
        {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},
        {"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2}]}])" +
           extra + "}";
}

TEST(ReadGltf, FlipsVAndAppliesTheNode) {
    const TestFolder folder;
    write_file(folder / "a.bin", triangle_buffer());
    const Mesh mesh =
        read_text(folder, "a.gltf", triangle_gltf(R"(,"translation":[5,0,0],"scale":[2,2,2])"));
    ASSERT_EQ(mesh.positions.size(), 3u);
    EXPECT_EQ(mesh.positions[1], Vec3f(7, 0, 0));
    EXPECT_EQ(mesh.uvs[0], Vec2f(0.25f, 0.75f));
    EXPECT_EQ(surface_point(mesh, 0, Vec2f(0, 0)).geometric_normal, Vec3(0, 0, 1));
}

TEST(ReadGltf, MirroredNodesKeepTheOutside) {
    const TestFolder folder;
    write_file(folder / "a.bin", triangle_buffer());
    const Mesh mesh = read_text(folder, "a.gltf", triangle_gltf(R"(,"scale":[-1,1,1])"));
    EXPECT_EQ(surface_point(mesh, 0, Vec2f(0, 0)).geometric_normal, Vec3(0, 0, 1));
}

void append_u32(std::string& out, std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8)
        out.push_back(static_cast<char>(value >> shift & 255));
}

TEST(ReadGltf, ReadsTheBinaryForm) {
    const TestFolder folder;
    std::string json = triangle_gltf("");
    const std::string uri = R"("uri":"a.bin",)";
    json.erase(json.find(uri), uri.size());
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string buffer = triangle_buffer();
    buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
    std::string glb = "glTF";
    append_u32(glb, 2);
    append_u32(glb, 12 + 8 + json.size() + 8 + buffer.size());
    append_u32(glb, json.size());
    glb += "JSON" + json;
    append_u32(glb, buffer.size());
    glb += std::string("BIN\0", 4) + buffer;
    EXPECT_NEAR(total_area(read_text(folder, "a.glb", glb)), 0.5, 1e-6);
    for (std::size_t size = 1; size < glb.size(); size += 7) {
        EXPECT_THROW((void)read_text(folder, "cut.glb", glb.substr(0, size)), Error) << size;
    }
}

TEST(ReadGltf, NamesTheFault) {
    expect_error("a.gltf", "{", "cannot be read");
    expect_error("a.gltf", triangle_gltf(""), "cannot be read");  // a.bin is missing
    const TestFolder folder;
    const auto expect_fault = [&](const std::string& json, const std::string& message) {
        EXPECT_THAT([&] { (void)read_text(folder, "b.gltf", json); },
                    testing::ThrowsMessage<Error>(HasSubstr(message)));
    };
    write_file(folder / "a.bin", triangle_buffer(3));
    expect_fault(triangle_gltf(""), "a face uses vertex 3");
    write_file(folder / "a.bin", triangle_buffer());
    expect_fault(triangle_gltf(R"(,"children":[0])"), "uses node 0 twice");
    expect_fault(triangle_gltf("", R"(,"extensionsRequired":["KHR_draco_mesh_compression"])"),
                 "requires the extension KHR_draco_mesh_compression");
    std::string too_long = triangle_gltf("");
    too_long.replace(too_long.find(R"("count":3)"), 9, R"("count":9)");
    expect_fault(too_long, "leaves its buffer");
}

TEST(ReadGltf, FollowsNodesHoweverDeep) {
    const TestFolder folder;
    write_file(folder / "a.bin", triangle_buffer());
    constexpr int kNumNodes = 100'000;
    std::string nodes = R"({"children":[1]})";
    for (int i = 2; i < kNumNodes; ++i) nodes += fmt::format(R"(,{{"children":[{}]}})", i);
    std::string json = triangle_gltf("");
    const std::string only_node = R"({"mesh":0})";
    json.replace(json.find(only_node), only_node.size(), nodes + "," + only_node);
    EXPECT_EQ(read_text(folder, "a.gltf", json).triangles.size(), 1u);
}

TEST(ReadGltf, RefusesDeepNesting) {
    const std::string lists(100'000, '[');
    const std::string ends(100'000, ']');
    expect_error("a.gltf",
                 triangle_gltf("", R"(,"extras":)" + lists + ends),
                 "is nested too deeply (expected 256 levels)");
    // Brackets in a text are not structure, whether they open or close.
    expect_error("a.gltf", triangle_gltf("", R"(,"extras":"\")" + lists + "\""), "cannot be read");
}

TEST(ReadGltf, BuffersMayNotLeaveTheFolder) {
    const TestFolder folder;
    write_file(folder / "a.bin", triangle_buffer());
    fs::create_directory(folder / "inner");
    const auto expect_refused = [&](const std::string& uri) {
        std::string json = triangle_gltf("");
        json.replace(json.find("a.bin"), 5, uri);
        EXPECT_THAT([&] { (void)read_text(folder, "inner/a.gltf", json); },
                    testing::ThrowsMessage<Error>(HasSubstr("cannot be read")))
            << uri;
    };
    expect_refused("../a.bin");
    expect_refused((folder / "a.bin").string());
    fs::create_symlink("../a.bin", folder / "inner/link.bin");
    expect_refused("link.bin");
}

TEST(ReadGltf, RefusesAnEmptyBuffer) {
    std::string json = triangle_gltf("");
    json.replace(json.find(R"("uri":"a.bin","byteLength":66)"), 30, R"("byteLength":0)");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string glb = "glTF";
    append_u32(glb, 2);
    append_u32(glb, 12 + 8 + json.size() + 8 + 4);
    append_u32(glb, json.size());
    glb += "JSON" + json;
    append_u32(glb, 4);
    glb += std::string("BIN\0", 4) + std::string(4, '\0');
    expect_error("a.glb", glb, "cannot be read");
}

}  // namespace
}  // namespace patina
