#include "pipeline/mapping/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/mapping/block_patch.hpp"
#include "pipeline/mapping/cube_triangles.hpp"

namespace povslam {

namespace {

std::uint64_t packed(const BlockKey& key) {
  const auto part = [](std::int32_t value) { return static_cast<std::uint64_t>(value) & 0x1FFFFF; };
  return part(key.x) | part(key.y) << 21 | part(key.z) << 42;
}
BlockKey unpacked(std::uint64_t key) {
  const auto part = [key](int shift) {
    return static_cast<std::int32_t>(static_cast<std::int64_t>(key >> shift << 43) >> 43);
  };
  return {part(0), part(21), part(42)};
}

// Of true surfaces distances change by a voxel's size from voxel to voxel, more where they were looked at slantingly;
// from a rim's free side, where nothing is within the truncation, to its hidden one by more than this many…
constexpr double kRimStep = 5.0;
// …while from there on inwards they hardly change, as they tell of the thing's front: by less than this share of it.
constexpr double kRimFlat = 0.2;

class BlockMesher {
 public:
  BlockMesher(const BlockPatch& patch, const BlockKey& key, const VolumeOptions& volume, bool rims, Mesh& mesh)
      : patch_(patch),
        key_(key),
        voxel_size_m_(static_cast<float>(volume.voxel_size_m)),
        rim_units_(rims ? std::numeric_limits<double>::infinity()
                        : kRimStep * volume.voxel_size_m / volume.truncation_m * kDistanceUnits),
        mesh_(mesh) {
    vertex_.fill(kNone);
  }

  void run() {
    for (int z = 0; z < kBlockEdge; ++z) {
      for (int y = 0; y < kBlockEdge; ++y) {
        for (int x = 0; x < kBlockEdge; ++x) add_cell(x, y, z);
      }
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  static constexpr int kCorners = kBlockEdge + 1;

  void add_cell(int x, int y, int z) {
    unsigned inside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int cx = x + (corner & 1), cy = y + (corner >> 1 & 1), cz = z + (corner >> 2);
      if (!patch_.known(cx, cy, cz)) return;
      inside |= static_cast<unsigned>(patch_.distance(cx, cy, cz) < 0) << corner;
    }
    const CubeTriangles& triangles = cube_triangles(static_cast<std::uint8_t>(inside));
    for (int k = 0; k < triangles.count; ++k) {
      const auto on_rim = [&](std::uint8_t edge) { return is_rim(x, y, z, cube_edge(edge)); };
      if (std::ranges::any_of(triangles.edges[static_cast<std::size_t>(k)], on_rim)) continue;
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t j = 0; j < 3; ++j)
        triangle[j] = vertex(x, y, z, triangles.edges[static_cast<std::size_t>(k)][j]);
      mesh_.triangles.push_back(triangle);
    }
  }

  bool is_rim(int x, int y, int z, const CubeEdge& along) const {
    x += along.from & 1, y += along.from >> 1 & 1, z += along.from >> 2;
    const int dx = along.axis == 0, dy = along.axis == 1, dz = along.axis == 2;
    const int here = patch_.distance(x, y, z), there = patch_.distance(x + dx, y + dy, z + dz);
    const int step = std::abs(here - there);
    if (step <= rim_units_) return false;
    const int k = here < 0 ? -1 : 2;  // the next one inwards
    if (!patch_.known(x + k * dx, y + k * dy, z + k * dz)) return false;
    return std::min(here, there) - patch_.distance(x + k * dx, y + k * dy, z + k * dz) < kRimFlat * step;
  }

  std::uint32_t vertex(int x, int y, int z, int edge) {
    const CubeEdge along = cube_edge(edge);
    x += along.from & 1, y += along.from >> 1 & 1, z += along.from >> 2;
    std::uint32_t& known = vertex_[static_cast<std::size_t>(along.axis + 3 * (x + kCorners * (y + kCorners * z)))];
    if (known == kNone) {
      known = static_cast<std::uint32_t>(mesh_.vertices.size());
      add_vertex(x, y, z, along.axis);
    }
    return known;
  }

  // From the voxel's place in the whole volume, so that blocks that share an edge have the very same vertex.
  void add_vertex(int x, int y, int z, int axis) {
    const int nx = x + (axis == 0), ny = y + (axis == 1), nz = z + (axis == 2);
    const auto here = static_cast<float>(patch_.distance(x, y, z)),
               there = static_cast<float>(patch_.distance(nx, ny, nz));
    const float share = here / (here - there);
    Eigen::Vector3f at(static_cast<float>(key_.x * kBlockEdge + x), static_cast<float>(key_.y * kBlockEdge + y),
                       static_cast<float>(key_.z * kBlockEdge + z));
    at[axis] += share;
    mesh_.vertices.push_back((at + Eigen::Vector3f::Constant(0.5F)) * voxel_size_m_);
    mesh_.colors.push_back(mixed(patch_.color(x, y, z), patch_.color(nx, ny, nz), share));
  }

  // A voxel far from the surface has no colour: black.
  static std::array<std::uint8_t, 3> mixed(const std::uint8_t* here, const std::uint8_t* there, float share) {
    const auto black = [](const std::uint8_t* c) { return (c[0] | c[1] | c[2]) == 0; };
    if (black(here)) here = there;
    if (black(there)) there = here;
    std::array<std::uint8_t, 3> color{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto a = static_cast<float>(here[c]), b = static_cast<float>(there[c]);
      color[c] = static_cast<std::uint8_t>(a + (b - a) * share + 0.5F);
    }
    return color;
  }

  const BlockPatch& patch_;
  BlockKey key_;
  float voxel_size_m_;
  double rim_units_;
  Mesh& mesh_;
  std::array<std::uint32_t, 3 * kCorners * kCorners * kCorners> vertex_{};
};

}  // namespace

int MeshCache::update(const Volume& volume) {
  std::vector<BlockKey> dirty;
  // A block's triangles need its upper neighbours; what is a rim, also the lower ones.
  const int least = options_.rims ? 0 : -1;
  const auto with_neighbours = [&](const BlockKey& key) {
    for (int z = least; z <= 1; ++z) {
      for (int y = least; y <= 1; ++y) {
        for (int x = least; x <= 1; ++x) dirty.push_back({key.x - x, key.y - y, key.z - z});
      }
    }
  };
  for (int index = 0; index < volume.num_blocks(); ++index) {
    const VoxelBlock& block = volume.block(index);
    const auto piece = pieces_.find(packed(block.key));
    if (piece == pieces_.end() || piece->second.changed != block.changed) with_neighbours(block.key);
  }
  for (auto piece = pieces_.begin(); piece != pieces_.end();) {
    const BlockKey key = unpacked(piece->first);
    if (volume.find(key) >= 0) {
      ++piece;
      continue;
    }
    with_neighbours(key);
    piece = pieces_.erase(piece);
  }
  const auto by_key = [](const BlockKey& a, const BlockKey& b) { return packed(a) < packed(b); };
  std::sort(dirty.begin(), dirty.end(), by_key);
  dirty.erase(std::unique(dirty.begin(), dirty.end()), dirty.end());

  int made = 0;
  BlockPatch patch;
  for (const BlockKey& key : dirty) {
    const int index = volume.find(key);
    if (index < 0) continue;
    Piece& piece = pieces_[packed(key)];
    piece.changed = volume.block(index).changed;
    piece.mesh = Mesh{};
    if (patch.load(volume, index, options_.min_weight)) {
      BlockMesher(patch, key, volume.options(), options_.rims, piece.mesh).run();
    }
    ++made;
  }
  return made;
}

void MeshCache::append_to(Mesh& mesh, const Rigid3& T_world_volume) const {
  std::vector<std::uint64_t> keys;  // in an order of their own: the same mesh for the same volume
  keys.reserve(pieces_.size());
  for (const auto& [key, piece] : pieces_) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  const Eigen::Matrix3f rotation = T_world_volume.matrix3().cast<float>();
  const Eigen::Vector3f translation = T_world_volume.translation.cast<float>();
  for (const std::uint64_t key : keys) {
    const Mesh& piece = pieces_.at(key).mesh;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Eigen::Vector3f& p_volume : piece.vertices) mesh.vertices.push_back(rotation * p_volume + translation);
    mesh.colors.insert(mesh.colors.end(), piece.colors.begin(), piece.colors.end());
    for (const auto& t : piece.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

}  // namespace povslam
