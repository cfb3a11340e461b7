#include "pipeline/mapping/mesh.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

#include "pipeline/mapping/cube_triangles.hpp"
#include "pipeline/mapping/integrate.hpp"
#include "tests/pipeline/mapping/rendered_view.hpp"

namespace povslam {
namespace {

// Exact distances to a ball, far enough around it.
Volume ball_volume(double radius_m, const Eigen::Vector3d& centre = Eigen::Vector3d::Zero()) {
  Volume volume({.voxel_size_m = 0.05, .truncation_m = 0.2, .max_blocks = 1000});
  for (int k = 0; k < 6 * 6 * 6; ++k) {
    const BlockKey key{k % 6 - 3, k / 6 % 6 - 3, k / 36 - 3};
    VoxelBlock& block = volume.block(volume.allocate(key));
    for (std::size_t v = 0; v < kBlockVoxels; ++v) {
      const auto i = static_cast<int>(v);
      const Eigen::Vector3d p = 0.05 * (8.0 * Eigen::Vector3d(key.x, key.y, key.z) +
                                        Eigen::Vector3d(i % 8 + 0.5, i / 8 % 8 + 0.5, i / 64 + 0.5));
      const double distance = std::clamp(((p - centre).norm() - radius_m) / 0.2, -1.0, 1.0);
      block.distance[v] = static_cast<std::int16_t>(std::lround(distance * kDistanceUnits));
      block.weight[v] = kWeightUnits;
      block.color[3 * v] = p.x() > 0.0 ? 250 : 10;
    }
  }
  return volume;
}

Mesh mesh_of(const Volume& volume) {
  MeshCache cache;
  cache.update(volume);
  Mesh mesh;
  cache.append_to(mesh, {});
  return mesh;
}

using Place = std::tuple<float, float, float>;
Place place(const Eigen::Vector3f& p) {
  return {p.x(), p.y(), p.z()};
}

// Directed edges between places that no triangle runs along the other way.
int open_edges(const Mesh& mesh) {
  std::map<std::pair<Place, Place>, int> balance;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Place a = place(mesh.vertices[t[k]]), b = place(mesh.vertices[t[(k + 1) % 3]]);
      if (a < b) ++balance[{a, b}];
      if (b < a) --balance[{b, a}];
    }
  }
  int open = 0;
  for (const auto& [edge, sum] : balance) open += sum != 0;
  return open;
}

double signed_volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    sum += static_cast<double>(mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]))) / 6.0;
  }
  return sum;
}

TEST(CubeTriangles, EachCrossedEdgeIsUsedAndNoOther) {
  for (int inside = 0; inside < 256; ++inside) {
    unsigned used = 0, crossed = 0;
    const CubeTriangles& triangles = cube_triangles(static_cast<std::uint8_t>(inside));
    for (int k = 0; k < triangles.count; ++k) {
      for (const std::uint8_t edge : triangles.edges[static_cast<std::size_t>(k)]) used |= 1U << edge;
    }
    for (int e = 0; e < 12; ++e) {
      const CubeEdge edge = cube_edge(e);
      EXPECT_EQ(edge.to, edge.from | 1 << edge.axis);
      if ((inside >> edge.from & 1) != (inside >> edge.to & 1)) crossed |= 1U << e;
    }
    EXPECT_EQ(used, crossed) << inside;
    EXPECT_LE(triangles.count, CubeTriangles::kMost);
  }
}

TEST(Mesh, OfABallIsClosedAndTurnedOutwards) {
  const Mesh mesh = mesh_of(ball_volume(0.7));
  ASSERT_GT(mesh.triangles.size(), 1000U);
  EXPECT_EQ(mesh.colors.size(), mesh.vertices.size());
  EXPECT_EQ(open_edges(mesh), 0);
  EXPECT_NEAR(signed_volume(mesh), 4.0 / 3.0 * M_PI * 0.343, 0.02);
  for (const Eigen::Vector3f& p : mesh.vertices) EXPECT_NEAR(p.norm(), 0.7F, 0.002F);
}

TEST(Mesh, OfAnyPatternOfVoxelsIsClosed) {
  Volume volume = ball_volume(0.7);
  std::mt19937 random(5);
  for (int index = 0; index < volume.num_blocks(); ++index) {
    const BlockKey key = volume.key(index);
    for (std::size_t v = 0; v < kBlockVoxels; ++v) {
      volume.block(index).distance[v] = static_cast<std::int16_t>(1 + random() % 30000);
      const bool inner = key.x >= -2 && key.x < 2 && key.y >= -2 && key.y < 2 && key.z >= -2 && key.z < 2;
      if (inner && random() % 2 == 0) volume.block(index).distance[v] *= -1;
    }
  }
  const Mesh mesh = mesh_of(volume);
  EXPECT_GT(mesh.triangles.size(), 50000U);
  EXPECT_EQ(open_edges(mesh), 0);
}

TEST(Mesh, ColoursAreThoseOfTheVoxelsAround) {
  const Mesh mesh = mesh_of(ball_volume(0.7));
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    if (mesh.vertices[k].x() > 0.05F) {
      EXPECT_EQ(mesh.colors[k][0], 250);
    }
    if (mesh.vertices[k].x() < -0.05F) {
      EXPECT_EQ(mesh.colors[k][0], 10);
    }
  }
}

TEST(Mesh, HasNothingWhereAVoxelWasNeverSeen) {
  Volume volume = ball_volume(0.7);
  for (int index = 0; index < volume.num_blocks(); ++index) {
    if (volume.key(index).x < 0) volume.block(index).weight.fill(0);
  }
  const Mesh mesh = mesh_of(volume);
  EXPECT_GT(mesh.triangles.size(), 500U);
  for (const Eigen::Vector3f& p : mesh.vertices) EXPECT_GT(p.x(), 0.02F);
}

TEST(Mesh, IsMadeAnewOnlyWhereTheVolumeChanged) {
  Volume volume = ball_volume(0.7);
  MeshCache cache;
  EXPECT_EQ(cache.update(volume), 216);
  EXPECT_EQ(cache.update(volume), 0);
  volume.mark_changed(volume.find({0, 0, 0}));
  EXPECT_EQ(cache.update(volume), 8);
  volume.mark_changed(volume.find({-3, -3, -3}));
  EXPECT_EQ(cache.update(volume), 1);
}

TEST(Mesh, OfPiecesIsTheSameAsMadeAtOnce) {
  Volume volume = ball_volume(0.7);
  MeshCache cache;
  cache.update(volume);
  const Volume other = ball_volume(0.6, {0.04, 0.02, 0.0});
  for (int index = 0; index < volume.num_blocks(); ++index) {
    if (volume.key(index).z > 0) continue;
    volume.block(index).distance = other.block(other.find(volume.key(index))).distance;
    volume.mark_changed(index);
  }
  volume.remove({1, 0, 0});
  cache.update(volume);
  Mesh mesh;
  cache.append_to(mesh, {});
  const Mesh anew = mesh_of(volume);
  EXPECT_EQ(mesh.vertices, anew.vertices);
  EXPECT_EQ(mesh.triangles, anew.triangles);
}

TEST(Mesh, IsAppendedWhereTheVolumeStands) {
  MeshCache cache;
  cache.update(ball_volume(0.7));
  Mesh mesh;
  cache.append_to(mesh, {});
  const std::size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  cache.append_to(mesh, {Eigen::Quaterniond::Identity(), {5.0, 0.0, 0.0}});
  ASSERT_EQ(mesh.vertices.size(), 2 * vertices);
  ASSERT_EQ(mesh.triangles.size(), 2 * triangles);
  EXPECT_EQ(mesh.triangles[triangles][0], mesh.triangles[0][0] + vertices);
  EXPECT_NEAR(mesh.vertices[vertices].x(), mesh.vertices[0].x() + 5.0F, 1e-5F);
}

// Distance of the farthest triangle behind the front of a box that was seen from one place only.
float deepest_behind_front_m(bool rims) {
  const Box box{{2.0, -0.33, 0.0}, {3.0, 0.33, 0.66}};
  const Wall wall{{1.0, 0.0, 0.0}, 4.5};
  Volume volume({});
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Rigid3 eye = looking({0.0, 0.0, 0.4}, {2.0, 0.0, 0.4});
    integrate(volume, render({{box, kFirstInstance}, {wall}}, eye, {.noise = 1.0, .seed = seed}), kFirstInstance, {},
              {});
  }
  MeshCache cache({.rims = rims});
  cache.update(volume);
  Mesh mesh;
  cache.append_to(mesh, {});
  EXPECT_GT(mesh.triangles.size(), 150U) << "the front is there";
  float deepest_m = 0.0F;
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t vertex : t) deepest_m = std::max(deepest_m, mesh.vertices[vertex].x() - 2.0F);
  }
  return deepest_m;
}

TEST(Mesh, WithoutRimsDoesNotFollowTheLineOfSightBehindAThing) {
  EXPECT_GT(deepest_behind_front_m(true), 0.12F);
  EXPECT_LT(deepest_behind_front_m(false), 0.08F);
}

TEST(Mesh, WithoutRimsIsWholeWhereTheSurfaceWasSeen) {
  const Ball ball{{0.3, -0.2, 0.5}, 0.4};
  Volume volume({});
  for (const double height : {1.2, 0.0, -1.2}) {
    for (const Rigid3& pose : ring(ball.centre, 1.5, height, 8)) {
      integrate(volume, render({{ball, kFirstInstance}}, pose), kFirstInstance, {}, {});
    }
  }
  MeshCache without({.rims = false});
  without.update(volume);
  Mesh mesh;
  without.append_to(mesh, {});
  EXPECT_GT(static_cast<double>(mesh.triangles.size()), 0.97 * static_cast<double>(mesh_of(volume).triangles.size()));
}

TEST(Mesh, WithoutRimsOfPiecesIsTheSameAsMadeAtOnce) {
  Volume volume = ball_volume(0.7);
  MeshCache pieces({.rims = false}), at_once({.rims = false});
  pieces.update(volume);
  std::mt19937 random(5);
  for (const BlockKey key : {BlockKey{-1, -1, 0}, {1, 0, -1}}) {
    const int index = volume.find(key);
    for (auto& distance : volume.block(index).distance) {
      distance = static_cast<std::int16_t>(std::uniform_int_distribution<int>(-kDistanceUnits, kDistanceUnits)(random));
    }
    volume.mark_changed(index);
  }
  pieces.update(volume);
  at_once.update(volume);
  Mesh a, b;
  pieces.append_to(a, {});
  at_once.append_to(b, {});
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Mesh, LosesPatchesThatAreTooSmallToBeSurfaces) {
  Mesh mesh = mesh_of(ball_volume(0.7));
  const std::size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  const Mesh speck = mesh_of(ball_volume(0.06, {0.025, 0.0, 0.0}));
  ASSERT_GE(speck.triangles.size(), 8U);
  for (const auto& t : speck.triangles) {
    mesh.triangles.push_back({t[0] + static_cast<std::uint32_t>(vertices), t[1] + static_cast<std::uint32_t>(vertices),
                              t[2] + static_cast<std::uint32_t>(vertices)});
  }
  mesh.vertices.insert(mesh.vertices.begin() + static_cast<std::ptrdiff_t>(vertices), speck.vertices.begin(),
                       speck.vertices.end());
  mesh.colors.resize(mesh.vertices.size());
  const Mesh before = mesh;
  drop_specks(mesh, 0.06);
  EXPECT_EQ(mesh.vertices.size(), vertices);
  EXPECT_EQ(mesh.triangles.size(), triangles);
  EXPECT_EQ(open_edges(mesh), 0);
  Mesh kept = before;
  drop_specks(kept, 0.03);
  EXPECT_EQ(kept.triangles, before.triangles) << "its 450 square centimetres are enough";
}

TEST(Mesh, OfAViewedBallLiesOnIt) {
  const Ball ball{{0.3, -0.2, 0.5}, 0.4};
  Volume volume({});
  for (const double height : {1.2, 0.0, -1.2}) {
    for (const Rigid3& pose : ring(ball.centre, 1.5, height, 8)) {
      integrate(volume, render({{ball, kFirstInstance, {90, 180, 30}}}, pose), kFirstInstance, {}, {});
    }
  }
  const Mesh mesh = mesh_of(volume);
  EXPECT_GT(mesh.vertices.size(), 500U);
  int off = 0;
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    off += std::abs((mesh.vertices[k].cast<double>() - ball.centre).norm() - ball.radius_m) > 0.03;
    EXPECT_NEAR(mesh.colors[k][1], 180, 2);
  }
  EXPECT_LT(off, 0.02 * static_cast<double>(mesh.vertices.size()));
}

}  // namespace
}  // namespace povslam
