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

struct MeshOptions {
  double min_weight = 0.05;  // looks: cells whose eight voxels were each seen at least so often
  // Whether what was hidden behind a thing is closed off against the space seen beside it. Beyond the thing's edge a
  // ray sees empty space, behind its front it sees nothing and the volume says "inside": between the two lies a surface
  // along the line of sight, as deep as the truncation, that is nobody's.
  bool rims = true;
};

// Follows one volume.
class MeshCache {
 public:
  explicit MeshCache(const MeshOptions& options = {}) : options_(options) {}
  // Returns how many blocks were made anew: those that changed and those beside them that need them.
  int update(const Volume& volume);
  void append_to(Mesh& mesh, const Rigid3& T_world_volume) const;

 private:
  struct Piece {
    std::uint32_t changed = 0;
    Mesh mesh;
  };
  MeshOptions options_;
  std::unordered_map<std::uint64_t, Piece> pieces_;
};

// Leaves out patches (triangles joined by vertices of the same place) with less surface than this: noise.
void drop_specks(Mesh& mesh, double least_area_m2);

}  // namespace povslam
