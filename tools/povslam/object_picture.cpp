#include "tools/povslam/object_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/povslam/canvas.hpp"

namespace povslam {
namespace {

using drawing::Canvas;
using drawing::Color;

constexpr int kWidth_px = 1200, kTop_px = 60, kMargin_px = 30;
constexpr Color kBlack{20, 20, 20}, kPath{70, 110, 200}, kMove{200, 60, 200};

Color consistency_color(double consistency) {
  const double share = std::clamp(consistency, 0.0, 1.0);
  return {static_cast<std::uint8_t>(std::lround(220.0 * std::min(1.0, 2.0 * (1.0 - share)))),
          static_cast<std::uint8_t>(std::lround(180.0 * std::min(1.0, 2.0 * share))), 40};
}

// World x to the right, y up, both in one scale.
class Plan {
 public:
  explicit Plan(const ReplayRecord& record) {
    Eigen::AlignedBox2d extent;
    for (const StampedPose& pose : record.published) extent.extend(pose.T_world_sensor.translation.head<2>());
    for (const ObjectRecord& object : record.objects) extent.extend(object.place.position.head<2>());
    for (const Eigen::Vector3f& p : record.mesh.vertices) extent.extend(p.head<2>().cast<double>());
    if (extent.isEmpty()) extent.extend(Eigen::Vector2d::Zero());
    low_ = extent.min() - Eigen::Vector2d::Constant(0.5);
    const Eigen::Vector2d size = extent.sizes() + Eigen::Vector2d::Ones();
    scale_ = std::min((kWidth_px - 2 * kMargin_px) / size.x(), 1600.0 / size.y());
    height_px_ = kTop_px + kMargin_px + static_cast<int>(size.y() * scale_);
  }
  int height_px() const { return height_px_; }
  Eigen::Vector2d at(const Eigen::Vector2d& p_world) const {
    const Eigen::Vector2d p = (p_world - low_) * scale_;
    return {kMargin_px + p.x(), height_px_ - kMargin_px - p.y()};
  }

 private:
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double scale_ = 1.0;
  int height_px_ = 0;
};

void draw_surface(Canvas& canvas, const Plan& plan, const Mesh& mesh) {
  for (const Eigen::Vector3f& p : mesh.vertices) {
    if (p.z() < 0.1F) continue;  // the floor would cover all
    canvas.dot(plan.at(p.head<2>().cast<double>()), 1.0, {190, 190, 190});
  }
}

void draw_box(Canvas& canvas, const Plan& plan, const ObjectPlace& place, const Eigen::Vector3d& size_m,
              const drawing::Stroke& stroke) {
  std::array<Eigen::Vector2d, 5> corners;
  const Eigen::Rotation2Dd turn(place.yaw);
  constexpr std::array<std::array<double, 2>, 5> kCorners{
      {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = plan.at(place.position.head<2>() +
                         turn * Eigen::Vector2d(kCorners[i][0] * size_m.x(), kCorners[i][1] * size_m.y()));
  }
  canvas.polyline(corners, stroke);
}

void draw_event(Canvas& canvas, const Plan& plan, const ObjectEvent& event) {
  const Eigen::Vector2d to = plan.at(event.place.position.head<2>());
  if (event.from) {
    const std::array<Eigen::Vector2d, 2> line = {plan.at(event.from->position.head<2>()), to};
    canvas.polyline(line, {kMove, 2.0});
    draw_box(canvas, plan, *event.from, event.size_m, {kMove, 1.0});
  } else if (event.type == ObjectEventType::removed) {
    draw_box(canvas, plan, event.place, event.size_m, {kMove, 1.0});
  }
  canvas.text(to + Eigen::Vector2d(0, 14), std::string(to_string(event.type)) + " " + std::to_string(event.object),
              {kMove, 12.0, drawing::Anchor::middle, true});
}

}  // namespace

Status draw_objects(const std::filesystem::path& file, const ReplayRecord& record) {
  const Plan plan(record);
  const auto canvas = drawing::make_png_canvas(kWidth_px, plan.height_px());
  draw_surface(*canvas, plan, record.mesh);
  std::vector<Eigen::Vector2d> path;
  for (const StampedPose& pose : record.published) path.push_back(plan.at(pose.T_world_sensor.translation.head<2>()));
  canvas->polyline(path, {kPath, 1.5});
  for (const ObjectRecord& object : record.objects) {
    const Color color = consistency_color(object.belief.expected_consistency());
    draw_box(*canvas, plan, object.place, object.size_m, {color, 2.5});
    canvas->text(plan.at(object.place.position.head<2>()), std::to_string(object.id),
                 {kBlack, 11.0, drawing::Anchor::middle, false});
  }
  for (const ObjectEvent& event : record.events) draw_event(*canvas, plan, event);
  canvas->text({kMargin_px, 30.0},
               std::to_string(record.objects.size()) + " objects, " + std::to_string(record.events.size()) +
                   " events; box colour: consistency, red 0, green 1; purple: events",
               {kBlack, 16.0, drawing::Anchor::left, true});
  return canvas->save(file.string());
}

}  // namespace povslam
