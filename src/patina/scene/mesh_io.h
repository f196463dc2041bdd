// Reading and writing of mesh files.
#pragma once

#include "patina/scene/mesh.h"

#include <filesystem>
#include <string>

namespace patina {

// Reads .obj, .ply (ascii, binary of both byte orders), .gltf or .glb. Everything in the file
// becomes one mesh: shapes and primitives are joined, node transforms applied, polygons
// triangulated, vertices with several uvs or normals split, unused vertices dropped. uvs are v-up
// whatever the file says. Throws Error(path, field, ...) when the file is missing, truncated, of
// another kind, empty of triangles, or holds indices out of range or numbers that are not finite.
// Does not judge uvs beyond [0,1], overlapping charts or triangles without area. field: where the
// caller found the name.
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path, const std::string& field = "");

// Binary little endian PLY with normals (nx ny nz) and uvs (s t) where the mesh has them; equal
// meshes give equal bytes. Throws WorkFailed when the disk refuses.
void write_ply(const std::filesystem::path& path, const Mesh& mesh);

// Wavefront OBJ without materials; numbers are written so that they read back exactly.
void write_obj(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace patina
