#include "pipeline/objects/box_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace povslam {
namespace {

constexpr double kPi = std::numbers::pi;

struct Range {
  double low = 0.0, high = 0.0;
};

Range trimmed_range(std::vector<float>& values, double trim) {
  const auto n = static_cast<double>(values.size());
  const auto skip = static_cast<std::ptrdiff_t>(std::floor(trim * n));
  std::nth_element(values.begin(), values.begin() + skip, values.end());
  const double low = static_cast<double>(values[static_cast<std::size_t>(skip)]);
  std::nth_element(values.begin(), values.end() - 1 - skip, values.end());
  return {low, static_cast<double>(*(values.end() - 1 - skip))};
}

class Turned {
 public:
  explicit Turned(std::span<const Eigen::Vector3f> points) : points_(points), x_(points.size()), y_(points.size()) {}

  void turn(double yaw) {
    const float c = static_cast<float>(std::cos(yaw)), s = static_cast<float>(std::sin(yaw));
    for (std::size_t i = 0; i < points_.size(); ++i) {
      x_[i] = c * points_[i].x() + s * points_[i].y();
      y_[i] = -s * points_[i].x() + c * points_[i].y();
    }
  }
  // How near the points lie to the sides of their rectangle.
  double closeness(double trim) {
    scratch_ = x_;
    const Range rx = trimmed_range(scratch_, trim);
    scratch_ = y_;
    const Range ry = trimmed_range(scratch_, trim);
    constexpr double kNoise_m = 0.02;
    double sum = 0.0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const double x = static_cast<double>(x_[i]), y = static_cast<double>(y_[i]);
      const double dx = std::min(std::abs(x - rx.low), std::abs(rx.high - x));
      const double dy = std::min(std::abs(y - ry.low), std::abs(ry.high - y));
      const double nearest = std::min(dx, dy);
      sum += 1.0 / std::sqrt(kNoise_m * kNoise_m + nearest * nearest);
    }
    return sum;
  }
  Range along_x(double trim) { return trimmed_range(scratch_ = x_, trim); }
  Range along_y(double trim) { return trimmed_range(scratch_ = y_, trim); }

 private:
  std::span<const Eigen::Vector3f> points_;
  std::vector<float> x_, y_, scratch_;
};

double best_heading(Turned& turned, double from, double to, double step, double trim) {
  double best = from, most = -1.0;
  for (double yaw = from; yaw < to; yaw += step) {
    turned.turn(yaw);
    const double score = turned.closeness(trim);
    if (score > most) most = score, best = yaw;
  }
  return best;
}

using Polygon = std::vector<Eigen::Vector2d>;

Polygon outline(const Box& box) {
  const Eigen::Rotation2Dd turn(box.yaw);
  Polygon corners;
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    corners.push_back(box.center.head<2>() + turn * Eigen::Vector2d(x * box.size_m.x(), y * box.size_m.y()));
  }
  return corners;
}

// Sutherland-Hodgman: what of the polygon lies left of the line from a to b.
Polygon clip(const Polygon& polygon, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d edge = b - a;
  const auto side = [&](const Eigen::Vector2d& p) { return edge.x() * (p.y() - a.y()) - edge.y() * (p.x() - a.x()); };
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double sp = side(p), sq = side(q);
    if (sp >= 0.0) kept.push_back(p);
    if ((sp >= 0.0) != (sq >= 0.0)) kept.push_back(p + (q - p) * (sp / (sp - sq)));
  }
  return kept;
}

double area(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return 0.5 * std::abs(twice);
}

}  // namespace

double fold_half_turn(double yaw) {
  yaw = std::remainder(yaw, kPi);
  return yaw <= -0.5 * kPi ? yaw + kPi : yaw;
}

Box fit_box_at(std::span<const Eigen::Vector3f> points, double yaw, double trim) {
  Box box;
  box.yaw = fold_half_turn(yaw);
  if (points.size() < 3) return box;
  Turned turned(points);
  turned.turn(box.yaw);
  const Range x = turned.along_x(trim), y = turned.along_y(trim);
  std::vector<float> heights;
  heights.reserve(points.size());
  for (const Eigen::Vector3f& p : points) heights.push_back(p.z());
  const Range z = trimmed_range(heights, trim);
  const Eigen::Vector3d middle(0.5 * (x.low + x.high), 0.5 * (y.low + y.high), 0.5 * (z.low + z.high));
  box.center = Eigen::AngleAxisd(box.yaw, Eigen::Vector3d::UnitZ()) * middle;
  box.size_m = {x.high - x.low, y.high - y.low, z.high - z.low};
  return box;
}

Box fit_box(std::span<const Eigen::Vector3f> points, double trim) {
  if (points.size() < 3) return {};
  constexpr double kDegree = kPi / 180.0;
  Turned turned(points);
  const double rough = best_heading(turned, 0.0, 0.5 * kPi, 3.0 * kDegree, trim);
  const double fine = best_heading(turned, rough - 2.5 * kDegree, rough + 2.6 * kDegree, 0.5 * kDegree, trim);
  return fit_box_at(points, fine, trim);
}

BoxOverlap overlap(const Box& a, const Box& b) {
  const double top = std::min(a.center.z() + 0.5 * a.size_m.z(), b.center.z() + 0.5 * b.size_m.z());
  const double bottom = std::max(a.center.z() - 0.5 * a.size_m.z(), b.center.z() - 0.5 * b.size_m.z());
  const double reach = 0.5 * (a.size_m.head<2>().norm() + b.size_m.head<2>().norm());
  if (top <= bottom || (a.center - b.center).head<2>().norm() > reach) return {};
  Polygon common = outline(a);
  const Polygon other = outline(b);
  for (std::size_t i = 0; i < 4 && !common.empty(); ++i) common = clip(common, other[i], other[(i + 1) % 4]);
  const double both = area(common) * (top - bottom), va = a.size_m.prod(), vb = b.size_m.prod();
  if (!(both > 0.0)) return {};
  return {both / (va + vb - both), both / std::min(va, vb)};
}

}  // namespace povslam
