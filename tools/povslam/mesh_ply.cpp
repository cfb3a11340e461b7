#include "tools/povslam/mesh_ply.hpp"

#include <bit>
#include <cstring>
#include <fstream>

namespace povslam {

Status write_mesh_ply(const std::filesystem::path& file, const Mesh& mesh) {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::size_t kVertexBytes = 15, kTriangleBytes = 13;
  std::string bytes(mesh.vertices.size() * kVertexBytes + mesh.triangles.size() * kTriangleBytes, '\0');
  char* at = bytes.data();
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i, at += kVertexBytes) {
    std::memcpy(at, mesh.vertices[i].data(), 12);
    std::memcpy(at + 12, mesh.colors[i].data(), 3);
  }
  for (const auto& triangle : mesh.triangles) {
    *at = 3;
    std::memcpy(at + 1, triangle.data(), 12);
    at += kTriangleBytes;
  }
  std::ofstream out(file, std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\ncomment povslam map, world frame, metres\nelement vertex "
      << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar uint vertex_indices\nend_header\n"
      << bytes;
  out.close();
  if (!out) return Error{file.string() + ": cannot be written; is the disk full?"};
  return Done{};
}

}  // namespace povslam
