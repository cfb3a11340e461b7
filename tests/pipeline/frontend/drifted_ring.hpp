// A map made by hand: a camera turned once round a room and a little further, with drift that grows on the way. What it
// has not seen for a while it does not know again.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "pipeline/frontend/map.hpp"
#include "tests/pipeline/frontend/made_frame.hpp"

namespace povslam::made {

class DriftedRing {
 public:
  static constexpr int kFeatures = 500, kRound = 40, kAgain = 5;

  explicit DriftedRing(const Vector6d& drift_per_keyframe)
      : map(kFeatures, options().map, level_scales()), drift_(drift_per_keyframe) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> angle(0.0, 2.0 * M_PI), height(-1.5, 1.5), depth(4.0, 6.0);
    for (int i = 0; i < 3500; ++i) {
      const double a = angle(random), h = height(random), r = depth(random);
      points.emplace_back(r * std::sin(a), r * std::cos(a), h);
    }
    descriptors = looks(points.size(), 6);
    known_.resize(points.size());
    for (int k = 0; k < kRound + kAgain; ++k) keep();
  }

  static FrontendOptions options() {
    FrontendOptions options;
    options.orb.num_features = kFeatures;
    options.map.max_keyframes = 100;
    options.map.max_landmarks = 20000;
    return options;
  }

  // The next keyframe on the way. It knows again what the last four saw.
  std::int32_t keep() {
    const int k = static_cast<int>(truth.size());
    const double turn = 2.0 * M_PI * k / kRound;
    const Rigid3 way{so3_exp({0.0, 0.0, -turn}), {0.0, 0.0, 0.0}};
    truth.push_back(way * looking_along_y({0.3, 0.5, 0.0}));
    const Rigid3 moved = k == 0 ? Rigid3{} : truth[truth.size() - 2].inverse() * truth.back();
    believed_ = k == 0 ? truth.front() : retract(believed_ * moved, drift_);
    const View view = view_of(camera, options(), truth.back(), points, descriptors);
    const std::int32_t slot = map.insert_keyframe(view.frame, believed_, Matrix6d::Zero(), k - 1);
    for (std::size_t f = 0; f < view.shown.size(); ++f) {
      Known& known = known_[static_cast<std::size_t>(view.shown[f])];
      const auto feature = static_cast<int>(f);
      const bool recent = known.landmark != kNone && k - known.keyframe <= 4 && map.landmark(known.landmark).alive;
      known.keyframe = k;
      if (recent && map.add_sighting(known.landmark, slot, feature)) continue;
      known.landmark = map.create_landmark(slot, feature, believed_ * view.frame.point_camera(feature, camera));
    }
    map.update_covisibility(slot);
    return slot;
  }
  void correct(const Rigid3& T_new_old) { believed_ = T_new_old * believed_; }

  double worst_position_error_m() const {
    double worst = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const auto T_world_camera = map.keyframe_pose(static_cast<std::int64_t>(k));
      worst = std::max(worst, (T_world_camera->translation - truth[k].translation).norm());
    }
    return worst;
  }
  // Of the landmarks, against the nearest true point.
  double median_landmark_error_m() const {
    std::vector<double> errors;
    for (std::int32_t s = 0; s < map.landmark_slots(); s += 7) {
      if (!map.landmark(s).alive) continue;
      double nearest = 1e9;
      for (const auto& point : points) nearest = std::min(nearest, (point - map.landmark(s).p_world).squaredNorm());
      errors.push_back(std::sqrt(nearest));
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    return errors[errors.size() / 2];
  }

  PinholeCamera camera = half_camera();
  std::vector<Eigen::Vector3d> points;
  std::vector<Descriptor> descriptors;
  std::vector<Rigid3> truth;  // T_world_camera by keyframe id
  Map map;

 private:
  Vector6d drift_;  // along the world's axes
  Rigid3 believed_;
  struct Known {
    std::int32_t landmark = kNone;
    int keyframe = 0;  // that saw it last
  };
  std::vector<Known> known_;  // by point
};

// Creeps, and turns a little too far.
inline Vector6d some_drift() {
  return (Vector6d() << 0.004, 0.001, 0.0, 0.0, 0.0, 0.001).finished();
}

}  // namespace povslam::made
