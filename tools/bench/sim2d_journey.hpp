// The robot's drive through the room of rectangles: in each frame odometry, the variational EM over the window, then
// what the map learns (POV-SLAM, section III-F): beliefs go one step, what is accepted is refined, what is believed no
// more is made anew where it is seen.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "pipeline/backend/vem.hpp"
#include "tests/support/simulated_rectangles.hpp"

namespace povslam::simulated {

struct JourneyFrame {  // after it
  Rigid3 truth, believed;
  VemWindow map;                // objects and landmarks
  std::vector<char> anew;       // by object: made anew in this frame or before
  std::vector<double> beliefs;  // E[v] before the forgetting
};

struct JourneyOptions {
  int num_frames = 4, window = 8;
  double step_m = 0.4, turn_rad = 0.2;              // of the drive
  double odometry_m = 0.02, odometry_rad = 0.0175;  // its noise, per axis
  RectanglesOptions scene;
  VemOptions vem;
};

class Journey {
 public:
  explicit Journey(const JourneyOptions& options)
      : options_(options),
        scene_(RectanglesMaker(options.scene).make()),
        random_(options.scene.seed + 1'000'000U),
        window_(first_frame(scene_, options.scene)),
        anew_(scene_.map.size(), 0) {
    window_.poses.clear();
    window_.matches.clear();
  }

  std::vector<JourneyFrame> drive() {
    std::vector<JourneyFrame> frames;
    Rigid3 truth = scene_.T_world_robot;
    for (int t = 0; t < options_.num_frames; ++t) {
      if (t == 0) window_.poses.push_back(scene_.T_believed);
      if (t > 0) truth = move(truth);
      see(truth);
      const VemResult result = Vem(options_.vem).solve(window_);
      frames.push_back({truth, result.poses.back(), {}, {}, {}});
      learn(result, frames.back());
      frames.back().map = window_;
      frames.back().anew = anew_;
      slide();
    }
    return frames;
  }

  const Rectangles& scene() const { return scene_; }

 private:
  Rigid3 move(const Rigid3& from) {
    const Rigid3 motion{so3_exp({0.0, 0.0, options_.turn_rad}), {options_.step_m, 0.0, 0.0}};
    std::normal_distribution<double> metres(0.0, options_.odometry_m), radians(0.0, options_.odometry_rad);
    Vector6d error = Vector6d::Zero();
    error[0] = metres(random_);
    error[1] = metres(random_);
    error[5] = radians(random_);
    const Rigid3 measured = retract(motion, error);
    window_.transitions.push_back({measured, 2.0 * options_.odometry_m, 2.0 * options_.odometry_rad});
    window_.poses.push_back(window_.poses.back() * measured);
    return from * motion;
  }

  void see(const Rigid3& truth) {
    seen_ = see_corners(scene_.now, truth, options_.scene.noise_m, random_);
    const auto frame = static_cast<std::int32_t>(window_.poses.size()) - 1;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      window_.matches.push_back({frame, static_cast<std::int32_t>(i), seen_[i], 0.1});
    }
  }

  void learn(const VemResult& result, JourneyFrame& frame) {
    window_.poses = result.poses;
    for (std::size_t i = 0; i < window_.objects.size(); ++i) {
      VemObject& object = window_.objects[i];
      ObjectClass kind;
      kind.kind = object.kind;
      kind.k_inlier = object.k_inlier;
      kind.k_outlier = object.k_outlier;
      const BeliefOptions& options = options_.vem.belief;
      object.belief = observe_change(object.belief, result.objects[i].change_m, kind, options).belief;
      frame.beliefs.push_back(object.belief.expected_consistency());
      if (object.belief.expected_consistency() < options.remove_below) {
        make_anew(i);
      } else if (result.objects[i].accepted) {
        object.position = result.objects[i].position;
        object.yaw = result.objects[i].yaw;
        for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
          window_.landmarks[k].p_world = window_.landmarks[k].p_prev = result.landmarks[k];
        }
      }
    }
  }

  // From what is seen of it now; what was matched to it before was of another place.
  void make_anew(std::size_t i) {
    const Rigid3& pose = window_.poses.back();
    std::array<Eigen::Vector3d, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) corners[k] = pose * seen_[4 * i + k];
    VemObject& object = window_.objects[i];
    object.position = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    const Eigen::Vector3d along = corners[0] + corners[3] - corners[1] - corners[2];
    object.yaw = std::atan2(along.y(), along.x());
    object.belief = {0.0, 0.01, 1.0, 1.0};
    const Rigid3 T_object_world = Rigid3{so3_exp({0.0, 0.0, object.yaw}), object.position}.inverse();
    for (std::size_t k = 0; k < 4; ++k) {
      Eigen::Vector3d p_object = T_object_world * corners[k];
      p_object.z() = 0.0;
      window_.landmarks[4 * i + k] = {corners[k], p_object, corners[k]};
    }
    const auto current = static_cast<std::int32_t>(window_.poses.size()) - 1;
    std::erase_if(window_.matches, [i, current](const VemMatch& match) {
      return static_cast<std::size_t>(match.landmark / 4) == i && match.frame != current;
    });
    anew_[i] = 1;
  }

  void slide() {
    if (std::ssize(window_.poses) < options_.window) return;
    window_.poses.erase(window_.poses.begin());
    window_.transitions.erase(window_.transitions.begin());
    window_.prior = {window_.poses.front(), 0.01, 0.0035};
    std::erase_if(window_.matches, [](const VemMatch& match) { return match.frame == 0; });
    for (VemMatch& match : window_.matches) --match.frame;
  }

  JourneyOptions options_;
  Rectangles scene_;
  std::mt19937 random_;
  VemWindow window_;
  std::vector<Eigen::Vector3d> seen_;
  std::vector<char> anew_;
};

}  // namespace povslam::simulated
