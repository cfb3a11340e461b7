#include "tools/povslam/map_ply.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <numeric>
#include <unordered_map>

#include "tools/povslam/map_points.hpp"

namespace povslam {
namespace {

using Colour = std::array<std::uint8_t, 3>;
constexpr Colour kKeyframeColour = {255, 0, 0};
constexpr Colour kNoLookColour = {255, 255, 255};

std::uint8_t mean_grey(const Patch& patch) {
  return static_cast<std::uint8_t>(std::accumulate(std::begin(patch.pixels), std::end(patch.pixels), 0) /
                                   static_cast<int>(std::size(patch.pixels)));
}

void append(std::string& out, const Eigen::Vector3d& p, const Colour& colour) {
  static_assert(std::endian::native == std::endian::little);
  char bytes[15];
  const Eigen::Vector3f point = p.cast<float>();
  std::memcpy(bytes, point.data(), 12);
  std::memcpy(bytes + 12, colour.data(), 3);
  out.append(bytes, sizeof bytes);
}

}  // namespace

Status write_map_ply(const std::filesystem::path& file, const MapContent& map, bool keyframes) {
  std::unordered_map<std::int64_t, std::uint8_t> grey_of;
  for (const LandmarkLook& look : map.looks) grey_of[look.landmark] = mean_grey(look.patch);
  std::string points;
  const MapPoints landmarks(map);
  for (const auto& [id, p] : landmarks.all()) {
    const auto grey = grey_of.find(id);
    append(points, p, grey == grey_of.end() ? kNoLookColour : Colour{grey->second, grey->second, grey->second});
  }
  if (keyframes) {
    for (const KeyframeRow& row : map.keyframes) append(points, row.T_world_camera.translation, kKeyframeColour);
  }
  std::ofstream out(file, std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\ncomment povslam map, world frame, metres\nelement vertex "
      << landmarks.all().size() + (keyframes ? map.keyframes.size() : 0)
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nend_header\n"
      << points;
  out.close();
  if (!out) return Error{file.string() + ": cannot be written"};
  return Done{};
}

}  // namespace povslam
