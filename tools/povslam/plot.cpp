#include "tools/povslam/plot.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "tools/povslam/plot_axes.hpp"

namespace povslam {
namespace {

using namespace drawing;

constexpr int kWidthPx = 1400, kHeightPx = 800;
constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr Color kText{45, 52, 60}, kTruth{60, 66, 74};
constexpr std::array<Color, 6> kEstimates{
    {{214, 69, 45}, {38, 115, 190}, {46, 139, 87}, {150, 90, 180}, {205, 140, 20}, {20, 150, 160}}};

struct View {
  Eigen::Matrix<double, 2, 3> axes;  // rows: what goes right and what goes up on the sheet
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  bool from_above = true;
  Eigen::Vector2d operator()(const Eigen::Vector3d& p_world) const { return axes * (p_world - origin); }
};

View choose_view(const std::vector<StampedPose>& path) {
  View view;
  view.axes << 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  if (path.empty()) return view;
  Eigen::Vector3d up = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();
  const double share = 1.0 / static_cast<double>(path.size());
  for (const StampedPose& pose : path) {
    up -= share * (pose.T_world_sensor.rotation * Eigen::Vector3d::UnitY());
    mean += share * pose.T_world_sensor.translation;
  }
  view.from_above = up.normalized().z() > 0.5;
  if (view.from_above) return view;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const StampedPose& pose : path) {
    const Eigen::Vector3d d = pose.T_world_sensor.translation - mean;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);  // eigenvalues increase
  view.axes << solver.eigenvectors().col(2).transpose(), solver.eigenvectors().col(1).transpose();
  view.origin = mean;
  return view;
}

struct ErrorCurves {
  std::vector<Eigen::Vector2d> first, second;  // (seconds, value): position and rotation error, or height and yaw
};

double yaw_deg(const Rigid3& T_world_camera) {
  const Eigen::Vector3d forward = T_world_camera.rotation * Eigen::Vector3d::UnitZ();
  return std::atan2(forward.y(), forward.x()) * kDegPerRad;
}

ErrorCurves curves_of(const TrajectoryPlot& data, const std::vector<StampedPose>& poses, TimeNs start) {
  ErrorCurves curves;
  for (const StampedPose& pose : poses) {
    const double time_s = to_seconds(pose.stamp - start);
    double first = pose.T_world_sensor.translation.z(), second = yaw_deg(pose.T_world_sensor);
    if (!data.truth.empty()) {
      const std::optional<Rigid3> truth = pose_at(data.truth, pose.stamp, data.max_gap_s);
      first = truth ? (pose.T_world_sensor.translation - truth->translation).norm() : kNothing;
      second = truth ? rotation_angle_rad(truth->inverse() * pose.T_world_sensor) * kDegPerRad : kNothing;
    } else if (!curves.second.empty() && std::abs(second - curves.second.back().y()) > 180.0) {
      curves.second.push_back({time_s, kNothing});  // yaw wraps: do not draw the jump
    }
    curves.first.push_back({time_s, first});
    curves.second.push_back({time_s, second});
  }
  return curves;
}

std::vector<StampedPose> within_estimates(const TrajectoryPlot& data) {
  TimeNs first = std::numeric_limits<TimeNs>::max(), last = std::numeric_limits<TimeNs>::min();
  for (const PlottedTrajectory& estimate : data.estimates) {
    if (estimate.poses.empty()) continue;
    first = std::min(first, estimate.poses.front().stamp);
    last = std::max(last, estimate.poses.back().stamp);
  }
  if (first > last) return data.truth;
  std::vector<StampedPose> kept;
  for (const StampedPose& pose : data.truth) {
    if (pose.stamp >= first && pose.stamp <= last) kept.push_back(pose);
  }
  return kept;
}

std::vector<Eigen::Vector2d> project(const std::vector<StampedPose>& path, const View& view) {
  std::vector<Eigen::Vector2d> points;
  for (const StampedPose& pose : path) points.push_back(view(pose.T_world_sensor.translation));
  return points;
}

Range coordinate_range(const std::vector<std::vector<Eigen::Vector2d>>& paths, int axis, double least) {
  std::vector<double> values;
  for (const auto& path : paths) {
    for (const Eigen::Vector2d& point : path) values.push_back(point[axis]);
  }
  return range_of(values, least);
}

// A diverged estimate may not shrink the truth to a point: the view reaches no further than 1.5 of its sizes around it.
Range limited(const Range& all, const Range& truth, double reach) {
  return {std::max(all.low, truth.low - reach), std::min(all.high, truth.high + reach)};
}

void draw_path(Canvas& canvas, const TrajectoryPlot& data) {
  const std::vector<StampedPose> truth = within_estimates(data);
  const bool has_estimate = !data.estimates.empty();
  const View view = choose_view(!truth.empty() || !has_estimate ? truth : data.estimates.front().poses);
  std::vector<std::vector<Eigen::Vector2d>> paths{project(truth, view)};
  for (const PlottedTrajectory& estimate : data.estimates) paths.push_back(project(estimate.poses, view));
  Range x = coordinate_range(paths, 0, 0.02), y = coordinate_range(paths, 1, 0.02);
  if (!truth.empty()) {
    const Range truth_x = coordinate_range({paths.front()}, 0, 0.02),
                truth_y = coordinate_range({paths.front()}, 1, 0.02);
    const double reach = 1.5 * std::max(truth_x.span(), truth_y.span());
    x = limited(x, truth_x, reach);
    y = limited(y, truth_y, reach);
  }
  Axes axes(canvas, {70.0, 90.0}, {640.0, 640.0}, x, y);
  axes.widen_to_equal_scale();
  axes.draw_frame(view.from_above ? "path from above: y [m] over x [m]" : "path on its two principal axes [m]", "");
  axes.curve(paths.front(), {kTruth, 3.0});
  for (std::size_t i = 1; i < paths.size(); ++i) axes.curve(paths[i], {kEstimates[(i - 1) % 6], 1.6});
  const auto& started = truth.empty() && paths.size() > 1 ? paths[1] : paths.front();
  if (!started.empty()) axes.dot(started.front(), 5.0, kTruth);
}

void draw_legend(Canvas& canvas, const TrajectoryPlot& data) {
  double x = 70.0;
  const auto entry = [&](const std::string& name, Color color, double width_px) {
    const Eigen::Vector2d line[] = {{x, 770.0}, {x + 34.0, 770.0}};
    canvas.polyline(line, {color, width_px});
    canvas.text({x + 42.0, 775.0}, name, {kText, 14.0, Anchor::left, false});
    x += 70.0 + 8.5 * static_cast<double>(name.size());
  };
  if (!data.truth.empty()) entry("truth", kTruth, 3.0);
  for (std::size_t i = 0; i < data.estimates.size(); ++i) entry(data.estimates[i].name, kEstimates[i % 6], 1.8);
  canvas.dot({x + 5.0, 770.0}, 5.0, kTruth);
  canvas.text({x + 16.0, 775.0}, "start", {kText, 14.0, Anchor::left, false});
}

void draw_over_time(Canvas& canvas, const TrajectoryPlot& data) {
  const bool errors = !data.truth.empty();
  TimeNs start = std::numeric_limits<TimeNs>::max();
  for (const PlottedTrajectory& estimate : data.estimates) {
    if (!estimate.poses.empty()) start = std::min(start, estimate.poses.front().stamp);
  }
  std::vector<std::vector<Eigen::Vector2d>> first, second;
  for (const PlottedTrajectory& estimate : data.estimates) {
    const ErrorCurves curves = curves_of(data, estimate.poses, start);
    first.push_back(curves.first);
    second.push_back(curves.second);
  }
  const auto panel = [&](double top_px, const auto& lines, const std::string& title, double least) {
    Range y = coordinate_range(lines, 1, least);
    if (errors) y.low = 0.0;
    const Axes axes(canvas, {800.0, top_px}, {560.0, 190.0}, coordinate_range(lines, 0, 0.1), y);
    axes.draw_frame(title, "time [s]");
    if (data.lap1_end) axes.vertical_line(to_seconds(*data.lap1_end - start), "lap 2");
    for (std::size_t i = 0; i < lines.size(); ++i) axes.curve(lines[i], {kEstimates[i % 6], 1.6});
  };
  panel(90.0, first, errors ? "position error [m]" : "height [m]", 1e-3);
  panel(345.0, second, errors ? "rotation error [deg]" : "yaw [deg]", 0.1);
}

void draw_notes(Canvas& canvas, const TrajectoryPlot& data) {
  double y = 612.0;
  for (const std::string& note : data.notes) {
    const std::size_t colon = note.find(": ");
    canvas.text({800.0, y}, note.substr(0, colon), {kText, 15.0, Anchor::left, false});
    if (colon != std::string::npos) canvas.text({1080.0, y}, note.substr(colon + 2), {kText, 15.0, Anchor::left, true});
    y += 21.0;
  }
}

Status draw(Canvas& canvas, const std::string& file, const TrajectoryPlot& data) {
  canvas.text({70.0, 44.0}, data.title, {kText, 21.0, Anchor::left, true});
  draw_path(canvas, data);
  draw_legend(canvas, data);
  draw_over_time(canvas, data);
  draw_notes(canvas, data);
  return canvas.save(file);
}

}  // namespace

Status plot_trajectories(const std::string& file, const TrajectoryPlot& data) {
  if (file.ends_with(".svg")) return draw(*make_svg_canvas(kWidthPx, kHeightPx), file, data);
  if (file.ends_with(".png")) return draw(*make_png_canvas(kWidthPx, kHeightPx), file, data);
  const Status png = plot_trajectories(file + ".png", data);
  return png ? plot_trajectories(file + ".svg", data) : png;
}

}  // namespace povslam
