#include <bit>
#include <numeric>

#include "pipeline/mapping/mesh.hpp"

namespace povslam {

namespace {

struct Place {
  std::array<std::uint32_t, 3> bits;
  bool operator==(const Place&) const = default;
};
struct HashPlace {
  std::size_t operator()(const Place& place) const {
    std::size_t hash = 0;
    for (const std::uint32_t bits : place.bits) hash = (hash ^ bits) * 0x9E3779B97F4A7C15ULL;
    return hash ^ hash >> 32;
  }
};

// Which vertices hang together.
class Patches {
 public:
  explicit Patches(const Mesh& mesh) : parent_(mesh.vertices.size()) {
    std::iota(parent_.begin(), parent_.end(), 0U);
    std::unordered_map<Place, std::uint32_t, HashPlace> first_at;
    first_at.reserve(mesh.vertices.size());
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
      const Eigen::Vector3f& p = mesh.vertices[i];
      const Place place{std::bit_cast<std::uint32_t>(p.x()), std::bit_cast<std::uint32_t>(p.y()),
                        std::bit_cast<std::uint32_t>(p.z())};
      join(first_at.try_emplace(place, i).first->second, i);
    }
    for (const auto& t : mesh.triangles) join(t[0], t[1]), join(t[0], t[2]);
  }
  std::uint32_t of(std::uint32_t vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }

 private:
  void join(std::uint32_t a, std::uint32_t b) { parent_[of(a)] = of(b); }
  std::vector<std::uint32_t> parent_;
};

double area_m2(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Eigen::Vector3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  return 0.5 * static_cast<double>((b - a).cross(c - a).norm());
}

}  // namespace

void drop_specks(Mesh& mesh, double least_area_m2) {
  Patches patches(mesh);
  std::vector<double> patch_m2(mesh.vertices.size(), 0.0);
  for (const auto& t : mesh.triangles) patch_m2[patches.of(t[0])] += area_m2(mesh, t);
  std::erase_if(mesh.triangles, [&](const auto& t) { return patch_m2[patches.of(t[0])] < least_area_m2; });

  constexpr std::uint32_t kUnused = 0xFFFFFFFF;
  std::vector<std::uint32_t> renamed(mesh.vertices.size(), kUnused);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t vertex : t) renamed[vertex] = 0;
  }
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    if (renamed[i] == kUnused) continue;
    renamed[i] = kept;
    mesh.vertices[kept] = mesh.vertices[i];
    mesh.colors[kept] = mesh.colors[i];
    ++kept;
  }
  mesh.vertices.resize(kept);
  mesh.colors.resize(kept);
  for (auto& t : mesh.triangles) {
    for (std::uint32_t& vertex : t) vertex = renamed[vertex];
  }
}

}  // namespace povslam
