// A map that grows as tracking makes one grow: keyframes with features, landmarks hung on them, corrections, culling.
// Each change comes with what the whole map then is, so that a store can be held against it.
#pragma once

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include "pipeline/frontend/map_rows.hpp"

namespace povslam::made {

struct MapPace {
  int features = 1000;         // of a keyframe
  int keyframes = 3;           // new ones a change
  int new_landmarks = 400;     // a change
  int old_landmarks = 1100;    // seen again and corrected, a change
  double share_removed = 0.3;  // of the change's new keyframes and landmarks: as many old ones are culled
  unsigned seed = 1;
};

// What a reader has after applying changes in order.
class MapTruth {
 public:
  void apply(const MapChange& change) {
    meta = change.meta;
    for (const auto& row : change.features) features[row.keyframe] = row;
    for (const auto& row : change.keyframes) keyframes[row.keyframe] = row;
    for (const auto& row : change.landmarks) landmarks[row.landmark] = row;
    for (const auto& row : change.looks) looks[row.landmark] = row;
    for (const std::int64_t id : change.removed_keyframes) {
      features.erase(id);
      keyframes.erase(id);
    }
    for (const std::int64_t id : change.removed_landmarks) {
      landmarks.erase(id);
      looks.erase(id);
    }
  }
  MapContent content() const {
    MapContent all;
    all.meta = meta;
    for (const auto& [id, row] : features) all.features.push_back(row);
    for (const auto& [id, row] : keyframes) all.keyframes.push_back(row);
    for (const auto& [id, row] : landmarks) all.landmarks.push_back(row);
    for (const auto& [id, row] : looks) all.looks.push_back(row);
    return all;
  }

  MapMeta meta;
  std::map<std::int64_t, KeyframeFeatures> features;
  std::map<std::int64_t, KeyframeRow> keyframes;
  std::map<std::int64_t, LandmarkRow> landmarks;
  std::map<std::int64_t, LandmarkLook> looks;
};

class MapMaker {
 public:
  explicit MapMaker(const MapPace& pace) : pace_(pace), random_(pace.seed) {}

  MapChange next() {
    MapChange change;
    const std::int64_t first = next_keyframe_;
    for (int i = 0; i < pace_.keyframes; ++i) add_keyframe(change);
    for (int i = 0; i < pace_.new_landmarks; ++i) add_landmark(first + i % pace_.keyframes, change);
    touch_old_landmarks(change);
    correct_last_keyframes(first, change);
    cull(first, change);
    change.meta = {next_keyframe_, next_landmark_, static_cast<std::uint32_t>(first / 100), 0x5EED};
    truth_.apply(change);
    return change;
  }

  const MapTruth& truth() const { return truth_; }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  float uniform_f(double low, double high) { return static_cast<float>(uniform(low, high)); }
  std::int64_t pick(std::int64_t low, std::int64_t high) {  // both can be
    return std::uniform_int_distribution<std::int64_t>(low, high)(random_);
  }
  Eigen::Vector3d vector(double extent) {
    const double x = uniform(-extent, extent), y = uniform(-extent, extent), z = uniform(-extent, extent);
    return {x, y, z};
  }

  void add_keyframe(MapChange& change) {
    KeyframeFeatures row;
    row.keyframe = next_keyframe_++;
    row.stamp = row.keyframe * 700 * kNsPerMs;
    for (int i = 0; i < pace_.features; ++i) {
      row.x.push_back(uniform_f(0, 640));
      row.y.push_back(uniform_f(0, 480));
      row.sigma_px.push_back(uniform_f(0.15, 3));
      row.inverse_depth.push_back(uniform(0, 1) < 0.2 ? 0.0F : uniform_f(0.1, 3));
      row.sigma_inverse_depth.push_back(0.0025F);
      row.level.push_back(static_cast<std::uint8_t>(pick(0, 7)));
      row.descriptor.push_back({random_(), random_(), random_(), random_()});
      row.word.push_back(static_cast<std::uint32_t>(pick(0, 99'999)));
    }
    KeyframeRow pose;
    pose.keyframe = row.keyframe;
    pose.parent = row.keyframe - 1;
    pose.T_world_camera = {so3_exp(vector(1.0)), {0.3 * static_cast<double>(row.keyframe), uniform(-1, 1), 0.8}};
    pose.covariance = 1e-4 * Matrix6d::Identity();
    for (int i = 0; i < pace_.features; ++i) {
      const bool seen = next_landmark_ > 0 && uniform(0, 1) < 0.6;
      pose.landmark.push_back(seen ? pick(std::max<std::int64_t>(0, next_landmark_ - 5000), next_landmark_ - 1) : -1);
    }
    change.features.push_back(std::move(row));
    change.keyframes.push_back(std::move(pose));
  }

  LandmarkRow landmark_on(std::int64_t keyframe, std::int64_t id) {
    LandmarkRow row;
    row.landmark = id;
    row.anchor = row.born_keyframe = keyframe;
    row.p_anchor = vector(2.0) + Eigen::Vector3d(0, 0, 3);
    row.visible = static_cast<std::int32_t>(pick(1, 200));
    row.found = static_cast<std::int32_t>(pick(1, 200));
    row.has_patch = true;
    row.tangent_x_anchor = vector(0.01).cast<float>();
    row.tangent_y_anchor = vector(0.01).cast<float>();
    return row;
  }

  void add_landmark(std::int64_t keyframe, MapChange& change) {
    change.landmarks.push_back(landmark_on(keyframe, next_landmark_));
    LandmarkLook look{next_landmark_++, {}};
    for (std::uint8_t& pixel : look.patch.pixels) pixel = static_cast<std::uint8_t>(random_());
    change.looks.push_back(look);
  }

  void touch_old_landmarks(MapChange& change) {
    const auto& old = truth_.landmarks;
    if (old.empty()) return;
    std::map<std::int64_t, LandmarkRow> touched;
    for (int i = 0; i < pace_.old_landmarks; ++i) {
      auto row = old.lower_bound(pick(std::max<std::int64_t>(0, old.rbegin()->first - 5000), old.rbegin()->first));
      touched[row->first] = row->second;
      touched[row->first].p_anchor += vector(0.01);
    }
    for (const auto& [id, row] : touched) change.landmarks.push_back(row);
  }

  void correct_last_keyframes(std::int64_t first, MapChange& change) {
    auto row = truth_.keyframes.lower_bound(first - 24);
    for (; row != truth_.keyframes.end(); ++row) {
      change.keyframes.push_back(row->second);
      Rigid3& T = change.keyframes.back().T_world_camera;
      T = T * Rigid3{so3_exp(vector(1e-3)), vector(1e-3)};
    }
  }

  // Old keyframes go with what hangs on them, and some landmarks of others.
  void cull(std::int64_t first, MapChange& change) {
    const int count = static_cast<int>(pace_.share_removed * pace_.keyframes + uniform(0, 1));
    std::vector<std::int64_t> gone;
    for (int i = 0; i < count && first > 10; ++i) {
      const auto row = truth_.keyframes.lower_bound(pick(0, first - 10));
      if (row != truth_.keyframes.end() && row->first < first - 8) gone.push_back(row->first);
    }
    for (const std::int64_t id : gone) change.removed_keyframes.push_back(id);
    const auto hangs_on_one = [&gone](const LandmarkRow& row) {
      return std::find(gone.begin(), gone.end(), row.anchor) != gone.end();
    };
    for (const auto& [id, row] : truth_.landmarks) {
      if (hangs_on_one(row)) change.removed_landmarks.push_back(id);
    }
    for (int i = 0; i < static_cast<int>(pace_.share_removed * pace_.new_landmarks) && !truth_.landmarks.empty(); ++i) {
      const auto row = truth_.landmarks.lower_bound(pick(0, truth_.landmarks.rbegin()->first));
      change.removed_landmarks.push_back(row->first);
    }
  }

  MapPace pace_;
  std::mt19937_64 random_;
  MapTruth truth_;
  std::int64_t next_keyframe_ = 0, next_landmark_ = 0;
};

// Few and small rows: for tests that write often.
inline MapPace small_pace(unsigned seed) {
  return {.features = 20, .keyframes = 2, .new_landmarks = 12, .old_landmarks = 20, .seed = seed};
}

}  // namespace povslam::made
