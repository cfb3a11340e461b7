#include "pipeline/objects/find_fences.hpp"

#include <map>

namespace povslam {
namespace {

constexpr int kApart = 8, kRows = 5;
constexpr float kBehind_m = 0.15F, kBehindShare = 0.02F;  // on a row seen slantingly one is that much further
constexpr double kNearer_m = 0.02;
constexpr double kHeight_m = 0.12, kOfLower = 0.5, kOfTaller = 0.25;  // a border is so long at least

struct Border {  // of two observations
  int rows = 0;
  Eigen::Vector2d between = Eigen::Vector2d::Zero();  // sum over rows, world
  double depth_sum_m = 0.0;                           // of the two, at the border
  double other_sum_m = 0.0;                           // of pixels of other classes between them
  int others = 0;

  // Nothing of another class is between them, or it is seen behind them.
  bool open() const { return others == 0 || other_sum_m / others > depth_sum_m / rows - kNearer_m; }
};

Eigen::Vector2d ground_point(const DepthView& view, int cell_x, int cell_y, float depth_m) {
  const double z = static_cast<double>(depth_m);
  const Eigen::Vector3d p((2 * cell_x + 0.5 - view.camera.cx) / view.camera.fx * z,
                          (2 * cell_y + 0.5 - view.camera.cy) / view.camera.fy * z, z);
  return (view.T_world_camera * p).head<2>();
}

Eigen::Vector2d middle(const Observation& observation) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& p : observation.points_world) sum += p;
  return (sum / static_cast<float>(observation.points_world.size())).head<2>().cast<double>();
}

void add_row(Border& border, const CellParts& parts, const ImageU16& separable, const DepthView& view, int left,
             int right, int y) {
  const float z_left = parts.depth.at(left, y), z_right = parts.depth.at(right, y);
  ++border.rows;
  border.between += 0.5 * (ground_point(view, left, y, z_left) + ground_point(view, right, y, z_right));
  border.depth_sum_m += 0.5 * static_cast<double>(z_left + z_right);
  for (int u = 2 * left + 2; u < 2 * right; ++u) {
    const float z = view.depth_m.at(u, 2 * y);
    if (parts.alike(separable.at(u, 2 * y), parts.value.at(left, y)) || !(z > 0.0F)) continue;
    border.other_sum_m += static_cast<double>(z);
    ++border.others;
  }
}

}  // namespace

void find_fences(const CellParts& parts, const ImageU16& separable, const DepthView& view,
                 std::span<Observation> observations) {
  std::map<std::pair<std::uint16_t, std::uint16_t>, Border> borders;
  const auto owner_at = [&](int x, int y) {
    const std::int32_t component = parts.finder.component_at(x, y);
    return component < 0 ? kNobody : parts.owner[static_cast<std::size_t>(component)];
  };
  const auto stand_side_by_side = [&](int x, int y) {  // one of the cell's pixels is of its class
    const std::uint16_t value = parts.value.at(x, y);
    return separable.at(2 * x, 2 * y) == value || separable.at(2 * x + 1, 2 * y) == value ||
           separable.at(2 * x, 2 * y + 1) == value || separable.at(2 * x + 1, 2 * y + 1) == value;
  };
  for (int y = 0; y < parts.value.height(); ++y) {
    for (int x = 0, last = -1; x < parts.value.width(); ++x) {
      const std::uint16_t b = owner_at(x, y);
      if (b == kNobody) continue;
      const std::uint16_t a = last < 0 ? kNobody : owner_at(last, y);
      const int before = std::exchange(last, x);
      if (a == kNobody || a == b || x - before > kApart) continue;
      const float z = parts.depth.at(x, y);
      const bool alike = parts.alike(parts.value.at(before, y), parts.value.at(x, y)) && stand_side_by_side(x, y);
      if (!alike || std::abs(z - parts.depth.at(before, y)) >= kBehind_m + kBehindShare * z) continue;
      add_row(borders[std::minmax(a, b)], parts, separable, view, before, x, y);
    }
  }
  std::map<std::uint16_t, int> rows_of;
  for (std::size_t i = 0; i < parts.components.size(); ++i) {
    rows_of[parts.owner[i]] = parts.components[i].y_max - parts.components[i].y_min + 1;
  }
  const auto long_enough = [&](const std::pair<std::uint16_t, std::uint16_t>& pair, const Border& border) {
    const auto [lower, taller] = std::minmax(rows_of[pair.first], rows_of[pair.second]);
    const double height_m = 2.0 * border.depth_sum_m / view.camera.fy;  // rows of the mean depth
    return border.rows >= kRows && height_m >= kHeight_m && border.rows >= kOfLower * lower &&
           border.rows >= kOfTaller * taller;
  };
  for (const auto& [pair, border] : borders) {
    if (!long_enough(pair, border) || !border.open()) continue;
    Observation& a = observations[static_cast<std::size_t>(pair.first - kFirstInstance)];
    Observation& b = observations[static_cast<std::size_t>(pair.second - kFirstInstance)];
    if (a.points_world.empty() || b.points_world.empty()) continue;
    const Eigen::Vector2d at = border.between / border.rows, way = (middle(b) - middle(a)).normalized();
    a.fences.push_back({at, way});
    b.fences.push_back({at, -way});
  }
}

}  // namespace povslam
