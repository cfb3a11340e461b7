#include "tools/povslam/plot_axes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

namespace povslam::drawing {
namespace {

constexpr Color kGrid{225, 229, 234}, kFrame{120, 128, 138}, kText{45, 52, 60};
constexpr double kTickTextPx = 13.0;

struct Segment {
  Eigen::Vector2d from, to;
};

// Part of a segment inside the box (Liang and Barsky 1984).
std::optional<Segment> clip(const Segment& segment, const Range& x, const Range& y) {
  const Eigen::Vector2d d = segment.to - segment.from;
  const double slopes[4] = {-d.x(), d.x(), -d.y(), d.y()};
  const double rooms[4] = {segment.from.x() - x.low, x.high - segment.from.x(), segment.from.y() - y.low,
                           y.high - segment.from.y()};
  double enter = 0.0, leave = 1.0;
  for (int side = 0; side < 4; ++side) {
    if (slopes[side] == 0.0) {
      if (rooms[side] < 0.0) return std::nullopt;
      continue;
    }
    const double at = rooms[side] / slopes[side];
    if (slopes[side] < 0.0) {
      enter = std::max(enter, at);
    } else {
      leave = std::min(leave, at);
    }
  }
  if (enter > leave) return std::nullopt;
  return Segment{segment.from + enter * d, segment.from + leave * d};
}

double step_of(const Range& range, int wanted) {
  const double rough = range.span() / std::max(1, wanted);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= rough * 0.999) return step * power;
  }
  return 10.0 * power;
}

std::string tick_label(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", std::min(decimals, 9), std::abs(value) < 0.5e-3 * step ? 0.0 : value);
  return text;
}

}  // namespace

Range range_of(std::span<const double> values, double least) {
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  if (range.low > range.high) return {0.0, least};
  const double margin = 0.04 * range.span() + std::max(0.0, 0.5 * (least - range.span()));
  return {range.low - margin, range.high + margin};
}

std::vector<double> ticks(const Range& range, int wanted) {
  const double step = step_of(range, wanted);
  std::vector<double> values;
  const double first = std::ceil(range.low / step - 1e-9);
  for (double k = first; k * step <= range.high + 1e-9 * step && values.size() < 100; k += 1.0)
    values.push_back(k * step);
  return values;
}

Axes::Axes(Canvas& canvas, const Eigen::Vector2d& corner_px, const Eigen::Vector2d& size_px, Range x, Range y)
    : canvas_(canvas), corner_px_(corner_px), size_px_(size_px), x_(x), y_(y) {}

void Axes::widen_to_equal_scale() {
  const double per_px = std::max(x_.span() / size_px_.x(), y_.span() / size_px_.y());
  const double more_x = 0.5 * (per_px * size_px_.x() - x_.span()), more_y = 0.5 * (per_px * size_px_.y() - y_.span());
  x_ = {x_.low - more_x, x_.high + more_x};
  y_ = {y_.low - more_y, y_.high + more_y};
  tick_spacing_y_px_ = tick_spacing_x_px_;
}

void Axes::draw_frame(const std::string& title, const std::string& x_label) const {
  const double right = corner_px_.x() + size_px_.x(), bottom = corner_px_.y() + size_px_.y();
  const int wanted_x = static_cast<int>(size_px_.x() / tick_spacing_x_px_);
  const int wanted_y = static_cast<int>(size_px_.y() / tick_spacing_y_px_);
  for (const double x : ticks(x_, wanted_x)) {
    const double px = pixel({x, y_.low}).x();
    const Eigen::Vector2d line[] = {{px, corner_px_.y()}, {px, bottom}};
    canvas_.polyline(line, {kGrid, 1.0});
    canvas_.text({px, bottom + 17.0}, tick_label(x, step_of(x_, wanted_x)),
                 {kText, kTickTextPx, Anchor::middle, false});
  }
  for (const double y : ticks(y_, wanted_y)) {
    const double py = pixel({x_.low, y}).y();
    const Eigen::Vector2d line[] = {{corner_px_.x(), py}, {right, py}};
    canvas_.polyline(line, {kGrid, 1.0});
    canvas_.text({corner_px_.x() - 7.0, py + 4.0}, tick_label(y, step_of(y_, wanted_y)),
                 {kText, kTickTextPx, Anchor::right, false});
  }
  const Eigen::Vector2d border[] = {
      corner_px_, {right, corner_px_.y()}, {right, bottom}, {corner_px_.x(), bottom}, corner_px_};
  canvas_.polyline(border, {kFrame, 1.2});
  canvas_.text({corner_px_.x(), corner_px_.y() - 8.0}, title, {kText, 14.0, Anchor::left, true});
  canvas_.text({right, bottom + 34.0}, x_label, {kText, kTickTextPx, Anchor::right, false});
}

void Axes::vertical_line(double x, const std::string& label) const {
  if (x < x_.low || x > x_.high) return;
  const double px = pixel({x, y_.low}).x();
  const Eigen::Vector2d line[] = {{px, corner_px_.y()}, {px, corner_px_.y() + size_px_.y()}};
  canvas_.polyline(line, {kFrame, 1.2});
  canvas_.text({px + 4.0, corner_px_.y() + 14.0}, label, {kText, kTickTextPx, Anchor::left, false});
}

void Axes::curve(std::span<const Eigen::Vector2d> points, const Stroke& stroke) const {
  std::vector<Eigen::Vector2d> run;  // pixels of what is drawn in one go
  const auto flush = [&] {
    if (run.size() > 1) canvas_.polyline(run, stroke);
    run.clear();
  };
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Segment whole{points[i - 1], points[i]};
    const bool finite = whole.from.allFinite() && whole.to.allFinite();
    const std::optional<Segment> seen = finite ? clip(whole, x_, y_) : std::nullopt;
    if (!seen || !inside(whole.from)) flush();
    if (!seen) continue;
    if (run.empty()) run.push_back(pixel(seen->from));
    run.push_back(pixel(seen->to));
  }
  flush();
}

void Axes::dot(const Eigen::Vector2d& point, double radius_px, Color fill) const {
  if (inside(point)) canvas_.dot(pixel(point), radius_px, fill);
}

Eigen::Vector2d Axes::pixel(const Eigen::Vector2d& point) const {
  return {corner_px_.x() + (point.x() - x_.low) / x_.span() * size_px_.x(),
          corner_px_.y() + (y_.high - point.y()) / y_.span() * size_px_.y()};
}

bool Axes::inside(const Eigen::Vector2d& point) const {
  return point.x() >= x_.low && point.x() <= x_.high && point.y() >= y_.low && point.y() <= y_.high;
}

}  // namespace povslam::drawing
