#include "drivers/synthetic/change.hpp"

#include <algorithm>
#include <limits>

namespace povslam::synthetic {

namespace {

constexpr int kWatchWidth = 120, kCoverageWidth = 60;
constexpr double kMargin = 1.1;  // the watch sees 10 % more in tangent
constexpr double kSwell_m = 0.03;

// Same field of view, coarse, widened by the margin and never narrower than the standard camera.
PinholeCamera watch_camera(const PinholeCamera& camera, int width, double margin) {
  const PinholeCamera standard = SyntheticOptions{}.camera;
  const auto widest = [margin](double size, double focal, double standard_size, double standard_focal) {
    return margin * std::max(size / focal, standard_size / standard_focal);
  };
  const double across = widest(camera.width, camera.fx, standard.width, standard.fx);
  const double down = widest(camera.height, camera.fy, standard.height, standard.fy);
  PinholeCamera coarse;
  coarse.width = width;
  coarse.fx = coarse.fy = width / across;
  coarse.height = std::max(2, static_cast<int>(down * coarse.fy + 0.5));
  coarse.cx = 0.5 * (coarse.width - 1);
  coarse.cy = 0.5 * (coarse.height - 1);
  return coarse;
}

Object swollen(const Object& object) {
  Object larger = object;
  larger.size_m.array() += 2.0 * kSwell_m;
  for (Part& part : larger.parts) part.half_m.array() += kSwell_m;
  return larger;
}

}  // namespace

Watch::Watch(const PinholeCamera& camera, const RobotMotion& motion)
    : motion_(motion),
      wide_(watch_camera(camera, kWatchWidth, kMargin)),
      exact_(watch_camera(SyntheticOptions{}.camera, kCoverageWidth, 1.0)) {}

bool Watch::sees(const std::vector<Object>& objects, std::size_t index, const Placement& placement, double time_s) {
  if (!placement.present) return false;
  const View view(wide_, motion_.T_world_camera(time_s));
  faces_.clear();
  view.add_faces(swollen(objects[index]), static_cast<int>(index), placement, faces_);
  if (faces_.empty()) return false;
  const auto own = static_cast<std::int32_t>(faces_.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Object& other = objects[i];
    if (i == index || other.walk || other.change() != Change::unchanged) continue;
    view.add_faces(other, static_cast<int>(i), other.before, faces_);
  }
  raster_.cast(view, faces_);
  const auto hits = raster_.hit().pixels();
  return std::any_of(hits.begin(), hits.end(),
                     [own](std::int32_t hit) { return hit >= Raster::kFirstFace && hit < Raster::kFirstFace + own; });
}

Watch::Coverage Watch::coverage(const std::vector<Object>& objects, bool after, double reach_m) {
  constexpr double kStep_m = 0.35;
  Coverage worst{1.0, std::numeric_limits<int>::max()};
  const double speed_mps = motion_.path().length_m() / (motion_.lap_end_s(2.0) - motion_.lap_end_s(1.0));
  const double lap_s = motion_.lap_end_s(1.0);
  for (double time_s = 0.0; time_s < lap_s; time_s += kStep_m / speed_mps) {
    const View view(exact_, motion_.T_world_camera(time_s));
    faces_.clear();
    for (std::size_t i = 0; i < objects.size(); ++i) {
      view.add_faces(objects[i], static_cast<int>(i), after ? objects[i].after : objects[i].before, faces_);
    }
    raster_.cast(view, faces_);
    const std::size_t pixels = raster_.hit().size();
    std::vector<int> area(objects.size());
    int filled = 0;
    for (std::size_t p = 0; p < pixels; ++p) {
      const std::int32_t hit = raster_.hit().data()[p];
      if (hit < Raster::kFirstFace || raster_.inverse_depth().data()[p] * reach_m < 1.0) continue;
      ++filled;
      ++area[static_cast<std::size_t>(faces_[static_cast<std::size_t>(hit - Raster::kFirstFace)].object)];
    }
    const auto large =
        std::count_if(area.begin(), area.end(), [pixels](int a) { return a * 100.0 >= static_cast<double>(pixels); });
    worst.least_share = std::min(worst.least_share, static_cast<double>(filled) / static_cast<double>(pixels));
    worst.least_objects = std::min(worst.least_objects, static_cast<int>(large));
  }
  return worst;
}

std::optional<double> find_switch_time(const std::vector<Object>& objects, std::size_t index, const RobotMotion& motion,
                                       Watch& watch) {
  constexpr double kStep_s = 0.2;
  const Object& object = objects[index];
  const auto search = [&](double from_s, double until_s, double step_s) -> std::optional<double> {
    int hidden = 0;
    for (double t = from_s; step_s < 0.0 ? t > until_s : t < until_s; t += step_s) {
      const bool seen = watch.sees(objects, index, object.before, t) || watch.sees(objects, index, object.after, t);
      hidden = seen ? 0 : hidden + 1;
      if (hidden == 3) return t - step_s;
    }
    return std::nullopt;
  };
  const double lap_end_s = motion.lap_end_s(1.0);
  const std::optional<double> earlier = search(lap_end_s, 0.3 * lap_end_s, -kStep_s);
  return earlier ? earlier : search(lap_end_s, motion.lap_end_s(1.4), kStep_s);
}

bool time_changes(std::vector<Object>& objects, const RobotMotion& motion, Watch& watch) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].walk || objects[i].change() == Change::unchanged) continue;
    const std::optional<double> time_s = find_switch_time(objects, i, motion, watch);
    if (!time_s) return false;
    objects[i].switch_time_s = *time_s;
  }
  return true;
}

}  // namespace povslam::synthetic
