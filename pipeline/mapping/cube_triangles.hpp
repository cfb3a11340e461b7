// The triangles of marching cubes (Lorensen and Cline 1987) for each pattern of corners, not from a printed table but
// traced: around each face of the cube the crossed edges are joined so that corners inside (negative distance) are cut
// off one by one where they touch across a face. That depends on the face alone, so neighbouring cubes agree and the
// surface has no holes.
#pragma once

#include <array>
#include <cstdint>

namespace povslam {

// Corner c of a cube lies at (c & 1, c >> 1 & 1, c >> 2). Edge e runs along axis e / 4, from corner cube_edge(e).
struct CubeEdge {
  std::uint8_t from, to, axis;  // corners; from the lower one
};
CubeEdge cube_edge(int edge);  // 0 … 11

struct CubeTriangles {
  static constexpr int kMost = 10;
  std::uint8_t count = 0;
  std::array<std::array<std::uint8_t, 3>, kMost> edges{};  // counter-clockwise seen from the positive side
};
// Bit c of `inside`: corner c has a negative distance.
const CubeTriangles& cube_triangles(std::uint8_t inside);

}  // namespace povslam
