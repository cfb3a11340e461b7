#include "pipeline/mapping/cube_triangles.hpp"

namespace povslam {

namespace {

constexpr CubeEdge make_edge(int edge) {
  const int axis = edge / 4, u = edge & 1, v = edge >> 1 & 1;
  const int low = axis == 0 ? 1 : 0, high = axis == 2 ? 1 : 2;  // the other two axes
  const int from = u << low | v << high;
  return {static_cast<std::uint8_t>(from), static_cast<std::uint8_t>(from | 1 << axis),
          static_cast<std::uint8_t>(axis)};
}

constexpr int edge_between(int a, int b) {
  for (int e = 0; e < 12; ++e) {
    const CubeEdge edge = make_edge(e);
    if ((edge.from == a && edge.to == b) || (edge.from == b && edge.to == a)) return e;
  }
  return -1;
}

// Corners of a face, counter-clockwise seen from outside.
constexpr std::array<int, 4> face_corners(int face) {
  const int axis = face / 2, side = face & 1;
  const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
  if (side == 1) return {base, base | u, base | u | v, base | v};
  return {base, base | v, base | u | v, base | u};
}

// The crossed edge that follows each one along the border of the surface within the cube; -1: not crossed.
constexpr std::array<int, 12> follow_borders(int inside) {
  std::array<int, 12> next{};
  next.fill(-1);
  for (int face = 0; face < 6; ++face) {
    const std::array<int, 4> corners = face_corners(face);
    const auto is_inside = [&](int k) { return (inside >> corners[static_cast<std::size_t>(k & 3)] & 1) != 0; };
    for (int k = 0; k < 4; ++k) {
      if (is_inside(k) || !is_inside(k + 1)) continue;
      int last = k + 1;  // of the inside corners that follow each other
      while (is_inside(last + 1)) ++last;
      const auto corner = [&](int j) { return corners[static_cast<std::size_t>(j & 3)]; };
      const int enters = edge_between(corner(k), corner(k + 1)), leaves = edge_between(corner(last), corner(last + 1));
      next[static_cast<std::size_t>(enters)] = leaves;
    }
  }
  return next;
}

constexpr CubeTriangles trace(int inside) {
  CubeTriangles triangles;
  std::array<int, 12> next = follow_borders(inside);
  for (int start = 0; start < 12; ++start) {
    int loop[12]{}, size = 0;
    for (int edge = start; next[static_cast<std::size_t>(edge)] >= 0;) {
      loop[size++] = edge;
      const int following = next[static_cast<std::size_t>(edge)];
      next[static_cast<std::size_t>(edge)] = -1;
      edge = following;
    }
    for (int k = 2; k < size; ++k) {
      triangles.edges[triangles.count++] = {static_cast<std::uint8_t>(loop[0]), static_cast<std::uint8_t>(loop[k - 1]),
                                            static_cast<std::uint8_t>(loop[k])};
    }
  }
  return triangles;
}

constexpr std::array<CubeTriangles, 256> trace_all() {
  std::array<CubeTriangles, 256> all{};
  for (int inside = 0; inside < 256; ++inside) all[static_cast<std::size_t>(inside)] = trace(inside);
  return all;
}

}  // namespace

CubeEdge cube_edge(int edge) {
  return make_edge(edge);
}

const CubeTriangles& cube_triangles(std::uint8_t inside) {
  static const std::array<CubeTriangles, 256> kAll = trace_all();
  return kAll[inside];
}

}  // namespace povslam
