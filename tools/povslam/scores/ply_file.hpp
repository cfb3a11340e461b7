// PLY meshes and point clouds (binary little endian or ascii): positions, normals and triangles, everything else is
// skipped.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "pipeline/base/result.hpp"

namespace povslam::scores {

struct PlyMesh {
  std::vector<Eigen::Vector3d> vertices;                // as in the file (metres)
  std::vector<Eigen::Vector3d> normals;                 // of the vertices, as in the file; empty if it has none
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices, all valid; polygons are cut into fans
};

// Coordinates must be finite and within 10 km. Messages name the file and the line of its header or the byte.
Result<PlyMesh> read_ply(const std::filesystem::path& path);
Result<PlyMesh> parse_ply(const std::string& content, const std::string& name);  // name: as in messages

}  // namespace povslam::scores
