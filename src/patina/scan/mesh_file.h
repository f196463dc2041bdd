// Writes a mesh as a Wavefront OBJ file.
#pragma once

#include "patina/scene/mesh.h"

#include <filesystem>

namespace patina {

// Positions, normals and texture coordinates (the mesh must have all three), with as many digits as
// give back the same floats. Throws WorkFailed.
void write_obj(const Mesh& mesh, const std::filesystem::path& path);

}  // namespace patina
