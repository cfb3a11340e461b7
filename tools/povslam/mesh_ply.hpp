// A mesh as binary little-endian PLY: vertices in world metres with colours, triangles.
#pragma once

#include <filesystem>

#include "pipeline/base/result.hpp"
#include "pipeline/mapping/mesh.hpp"

namespace povslam {

Status write_mesh_ply(const std::filesystem::path& file, const Mesh& mesh);

}  // namespace povslam
