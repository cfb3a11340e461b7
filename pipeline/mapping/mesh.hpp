// Triangles of a volume's surface (marching cubes), made anew only where the volume changed.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pipeline/geometry/rigid.hpp"
#include "pipeline/mapping/volume.hpp"

namespace povslam {

struct Mesh {
  std::vector<Eigen::Vector3f> vertices;                // m
  std::vector<std::array<std::uint8_t, 3>> colors;      // R, G, B of each vertex
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from the free side
};

// Follows one volume.
class MeshCache {
 public:
  // Cells whose eight voxels were each seen at least min_weight looks.
  explicit MeshCache(double min_weight = 0.05) : min_weight_(min_weight) {}
  // Returns how many blocks were made anew: those that changed and their lower neighbours.
  int update(const Volume& volume);
  void append_to(Mesh& mesh, const Rigid3& T_world_volume) const;

 private:
  struct Piece {
    std::uint32_t changed = 0;
    Mesh mesh;
  };
  double min_weight_;
  std::unordered_map<std::uint64_t, Piece> pieces_;
};

}  // namespace povslam
